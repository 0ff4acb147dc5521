// Waves that lie over each other at the gauges, of two finite-element models, as a person would
// reduce their tables: against what the models had in the specimen.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "tests/end_to_end/cli/kolsky.hpp"
#include "tests/scratch_folder.hpp"

namespace kolsky {
namespace {

using nlohmann::json;
using Columns = std::map<std::string, std::vector<double>>;

constexpr double kModulus = 206e9;
constexpr double kDensity = 7850.0;

Columns table(const std::filesystem::path& path) {
  Columns columns;
  std::ifstream file(path);
  std::vector<std::string> names;
  for (std::string line; std::getline(file, line);) {
    std::istringstream cells(line);
    std::size_t i = 0;
    for (std::string cell; std::getline(cells, cell, ','); ++i) {
      if (names.size() <= i) {
        names.push_back(cell);
      } else {
        columns[names.at(i)].push_back(std::stod(cell));
      }
    }
  }
  return columns;
}

struct Set {
  const char* folder;
  double rate_Hz;
  double length_m, diameter_m;
  double specimen_length_m, specimen_diameter_m;
  bool keeps_volume;                 ///< the specimen; else it keeps its section
  std::optional<double> density;     ///< the specimen's, of a handbook
  std::vector<std::string> inertia;  ///< words for it
  /// Rms of what is off [%]. That of stress and strain was asked for without saying over what.
  struct Allowed {
    double over_rms, over_largest;
  };
  Allowed output_velocity, input_velocity, stress, strain;
};

std::string bench_of(const Set& set) {
  std::ostringstream text;
  text << "kind = \"shpb\"\nsampling_frequency_Hz = " << set.rate_Hz
       << "\npositive = \"compression\"\n";
  for (const char* bar : {"input", "output"}) {
    text << "[bars." << bar << "]\nlength_m = " << set.length_m
         << "\ndiameter_m = " << set.diameter_m << "\ndensity_kg_m3 = " << kDensity
         << "\npoisson_ratio = 0.3\nyoungs_modulus_Pa = " << kModulus << "\n";
  }
  text << "[[gauges]]\nname = \"gauge1_incident_bar_strain\"\nbar = \"input\"\nposition_m = "
       << set.length_m - 0.25
       << "\nunit = \"strain\"\n[[gauges]]\nname = \"gauge2_transmission_bar_strain\"\nbar = "
          "\"output\"\nposition_m = 0.25\nunit = \"strain\"\n[specimen]\nlength_m = "
       << set.specimen_length_m << "\ndiameter_m = " << set.specimen_diameter_m << "\n";
  if (set.density) {
    text << "density_kg_m3 = " << *set.density << "\n";
  }
  return text.str();
}

/// A reference column between its own times.
class Reference {
 public:
  Reference(const Columns& columns, const std::string& name, double unit = 1.0)
      : time_s_(columns.at("time_s")), values_(columns.at(name)) {
    for (double& value : values_) {
      value *= unit;
    }
  }

  [[nodiscard]] std::vector<double> at(const std::vector<double>& times_s) const {
    std::vector<double> values;
    values.reserve(times_s.size());
    for (const double t : times_s) {
      const auto next = std::upper_bound(time_s_.begin() + 1, time_s_.end() - 1, t);
      const auto n = static_cast<std::size_t>(next - time_s_.begin());
      const double share = (t - time_s_[n - 1]) / (time_s_[n] - time_s_[n - 1]);
      values.push_back(values_[n - 1] + share * (values_[n] - values_[n - 1]));
    }
    return values;
  }

 private:
  std::vector<double> time_s_, values_;
};

/// Rms of the difference over the truth's rms and over its largest value, in per cent, over the
/// loading.
Set::Allowed off(const std::vector<double>& found, const std::vector<double>& truth,
                 std::size_t loaded) {
  double difference = 0.0;
  double size = 0.0;
  double largest = 0.0;
  for (std::size_t n = 0; n < loaded; ++n) {
    difference += std::pow(found[n] - truth[n], 2);
    size += std::pow(truth[n], 2);
    largest = std::max(largest, std::abs(truth[n]));
  }
  return {100.0 * std::sqrt(difference / size),
          100.0 * std::sqrt(difference / static_cast<double>(loaded)) / largest};
}

/// Samples until the specimen, past its peak, carries less than a tenth of it.
std::size_t loading(const std::vector<double>& stress) {
  const auto peak = std::max_element(stress.begin(), stress.end());
  const auto end =
      std::find_if(peak, stress.end(), [&](double value) { return value < 0.1 * *peak; });
  return static_cast<std::size_t>(end - stress.begin());
}

/// The specimen's strain as its faces' velocities make it.
std::vector<double> strain_of_faces(const Columns& columns, double length_m) {
  const auto& time_s = columns.at("time_s");
  const auto& front = columns.at("incident_end_mean_v3_mm_per_s");
  const auto& back = columns.at("transmitted_end_mean_v3_mm_per_s");
  std::vector<double> strain(time_s.size(), 0.0);
  for (std::size_t n = 1; n < strain.size(); ++n) {
    const double rate = 1e-3 * (front[n] - back[n] + front[n - 1] - back[n - 1]) / 2.0;
    strain[n] = strain[n - 1] + rate * (time_s[n] - time_s[n - 1]) / length_m;
  }
  return strain;
}

class FiniteElementShots : public ::testing::TestWithParam<Set> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(records_)) {
      GTEST_SKIP() << "the finite-element sets are not beside the project: no " << records_;
    }
    folder_.write("bench.toml", bench_of(GetParam()));
    (void)scene::json_of(scene::kolsky({"import", "csv", records_.string(), "--bench",
                                        folder_ / "bench.toml", "-o", capture_, "--json"}));
  }

  std::filesystem::path records_ = std::filesystem::path(KOLSKY_SHARED_DATA) /
                                   "fe/wave-separation" / GetParam().folder /
                                   "gauge_strain_records.csv";
  testing::ScratchFolder folder_;
  std::string capture_ = folder_ / "shot.h5";
};

TEST_P(FiniteElementShots, AreReducedFromTheirTableToWhatTheModelHad) {
  const Set& set = GetParam();
  std::vector<std::string> words{"reduce",       capture_, "--separate", "equilibrium",
                                 "--dispersion", "exact",  "--json"};
  words.insert(words.end(), set.inertia.begin(), set.inertia.end());
  const json result = scene::json_of(scene::kolsky(words));
  ASSERT_EQ(result["quality"]["reducible"], true) << result["quality"]["reason"];

  const auto history = [&](const char* name) { return result[name].get<std::vector<double>>(); };
  std::vector<double> time_s = history("time_s");
  for (double& t : time_s) {
    t += result["arrival_s"].get<double>();
  }
  Columns columns = table(records_);
  columns["strain_of_faces"] = strain_of_faces(columns, set.specimen_length_m);
  const auto log_strain = Reference(columns, "specimen_mean_compressive_le33").at(time_s);
  auto stress = Reference(columns, "specimen_mean_compressive_s33_MPa", 1e6).at(time_s);
  std::vector<double> input_velocity(time_s.size());
  std::vector<double> output_velocity(time_s.size());
  const double c = std::sqrt(kModulus / kDensity);
  const auto incident = history("incident");
  const auto reflected = history("reflected");
  const auto transmitted = history("transmitted");
  const auto force = history("force_back_N");
  const double bar_N = kModulus * std::numbers::pi * std::pow(set.diameter_m / 2.0, 2);
  for (std::size_t n = 0; n < time_s.size(); ++n) {
    stress[n] *= set.keeps_volume ? std::exp(log_strain[n]) : 1.0;
    // The transmitted wave goes right; what comes back from the far end is the rest of the force.
    input_velocity[n] = c * (incident[n] - reflected[n]);
    output_velocity[n] = c * (2.0 * transmitted[n] - force[n] / bar_N);
  }
  const std::size_t loaded = loading(stress);
  const auto expect = [&](const char* what, const std::vector<double>& found,
                          const std::vector<double>& truth, Set::Allowed allowed) {
    const Set::Allowed share = off(found, truth, loaded);
    std::printf("%s: %s off by %.2f %%, of the largest by %.2f %%\n", set.folder, what,
                share.over_rms, share.over_largest);
    EXPECT_LT(share.over_rms, allowed.over_rms) << what;
    EXPECT_LT(share.over_largest, allowed.over_largest) << what;
  };
  const auto end_velocity = [&](const char* name) {
    return Reference(columns, name, 1e-3).at(time_s);
  };
  expect("output bar's end, velocity", output_velocity,
         end_velocity("transmitted_end_mean_v3_mm_per_s"), set.output_velocity);
  expect("input bar's end, velocity", input_velocity, end_velocity("incident_end_mean_v3_mm_per_s"),
         set.input_velocity);
  expect("stress", history("stress_Pa"), stress, set.stress);
  expect("strain", history("strain"), Reference(columns, "strain_of_faces").at(time_s), set.strain);

  // One gauge a bar: the faces cannot be told apart, and that is said.
  EXPECT_NE(
      result["quality"]["checks"]["equilibrium"]["text"].get<std::string>().find("not tested"),
      std::string::npos);
  // From when it may be assumed follows from the specimen's density alone.
  const json& quotable = result["quality"]["quotable"];
  EXPECT_EQ(quotable["any"], set.density.has_value());
  EXPECT_EQ(quotable["assumed"], set.density.has_value());
  EXPECT_NE(quotable["text"].get<std::string>().find("assumed, not tested"), std::string::npos);
}

// The output bar by itself: one gauge, passes over each other, a free end behind it. The band is
// given: what stands before the pulse of these records is no noise.
TEST_P(FiniteElementShots, TellHowTheOutputBarsFaceMoves) {
  const json told = scene::json_of(
      scene::kolsky({"waves", capture_, "--bar", "output", "--at", "0", "--dispersion", "exact",
                     "--band-limit", std::to_string(GetParam().rate_Hz / 5.0), "--csv",
                     folder_ / "waves.csv", "--svg", folder_ / "waves.svg", "--json"}));
  EXPECT_EQ(told["far_end_known"], true);
  const Columns columns = table(records_);
  const auto time_s = told["time_s"].get<std::vector<double>>();
  const auto velocity = told["places"][0]["velocity_m_per_s"].get<std::vector<double>>();
  const auto truth = Reference(columns, "transmitted_end_mean_v3_mm_per_s", 1e-3).at(time_s);
  const double known_s = told["known_until_s"].get<double>();
  const auto known = static_cast<std::size_t>(std::distance(
      time_s.begin(), std::lower_bound(time_s.begin(), time_s.end(), known_s - 1e-9)));
  const Set::Allowed share = off(velocity, truth, known);
  std::printf("%s: output bar's face, whole record, off by %.2f %%, of the largest by %.2f %%\n",
              GetParam().folder, share.over_rms, share.over_largest);
  EXPECT_LT(share.over_rms, 3.0);
  EXPECT_EQ(table(folder_ / "waves.csv").at("velocity_m_per_s_at_0_m").size(), known);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "waves.svg"));
  const scene::Answer text = scene::kolsky({"waves", capture_, "--bar", "output"});
  EXPECT_NE(text.out.find("told apart by"), std::string::npos) << text.out << text.err;
  // The foam's records begin with the pulse.
  EXPECT_EQ(text.out.find("(wanted: 32)") != std::string::npos, told["quiet_samples"] < 32);
  EXPECT_TRUE(scene::refused(scene::kolsky({"waves", capture_, "--at", "0"}), {"two gauges"}));
  EXPECT_TRUE(scene::refused(scene::kolsky({"waves", capture_, "--at", "x"}), {"--at", "\"x\""}));
  EXPECT_TRUE(scene::refused(scene::kolsky({"waves", capture_, "--bar", "output", "--at", "9"}),
                             {"--at", "9 m"}));
}

// Equilibrium makes the front force the back's; no draw tells how far off that is.
TEST_P(FiniteElementShots, HaveNoBandOfAForceThatWasTakenForGranted) {
  const json result = scene::json_of(scene::kolsky({"reduce", capture_, "--separate", "equilibrium",
                                                    "--uncertainty", "--draws", "20", "--json"}));
  EXPECT_TRUE(result.contains("force_back_sd_N"));
  EXPECT_FALSE(result.contains("force_front_sd_N"));
}

// A person who does not ask for it is told that time alone does not part these waves, and what
// does. Of copper's pulse, which rises for 90 us, the reflection hides the peak.
TEST_P(FiniteElementShots, AreCalledUnreliableByTimeAlone) {
  if (std::string(GetParam().folder) == "copper") {
    EXPECT_TRUE(scene::refused(scene::kolsky({"reduce", capture_, "--json"}),
                               {"while it still rises", "--separate equilibrium"}));
    return;
  }
  const json result = scene::json_of(scene::kolsky({"reduce", capture_, "--json"}));
  const json& overlap = result["quality"]["checks"]["window_overlap"];
  EXPECT_EQ(overlap["verdict"], "fail");
  EXPECT_NE(overlap["text"].get<std::string>().find("--separate equilibrium"), std::string::npos);
  EXPECT_TRUE(scene::refused(scene::kolsky({"reduce", capture_, "--separate", "gauges", "--json"}),
                             {"gauges", "equilibrium"}));
}

// Stress and strain over their largest value: as asked, copper 1 and 0.3 %, foam 3 and 1.1 %. Over
// the rms copper's stress keeps to that too; the others, and velocities, of which no number was
// asked, are held near to what is reached. What stands in the way is in docs/measured.md.
INSTANTIATE_TEST_SUITE_P(Sets, FiniteElementShots,
                         ::testing::Values(Set{"copper",
                                               400e3,
                                               1.0,
                                               0.016,
                                               0.006,
                                               0.008,
                                               true,
                                               8940.0,
                                               {"--inertia", "axial"},
                                               {1.3, 0.9},
                                               {1.35, 0.85},
                                               {1.0, 1.0},
                                               {0.33, 0.3}},
                                           Set{"aluminum_foam",
                                               100e3,
                                               1.6,
                                               0.050,
                                               0.015,
                                               0.030,
                                               false,
                                               {},
                                               {},
                                               {0.24, 0.11},
                                               {7.1, 4.5},
                                               {3.2, 3.0},
                                               {1.3, 1.1}}),
                         [](const auto& set) { return std::string(set.param.folder); });

}  // namespace
}  // namespace kolsky
