#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <mutex>

#include "clients/cli/reports/impact_run.hpp"
#include "clients/cli/threads.hpp"
#include "clients/figure/impact_figure.hpp"
#include "clients/report/field_svg.hpp"
#include "clients/report/svg.hpp"
#include "drivers/files/captures/new_file.hpp"
#include "processing/base/error.hpp"

namespace kolsky::cli {
namespace {

using impact::ImpactHistory;
using impact::ImpactModel;
using impact::Reading;

constexpr mode_t kReadableByAll = 0644;
constexpr std::array kSpeeds_m_per_s = {31.1, 40.3, 51.0};
constexpr std::array kFrictions = {0.0, 0.1, 0.2, 0.3};
constexpr std::array kReadings = {Reading::full, Reading::bulk_E1, Reading::bulk_Einf,
                                  Reading::exact};
constexpr double kOtherCore_m = 0.038;       // the usual construction, beside the bench's
constexpr double kLeastDifference_m = 1e-4;  // of cores that are worth a row of their own
constexpr std::size_t kTellEvery = 5;        // runs
constexpr std::array kFiles = {"fig11.svg", "fig12.svg", "fig13.svg",
                               "fig14.svg", "fig15.svg", "table.md"};

/// A run and the same on a mesh of half the element size.
struct Pair {
  ImpactModel model;
  ImpactHistory coarse;
  ImpactHistory fine;
};

void run_all(std::vector<Pair>& pairs, std::size_t fine_elements) {
  std::mutex guard;
  std::size_t done = 0;
  all_cores().run(pairs.size(), [&](std::size_t i, std::size_t) {
    pairs[i].coarse = impact::simulate(pairs[i].model);
    ImpactModel finer = pairs[i].model;
    finer.elements = fine_elements;
    finer.field_at_turn = false;
    pairs[i].fine = impact::simulate(finer);
    const std::lock_guard lock(guard);
    if (++done % kTellEvery == 0) {
      std::cerr << "kolsky impact: " << done << " of " << pairs.size() << " done" << std::endl;
    }
  });
}

class Paper {
 public:
  Paper(Bench bench, impact::BallMaterial core, impact::BallMaterial cover,
        const FigureMeshes& meshes)
      : meshes_(meshes),
        bench_(std::move(bench)),
        core_(std::move(core)),
        cover_(std::move(cover)),
        own_core_m_(bench_.ball->core_diameter_m.value),
        cores_m_{own_core_m_} {
    if (std::abs(kOtherCore_m - own_core_m_) > kLeastDifference_m &&
        kOtherCore_m < bench_.ball->outer_diameter_m) {
      cores_m_.push_back(kOtherCore_m);
    }
    plan();
    run_all(pairs_, meshes_.fine);
  }

  void write(const std::filesystem::path& folder) const {
    const auto put = [&](const std::string& name, const std::string& text) {
      NewFile file(folder / name);
      file.write(text);
      file.publish(kReadableByAll);
    };
    put("fig11.svg", stress_picture());
    put("fig12.svg", render_svg({"Fig. 12: axial strain rates at 40.3 m/s", {}, {rates()}}));
    put("fig13.svg", render_svg({"Fig. 13: friction", {}, friction_panels()}));
    put("fig14.svg", render_svg({"Fig. 14: contact force", {}, {speeds()}}));
    put("fig15.svg", render_svg({"Fig. 15: restitution", {}, {restitution()}}));
    put("table.md", table());
  }

  [[nodiscard]] std::string table() const {
    std::string text = fmt::format("Of {} elements; in brackets what {} elements change.\n\n",
                                   meshes_.coarse, meshes_.fine);
    text +=
        "| core mm | reading | friction | speed m/s | peak kN | at us | contact us | restitution | "
        "mass g |\n|---|---|---|---|---|---|---|---|---|\n";
    for (const Pair& pair : pairs_) {
      text += row(pair);
    }
    return text + trends();
  }

 private:
  void add(double core_m, Reading reading, double friction, double speed_m_per_s) {
    Bench bench = bench_;
    bench.ball->core_diameter_m.value = core_m;
    bench.ball->mass_kg.reset();  // geometry and densities decide: nothing is scaled
    impact::BallMaterial core = core_;
    impact::BallMaterial cover = cover_;
    core.reading = cover.reading = reading;
    Pair pair;
    pair.model = impact_on(bench, core, cover, impact::TargetKind::dashpot, speed_m_per_s);
    pair.model.friction = friction;
    pair.model.elements = meshes_.coarse;
    const bool pictured = core_m == own_core_m_ && reading == Reading::full && friction == 0.3 &&
                          speed_m_per_s == 40.3;
    if (pictured) {
      pair.model.field_at_turn = true;
      for (const NamedProbe& probe : paper_probes()) {
        pair.model.probes.push_back(probe.probe);
      }
    }
    pairs_.push_back(std::move(pair));
    keys_.push_back({core_m, reading, friction, speed_m_per_s});
  }

  void plan() {
    for (const double core_m : cores_m_) {
      for (const Reading reading : kReadings) {
        for (const double speed : kSpeeds_m_per_s) {
          add(core_m, reading, 0.3, speed);
        }
      }
    }
    for (const double speed : kSpeeds_m_per_s) {
      for (const double friction : {0.0, 0.1, 0.2}) {
        add(own_core_m_, Reading::full, friction, speed);
      }
    }
  }

  struct Key {
    double core_m;
    Reading reading;
    double friction;
    double speed_m_per_s;
    friend bool operator==(const Key&, const Key&) = default;
  };

  [[nodiscard]] const Pair& at(const Key& key) const {
    const auto found = std::find(keys_.begin(), keys_.end(), key);
    return pairs_.at(static_cast<std::size_t>(found - keys_.begin()));
  }

  [[nodiscard]] std::string row(const Pair& pair) const {
    const Key& key = keys_[static_cast<std::size_t>(&pair - pairs_.data())];
    const ImpactHistory& h = pair.coarse;
    const ImpactHistory& f = pair.fine;
    return fmt::format(
        "| {:.2f} | {} | {:.1f} | {:.1f} | {:.3f} ({:+.3f}) | {:.0f} ({:+.0f}) | {:.0f} ({:+.0f}) "
        "| "
        "{:.4f} ({:+.4f}) | {:.2f} |\n",
        1e3 * key.core_m, impact::name_of(key.reading), key.friction, key.speed_m_per_s,
        1e-3 * h.peak_force_N, 1e-3 * (f.peak_force_N - h.peak_force_N), 1e6 * h.peak_time_s,
        1e6 * (f.peak_time_s - h.peak_time_s), 1e6 * h.contact_time_s,
        1e6 * (f.contact_time_s - h.contact_time_s), h.restitution, f.restitution - h.restitution,
        1e3 * h.mass_kg);
  }

  // What the paper says, and what comes out, each beside the largest change by the finer mesh.
  [[nodiscard]] std::string trends() const {
    std::string text = fmt::format(
        "\nFriction from 0 to 0.3 ({:.2f} mm core, full); in brackets the mesh's share.\n\n",
        1e3 * own_core_m_);
    text +=
        "| speed m/s | peak % | peak earlier us | contact us | restitution |\n"
        "|---|---|---|---|---|\n";
    for (const double speed : kSpeeds_m_per_s) {
      const Pair& without = at({own_core_m_, Reading::full, 0.0, speed});
      const Pair& with = at({own_core_m_, Reading::full, 0.3, speed});
      const auto change = [&](auto number) {
        const double coarse = number(with.coarse) - number(without.coarse);
        const double fine = number(with.fine) - number(without.fine);
        return std::pair{coarse, fine - coarse};
      };
      const auto [peak, peak_mesh] = change([](const ImpactHistory& h) { return h.peak_force_N; });
      const auto [time, time_mesh] = change([](const ImpactHistory& h) { return h.peak_time_s; });
      const auto [contact, contact_mesh] =
          change([](const ImpactHistory& h) { return h.contact_time_s; });
      const auto [e, e_mesh] = change([](const ImpactHistory& h) { return h.restitution; });
      text += fmt::format(
          "| {:.1f} | {:+.2f} ({:+.2f}) | {:+.0f} ({:+.0f}) | {:+.0f} ({:+.0f}) | {:+.4f} "
          "({:+.4f}) |\n",
          speed, 100.0 * peak / without.coarse.peak_force_N,
          100.0 * peak_mesh / without.coarse.peak_force_N, -1e6 * time, -1e6 * time_mesh,
          1e6 * contact, 1e6 * contact_mesh, e, e_mesh);
    }
    return text;
  }

  [[nodiscard]] const Pair& pictured() const { return at({own_core_m_, Reading::full, 0.3, 40.3}); }

  [[nodiscard]] std::string stress_picture() const {
    Figure figure{"Fig. 11: axial stress at the largest deformation, 40.3 m/s", {}, {}};
    figure.panels = {contact_force_panel(pictured().coarse),
                     contact_radius_panel(pictured().coarse)};
    return render_fields_svg(pictured().coarse.fields, figure);
  }

  [[nodiscard]] Panel rates() const {
    std::vector<std::string> names;
    for (const NamedProbe& probe : paper_probes()) {
      names.push_back(probe.name);
    }
    return probe_rate_panel(pictured().coarse, names);
  }

  [[nodiscard]] std::vector<Panel> friction_panels() const {
    std::vector<Panel> panels;
    for (const double speed : kSpeeds_m_per_s) {
      Panel panel{fmt::format("{:.1f} m/s", speed), {"time", "s"}, {"force", "N"}, {}};
      for (const double friction : kFrictions) {
        const ImpactHistory& h = at({own_core_m_, Reading::full, friction, speed}).coarse;
        panel.series.push_back({fmt::format("{:.1f}", friction), h.time_s, h.force_N});
      }
      panels.push_back(std::move(panel));
    }
    return panels;
  }

  [[nodiscard]] Panel speeds() const {
    Panel panel{
        fmt::format("{:.2f} mm core, full", 1e3 * own_core_m_), {"time", "s"}, {"force", "N"}, {}};
    for (const double speed : kSpeeds_m_per_s) {
      const ImpactHistory& h = at({own_core_m_, Reading::full, 0.3, speed}).coarse;
      panel.series.push_back({fmt::format("{:.1f} m/s", speed), h.time_s, h.force_N});
    }
    return panel;
  }

  [[nodiscard]] Panel restitution() const {
    Panel panel{fmt::format("{:.2f} mm core, friction 0.3", 1e3 * own_core_m_),
                {"speed", "m/s"},
                {"restitution", "1"},
                {}};
    for (const Reading reading : kReadings) {
      Series series{impact::name_of(reading), {}, {}};
      for (const double speed : kSpeeds_m_per_s) {
        series.x.push_back(speed);
        series.y.push_back(at({own_core_m_, reading, 0.3, speed}).coarse.restitution);
      }
      panel.series.push_back(std::move(series));
    }
    return panel;
  }

  FigureMeshes meshes_;
  Bench bench_;
  impact::BallMaterial core_;
  impact::BallMaterial cover_;
  double own_core_m_;            // the bench's
  std::vector<double> cores_m_;  // the bench's and, where it is another, the usual one
  std::vector<Pair> pairs_;
  std::vector<Key> keys_;
};

/// A folder to fill: made new, or empty until now, and as it was again unless it is kept.
class FolderToFill {
 public:
  explicit FolderToFill(std::filesystem::path path) : path_(std::move(path)) {
    std::error_code problem;
    made_ = std::filesystem::create_directory(path_, problem);
    if (!made_ && (problem || !std::filesystem::is_empty(path_, problem) || problem)) {
      throw InputError(path_.string(), problem ? problem.message() : "is there already",
                       "give a folder that can be made new, or an empty one");
    }
  }
  FolderToFill(const FolderToFill&) = delete;
  FolderToFill& operator=(const FolderToFill&) = delete;
  FolderToFill(FolderToFill&&) = delete;
  FolderToFill& operator=(FolderToFill&&) = delete;
  ~FolderToFill() {
    if (!kept_) {
      clear();
    }
  }

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  void keep() { kept_ = true; }

 private:
  void clear() const {
    std::error_code ignored;
    for (const char* const name : kFiles) {
      std::filesystem::remove(path_ / name, ignored);
    }
    if (made_) {
      std::filesystem::remove(path_, ignored);
    }
  }

  std::filesystem::path path_;
  bool made_ = false;
  bool kept_ = false;
};

}  // namespace

std::string write_paper_figures(const Bench& bench, const impact::BallMaterial& core,
                                const impact::BallMaterial& cover, const std::string& folder,
                                const FigureMeshes& meshes) {
  FolderToFill fresh{folder};
  const Paper paper(bench, core, cover, meshes);
  paper.write(fresh.path());
  fresh.keep();
  return paper.table() + "\nfigures 11 to 15 and table.md are in " + folder + "\n";
}

}  // namespace kolsky::cli
