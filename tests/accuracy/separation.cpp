#include "processing/separation/separation.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "tests/accuracy/table.hpp"

namespace kolsky::accuracy {
namespace {

using Columns = std::map<std::string, std::vector<double>>;

Columns read_table(const std::filesystem::path& path) {
  Columns columns;
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  std::vector<std::string> names;
  std::istringstream header(line);
  for (std::string name; std::getline(header, name, ',');) {
    names.push_back(name);
  }
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    std::size_t i = 0;
    for (std::string cell; i < names.size() && std::getline(cells, cell, ','); ++i) {
      columns[names[i]].push_back(cell.empty() ? 0.0 : std::strtod(cell.c_str(), nullptr));
    }
  }
  return columns;
}

std::vector<double> at_even_steps(const std::vector<double>& time_s,
                                  const std::vector<double>& value, double step_s) {
  std::vector<double> even;
  std::size_t n = 0;
  for (double t = time_s.front(); t <= time_s.back(); t += step_s) {
    while (n + 2 < time_s.size() && time_s[n + 1] < t) {
      ++n;
    }
    const double share = (t - time_s[n]) / (time_s[n + 1] - time_s[n]);
    even.push_back(value[n] + share * (value[n + 1] - value[n]));
  }
  return even;
}

/// Rms of the difference over the rms of the truth, in per cent.
std::string off(const std::vector<double>& found, const std::vector<double>& truth) {
  double difference = 0.0;
  double size = 0.0;
  for (std::size_t n = 0; n < std::min(found.size(), truth.size()); ++n) {
    difference += std::pow(found[n] - truth[n], 2);
    size += std::pow(truth[n], 2);
  }
  return fmt::format("{:.2f}", 100.0 * std::sqrt(difference / size));
}

struct Set {
  const char* folder;
  double length_m, diameter_m, specimen_diameter_m, step_s, band_Hz, loaded_s;
  bool keeps_volume;  ///< the specimen; else it keeps its section
};

void add(const Set& set, const std::filesystem::path& folder, Section& section) {
  const Columns records = read_table(folder / "gauge_strain_records.csv");
  const Columns tool = read_table(folder / "stress_strain_rate.csv");
  const auto& time = records.at("time_s");
  const auto even = [&](const std::string& name) {
    return at_even_steps(time, records.at(name), set.step_s);
  };
  Bar bar;
  bar.length_m = {set.length_m};
  bar.diameter_m = {set.diameter_m};
  bar.density_kg_m3 = {7850.0};
  bar.poisson_ratio = {0.3};
  const ElasticSolid solid(206e9);
  const auto strain = even("gauge2_transmission_bar_strain");
  const WaveSeparation separation(bar, solid, WaveTheory::exact, {{0.25, strain, 0.0}},
                                  {.start = false, .end = true}, set.step_s, set.band_Hz);
  SeparatedWaves face = separation.at(0.0);
  // The last passage to the gauge is not in its record.
  const auto seen = static_cast<std::size_t>(0.25 / 5122.0 / set.step_s) + 5;
  face.velocity_m_per_s.resize(face.velocity_m_per_s.size() - seen);
  auto velocity = even("transmitted_end_mean_v3_mm_per_s");
  for (double& value : velocity) {
    value *= 1e-3;
  }
  section.rows.push_back({set.folder, "end's velocity", off(face.velocity_m_per_s, velocity), "-"});
  auto stress = even("specimen_mean_compressive_s33_MPa");
  const auto log_strain = even("specimen_mean_compressive_le33");
  std::vector<double> tool_stress =
      at_even_steps(tool.at("time_s"), tool.at("engineering_stress_MPa"), set.step_s);
  std::vector<double> tool_strain =
      at_even_steps(tool.at("time_s"), tool.at("engineering_strain"), set.step_s);
  std::vector<double> strain_truth;
  const double area_ratio = std::pow(set.diameter_m / set.specimen_diameter_m, 2);
  for (std::size_t n = 0; n < face.stress_Pa.size(); ++n) {
    face.stress_Pa[n] *= area_ratio * 1e-6;
  }
  for (std::size_t n = 0; n < stress.size(); ++n) {
    strain_truth.push_back(1.0 - std::exp(-log_strain[n]));
    stress[n] *= set.keeps_volume ? std::exp(log_strain[n]) : 1.0;
  }
  const auto loaded = static_cast<std::size_t>(set.loaded_s / set.step_s);
  for (auto* history : {&face.stress_Pa, &stress, &tool_stress, &tool_strain, &strain_truth}) {
    history->resize(std::min(history->size(), loaded));
  }
  section.rows.push_back({set.folder, "stress over the loadings", off(face.stress_Pa, stress),
                          off(tool_stress, stress)});
  section.rows.push_back(
      {set.folder, "strain over the loadings", "-", off(tool_strain, strain_truth)});
}

}  // namespace

std::optional<Section> separated_waves() {
  const auto root = std::filesystem::path(KOLSKY_SHARED_DATA) / "fe/wave-separation";
  if (!std::filesystem::exists(root)) {
    return std::nullopt;
  }
  Section section{
      "Separated waves",
      "Output bars of two finite-element sets (`../shared/data/fe/wave-separation`), one gauge and "
      "a free end, passes over each other: rms of what is off over the rms of what the solver had "
      "(stress: the specimen's own mean). Beside it the columns of the tool that comes with the "
      "sets; the input bars' one gauge is not separated here, so strain is the tool's alone.",
      {"set", "quantity", "ours off [%]", "tool off [%]"},
      {}};
  for (const Set& set : {Set{"copper", 1.0, 0.016, 0.008, 2.5e-6, 60e3, 800e-6, true},
                         Set{"aluminum_foam", 1.6, 0.050, 0.030, 10e-6, 15e3, 9.5e-3, false}}) {
    add(set, root / set.folder, section);
  }
  return section;
}

}  // namespace kolsky::accuracy
