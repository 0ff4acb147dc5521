#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "processing/base/error.hpp"
#include "processing/impact/impact.hpp"
#include "tests/unit/impact/paper_ball.hpp"

namespace kolsky::impact {
namespace {

using kolsky::testing::paper_impact;

struct Refusal {
  const char* name;
  std::function<void(ImpactModel&)> spoil;
  const char* place;
};

class ImpactRefuses : public ::testing::TestWithParam<Refusal> {};

TEST_P(ImpactRefuses, WithThePlace) {
  ImpactModel model = paper_impact(40.3);
  model.elements = 256;
  GetParam().spoil(model);
  try {
    (void)simulate(model);
    FAIL() << "not refused";
  } catch (const InputError& error) {
    EXPECT_NE(error.place().find(GetParam().place), std::string::npos) << error.what();
    EXPECT_FALSE(error.mend().empty());
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
}

const double kNaN = std::numeric_limits<double>::quiet_NaN();

INSTANTIATE_TEST_SUITE_P(
    Models, ImpactRefuses,
    ::testing::Values(
        Refusal{"NoLayers", [](ImpactModel& m) { m.layers.clear(); }, "layers"},
        Refusal{"CoverInsideCore", [](ImpactModel& m) { m.layers[1].outer_diameter_m = 0.01; },
                "layers[1].outer_diameter_m"},
        Refusal{"NegativeModulus",
                [](ImpactModel& m) { m.layers[0].solid.shear_relaxed_Pa = -1.0; },
                "layers[0].solid"},
        Refusal{"ActiveArm", [](ImpactModel& m) { m.layers[1].solid.arms[0].shear_Pa = -1e6; },
                "layers[1].solid"},
        Refusal{"NotANumber", [](ImpactModel& m) { m.layers[1].solid.density_kg_m3 = kNaN; },
                "layers[1].solid"},
        Refusal{"NoSpeed", [](ImpactModel& m) { m.speed_m_per_s = 0.0; }, "speed"},
        Refusal{"Backwards", [](ImpactModel& m) { m.speed_m_per_s = -40.0; }, "speed"},
        Refusal{"NaNSpeed", [](ImpactModel& m) { m.speed_m_per_s = kNaN; }, "speed"},
        Refusal{"NegativeFriction", [](ImpactModel& m) { m.friction = -0.1; }, "friction"},
        Refusal{"PastTheEdge", [](ImpactModel& m) { m.offset_m = 0.014; }, "offset"},
        Refusal{"NegativeSabot", [](ImpactModel& m) { m.sabot_mass_kg = -1.0; }, "sabot"},
        Refusal{"SabotOfATon", [](ImpactModel& m) { m.sabot_mass_kg = 1000.0; }, "sabot"},
        Refusal{"TooFewElements", [](ImpactModel& m) { m.elements = 3; }, "elements"},
        Refusal{"NoRoomForRings", [](ImpactModel& m) { m.elements = 64; }, "elements"},
        Refusal{"EnergyThatDoesNotClose",
                [](ImpactModel& m) {
                  m.target.diameter_m = 0.0085;
                  m.elements = 512;
                },
                "impact"},
        Refusal{"GaugeWithoutABar", [](ImpactModel& m) { m.gauge_positions_m = {0.25}; }, "gauge"},
        Refusal{"ProbeOutside",
                [](ImpactModel& m) {
                  m.probes = {{0.0, 0.03}};
                },
                "probes"},
        Refusal{"NonlinearBeyondReason",
                [](ImpactModel& m) { m.layers[0].solid.nonlinearity = 1e9; },
                "layers[0].solid.nonlinearity"},
        Refusal{"FieldBeforeTheTouch", [](ImpactModel& m) { m.field_times_s = {-1.0}; },
                "field_times_s"},
        Refusal{"StepThatNeverEnds", [](ImpactModel& m) { m.time_step_s = 1e-15; }, "time_step_s"},
        Refusal{"StepPastStability", [](ImpactModel& m) { m.time_step_s = 5e-6; }, "time_step_s"}),
    [](const auto& refusal) { return refusal.param.name; });

/// What refuses a model says.
std::string refusal_of(const ImpactModel& model) {
  try {
    (void)simulate(model);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ImpactRun, StopsAtAnInvertedElementWithItsPlaceTheTimeAndTheMend) {
  // Jelly at 51 m/s.
  ImpactModel model = paper_impact(51.0);
  model.elements = 256;
  model.layers[0].solid = elastic_solid(1140.0, 5e4, 0.45);
  model.layers[1].solid = elastic_solid(960.0, 5e4, 0.45);
  std::string said = refusal_of(model);
  for (const char* word : {"].solid: element", "turned inside out at", " s; ", "lower the speed",
                           "stiffen the solid", "change the number of elements"}) {
    EXPECT_NE(said.find(word), std::string::npos) << word << "\n" << said;
  }
  // Of what softens the softening is to blame, in whichever layer the element is.
  model = paper_impact(51.0);
  model.elements = 256;
  model.layers[0].solid.nonlinearity = -2.0;
  said = refusal_of(model);
  for (const char* word : {"layers[0].solid.nonlinearity: element", "turned inside out at", " s; ",
                           "soften the solid less or lower the speed"}) {
    EXPECT_NE(said.find(word), std::string::npos) << word << "\n" << said;
  }
}

TEST(ImpactRun, RefusesALayerSoThinThatNoContactWouldEnd) {
  ImpactModel model = paper_impact(40.3);
  model.elements = 512;
  model.layers[0].outer_diameter_m = model.layers[1].outer_diameter_m - 10e-6;
  const std::string said = refusal_of(model);
  for (const char* word : {"layers[1].outer_diameter_m: takes about", "0000 steps of", "element",
                           "make that layer thicker"}) {
    EXPECT_NE(said.find(word), std::string::npos) << word << "\n" << said;
  }
}

// Between a wall and a kilogram, nearly incompressible: where no element turns inside out, the step
// goes to nothing. Which of the two comes first hangs on roundings.
TEST(ImpactRun, StopsWhereTheBallIsCrushedWithThePlaceTheTimeAndTheMend) {
  std::vector<std::string> crushed;
  for (const double poisson_ratio : {0.485, 0.49, 0.495}) {
    for (const double speed_m_per_s : {80.0, 90.0, 100.0, 110.0}) {
      for (const std::size_t elements : {200U, 300U}) {
        ImpactModel model = paper_impact(speed_m_per_s, TargetKind::rigid);
        model.elements = elements;
        model.sabot_mass_kg = 1.0;
        model.layers[0].solid = elastic_solid(1140.0, 100e6, poisson_ratio);
        model.layers[1].solid = elastic_solid(960.0, 100e6, poisson_ratio);
        const std::string said = refusal_of(model);
        ASSERT_FALSE(said.empty()) << poisson_ratio << " " << speed_m_per_s << " " << elements;
        if (said.find("turned inside out at") == std::string::npos) {
          crushed.push_back(said);
        }
      }
    }
  }
  ASSERT_FALSE(crushed.empty());
  for (const std::string& said : crushed) {
    for (const char* word : {"element", "is crushed at", " s", "thousandth", "lighter sabot"}) {
      EXPECT_NE(said.find(word), std::string::npos) << word << "\n" << said;
    }
  }
}

TEST(ImpactRun, NamesTheElementThatAStepIsTooLargeForAtTheStart) {
  ImpactModel model = paper_impact(40.3);
  model.elements = 256;
  model.time_step_s = 5e-6;
  std::string said = refusal_of(model);
  EXPECT_NE(said.find("at 0 s, where element"), std::string::npos) << said;
  // On a bar whose elements are the smaller ones it is one of them.
  model.target.kind = TargetKind::bar;
  model.target.length_m = 0.3;
  said = refusal_of(model);
  EXPECT_NE(said.find("where the bar's element"), std::string::npos) << said;
}

TEST(ImpactRun, StopsWhereAGivenStepIsOvertakenByTheDeformation) {
  ImpactModel model = paper_impact(51.0);
  model.elements = 256;
  const ImpactHistory usual = simulate(model);
  model.time_step_s = 0.99 * usual.first_step_s / 0.85;
  try {
    (void)simulate(model);
    FAIL() << "not refused";
  } catch (const InputError& error) {
    EXPECT_EQ(error.place(), "time_step_s");
    EXPECT_NE(error.problem().find("element"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace kolsky::impact
