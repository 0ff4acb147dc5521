// A bar that creeps over two times, identified alone and then carrying the waves of a split bar.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "drivers/files/settings/material_file.hpp"
#include "tests/end_to_end/cli/kolsky.hpp"
#include "tests/generators/campaign.hpp"
#include "tests/generators/campaign_files.hpp"
#include "tests/generators/shpb_world.hpp"
#include "tests/scratch_folder.hpp"

namespace kolsky {
namespace {

using nlohmann::json;
using scene::json_of;
using scene::kolsky;
using scene::refused;

constexpr const char* kSecondBranch = "second-relaxation=6e-12,tau=3e-4";

/// The bar by itself and a split bar of it, as captures, both by characteristics in the time
/// domain; and what really happened in the specimen.
class CarriedSolid : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { made_ = std::make_unique<Made>(); }
  static void TearDownTestSuite() { made_.reset(); }

  struct Made {
    testing::ScratchFolder folder;
    std::vector<std::string> bar_captures, captures;
    std::vector<testing::SpecimenHistory> truth;
    testing::TrueSpecimen specimen;
    std::string two, three;  ///< material files

    Made() : two(folder / "two.toml"), three(folder / "three.toml") {
      testing::Campaign bar = testing::draw_campaign({.seed = 71, .shots = 4});
      testing::hide(bar, testing::parse_effect(kSecondBranch));
      bar_captures = captures_of(bar, "bar");
      testing::Campaign split = testing::draw_campaign({.seed = 72, .shots = 3, .split = true});
      split.world.material = bar.world.material;
      for (Bar* const own : {&split.bench.input, &*split.bench.output}) {
        own->density_kg_m3 = bar.bench.input.density_kg_m3;
        own->poisson_ratio = bar.bench.input.poisson_ratio;
      }
      captures = captures_of(split, "split");
      (void)testing::shpb_readings(testing::split_world(split), {}, &truth);
      specimen = split.split->specimen;
      json told = json_of(identify_bar({"--solid", "auto", "--model-out", two, "--json"}));
      EXPECT_EQ(told["solid"]["solid"], "two-kelvin");
      (void)json_of(identify_bar({"--model-out", three, "--json"}));
    }

    std::vector<std::string> captures_of(testing::Campaign campaign, const char* name) {
      std::vector<std::string> files;
      for (testing::TrueShot& shot : campaign.world.shots) {
        shot.temperature_K = campaign.world.reference_K;
      }
      for (const auto& file :
           testing::write_campaign({folder / name, false}, testing::shots_of(campaign))) {
        files.push_back(file.string());
      }
      return files;
    }

    [[nodiscard]] scene::Answer identify_bar(const std::vector<std::string>& more) const {
      std::vector<std::string> words = {"identify", "bar"};
      words.insert(words.end(), bar_captures.begin(), bar_captures.end());
      words.insert(words.end(), more.begin(), more.end());
      return kolsky(words);
    }
  };

  static std::unique_ptr<Made> made_;
};

std::unique_ptr<CarriedSolid::Made> CarriedSolid::made_;

double sample(const std::vector<double>& values, double place) {
  const double held = std::clamp(place, 0.0, static_cast<double>(values.size()) - 1.001);
  const auto n = static_cast<std::size_t>(held);
  const double share = held - static_cast<double>(n);
  return values[n] + share * (values[n + 1] - values[n]);
}

/// Root mean square of what stress and strain are off by over the histories, in stated deviations:
/// beside the truth at the lag that suits the strain best, which times of arrival leave open.
struct Off {
  double stress, strain;
};

Off off_by(const json& told, const testing::SpecimenHistory& truth, double area_m2) {
  const std::vector<double> time_s = told["time_s"], strain = told["strain"];
  const std::vector<double> stress_Pa = told["stress_Pa"], stress_sd_Pa = told["stress_sd_Pa"];
  const std::vector<double> strain_sd = told["strain_sd"];
  const double reach = 0.8 * time_s.back();
  const auto rms = [&](double lag_s, const auto& off) {
    double squares = 0.0;
    double count = 0.0;
    for (std::size_t n = 0; n < time_s.size(); ++n) {
      if (time_s[n] > 0.1 * reach && time_s[n] < reach) {
        squares += std::pow(off(n, (time_s[n] + lag_s) / truth.step_s), 2);
        ++count;
      }
    }
    return std::sqrt(squares / count);
  };
  double best_s = 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (double lag_s = 0.0; lag_s < 2e-3; lag_s += 0.1e-6) {
    const double apart =
        rms(lag_s, [&](std::size_t n, double at) { return strain[n] - sample(truth.strain, at); });
    if (apart < least) {
      least = apart;
      best_s = lag_s;
    }
  }
  return {rms(best_s,
              [&](std::size_t n, double at) {
                return (stress_Pa[n] - sample(truth.force_N, at) / area_m2) / stress_sd_Pa[n];
              }),
          rms(best_s, [&](std::size_t n, double at) {
            return (strain[n] - sample(truth.strain, at)) / strain_sd[n];
          })};
}

/// By how many stated deviations a figure of the curve is off.
double deviations_of(const json& told, const char* figure, double truth) {
  const json& own = told["uncertainty"]["figures"][figure];
  return (own["value"].get<double>() - truth) / own["sd"].get<double>();
}

TEST_F(CarriedSolid, ReducesToTheTruthWithinItsDeviationsAsThreeElementsDoNot) {
  for (std::size_t i = 0; i < made_->captures.size(); ++i) {
    const testing::SpecimenHistory& truth = made_->truth[i];
    const double area_m2 = made_->specimen.area_m2();
    const double peak_Pa = *std::ranges::max_element(truth.force_N) / area_m2;
    const double peak_strain = *std::ranges::max_element(truth.strain);
    for (const std::string& model : {made_->two, made_->three}) {
      const json told = json_of(kolsky({"reduce", made_->captures[i], "--bar-model", model,
                                        "--uncertainty", "--draws", "200", "--json"}));
      const Off off = off_by(told, truth, area_m2);
      const double stress = deviations_of(told, "peak_stress_Pa", peak_Pa);
      const double strain = deviations_of(told, "peak_strain", peak_strain);
      std::printf(
          "%s: histories off by %.2f (stress), %.2f (strain), peaks by %.2f, %.2f deviations\n",
          model == made_->two ? "two branches" : "three elements", off.stress, off.strain, stress,
          strain);
      if (model == made_->two) {
        EXPECT_LT(off.stress, 1.6);
        EXPECT_LT(off.strain, 1.6);
        EXPECT_LT(std::abs(stress), 3.0);
        EXPECT_LT(std::abs(strain), 3.0);
      } else {
        EXPECT_GT(off.strain, 2.5);
        EXPECT_GT(stress, 2.5);
      }
    }
  }
}

TEST_F(CarriedSolid, IdentifiesASpecimenAsThreeElementsDoNot) {
  const auto identified = [&](const std::string& model) {
    std::vector<std::string> words = {"identify", "specimen"};
    words.insert(words.end(), made_->captures.begin(), made_->captures.end());
    words.insert(words.end(), {"--bar-model", model, "--json"});
    return json_of(kolsky(words));
  };
  const auto off = [](const json& told, const char* name, double truth) {
    const json& own = told["parameters"][name];
    return std::abs(own["value"].get<double>() - truth) / own["sd"].get<double>();
  };
  const json two = identified(made_->two);
  EXPECT_LT(off(two, "E1_Pa", made_->specimen.E1_Pa), 3.0);
  EXPECT_LT(off(two, "E2_Pa", made_->specimen.E2_Pa), 3.0);
  EXPECT_LT(off(two, "eta2_Pa_s", made_->specimen.eta2_Pa_s), 3.0);
  EXPECT_LT(two["chi2_reduced"], 1.1);
  // What is not known of the bar is in it: five directions of its covariance.
  EXPECT_NE(two["bench"].dump().find("bar-model:5"), std::string::npos) << two["bench"];
  const json three = identified(made_->three);
  EXPECT_GT(off(three, "E1_Pa", made_->specimen.E1_Pa), 4.0);
  EXPECT_GT(three["chi2_reduced"], 1.5);
}

/// Three elements and the second branch, which together are the bar; the specimen fits then.
TEST_F(CarriedSolid, IsPutIntoModelsAsEffects) {
  const auto chi2_by = [&](const std::string& bars) {
    const std::string model = made_->folder / "model.toml";
    const json told = json_of(
        kolsky({"model", "new", "--kind", "shpb", "--bar-model", bars, "-o", model, "--json"}));
    const json& parameters = told["parameters"];
    const Material bar = read_material(bars);
    EXPECT_EQ(parameters["bar.E1_Pa"]["value"], bar.parameters[0].value);
    if (bar.solid == SolidKind::two_kelvin) {
      const double D = parameters["second-relaxation.D"]["value"];
      EXPECT_DOUBLE_EQ(D, 1.0 / bar.parameters[3]);
      EXPECT_EQ(parameters["second-relaxation.tau"]["free"], false);
    }
    std::vector<std::string> words = {"fit"};
    words.insert(words.end(), made_->captures.begin(), made_->captures.end());
    words.insert(words.end(), {"--model", model, "-o", made_->folder / "fitted.toml", "--json"});
    const json fitted = json_of(kolsky(words));
    std::filesystem::remove(made_->folder / "fitted.toml");
    std::filesystem::remove(model);
    return fitted["misfit"]["chi2_reduced"].get<double>();
  };
  EXPECT_LT(chi2_by(made_->two), 1.1);
  EXPECT_GT(chi2_by(made_->three), 1.5);
}

TEST_F(CarriedSolid, CalibratesTheBenchItWasIdentifiedOn) {
  const auto certificate_by = [&](const std::string& bars) {
    std::vector<std::string> words = {"calibrate"};
    words.insert(words.end(), made_->bar_captures.begin(), made_->bar_captures.end());
    words.insert(words.end(), {"--bar-model", bars, "--json"});
    return json_of(kolsky(words))["certificate"].get<std::string>();
  };
  EXPECT_EQ(certificate_by(made_->two), "pass");
  EXPECT_EQ(certificate_by(made_->three), "undecided");
}

TEST_F(CarriedSolid, IsRefusedWhereNothingHoldsIt) {
  constexpr const char* kBranch =
      "density_kg_m3 = 1180\npoisson_ratio = 0.36\nE1_Pa = 5.7e9\nE2_Pa = 40e9\n"
      "eta2_Pa_s = 1.9e6\n";
  made_->folder.write("branches.toml",
                      "solid = \"three-kelvin\"\n" + std::string(kBranch) +
                          "E3_Pa = 160e9\neta3_Pa_s = 5e7\nE4_Pa = 2e11\neta4_Pa_s = 2e6\n");
  EXPECT_TRUE(refused(kolsky({"model", "new", "--kind", "shpb", "--bar-model",
                              made_->folder / "branches.toml", "-o", made_->folder / "none.toml"}),
                      {"branches.toml:1: solid", "three-kelvin", "no effect", "two-kelvin"}));
  made_->folder.write("power.toml",
                      "solid = \"fractional\"\n" + std::string(kBranch) + "beta = 0.8\n");
  const std::string docs = std::string(KOLSKY_SOURCE_DIR) + "/docs/";
  EXPECT_TRUE(refused(kolsky({"impact", "--bench", docs + "benches/paper-impact.toml", "--core",
                              made_->folder / "power.toml", "--cover",
                              docs + "materials/golf-cover.toml", "--speed", "20"}),
                      {"power.toml:1: solid", "fractional", "two-kelvin"}));
}

}  // namespace
}  // namespace kolsky
