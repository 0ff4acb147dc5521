#include "processing/base/bench.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "processing/base/error.hpp"

namespace kolsky {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Bar pmma_bar() {
  Bar bar;
  bar.length_m = {0.7, 0.0};
  bar.diameter_m = {0.015, 0.0};
  bar.density_kg_m3 = {1180.0, 0.0};
  bar.poisson_ratio = {0.36, 0.0};
  return bar;
}

Bench paper_bench() {
  Bench bench;
  bench.kind = BenchKind::shpb;
  bench.sampling_frequency_Hz = {1e6, 0.0};
  bench.input = pmma_bar();
  bench.output = pmma_bar();
  bench.gauges = {{"g1", "input", {0.4, 0.0}, {}, "strain", {}, {}, {}},
                  {"g2", "output", {0.05, 0.0}, {}, "strain", {}, {}, {}}};
  bench.specimen = Specimen{{0.004, 0.0}, {0.012, 0.0}, {}, {}};
  return bench;
}

std::string place_refused(const Bench& bench) {
  try {
    check(bench);
  } catch (const InputError& error) {
    return error.place();
  }
  return "nothing";
}

TEST(Bench, ThePapersIsTaken) {
  EXPECT_EQ(place_refused(paper_bench()), "nothing");
}

TEST(Bench, DistancesAreFromTheSpecimensFaces) {
  const Bench bench = paper_bench();
  EXPECT_NEAR(bench.distance_to_specimen_m(bench.gauges[0]), 0.300, 1e-12);
  EXPECT_NEAR(bench.distance_to_specimen_m(bench.gauges[1]), 0.050, 1e-12);
  EXPECT_EQ(&bench.bar_of(bench.gauges[0]), &bench.input);
  EXPECT_EQ(&bench.bar_of(bench.gauges[1]), &*bench.output);
}

// The LANL mini bars: 2.11 mm square, filed by their source with an equal-area diameter of 2.380880
// mm.
TEST(Bar, SquareOnesHaveEqualAreaAndTheirOwnDispersionRadius) {
  Bar bar = pmma_bar();
  bar.section = Section::square;
  bar.side_m = Measured{2.11e-3, 0.0};
  bar.diameter_m = {2.380880043e-3, 0.0};
  EXPECT_NEAR(bar.area_m2(), 2.11e-3 * 2.11e-3, 1e-13);
  EXPECT_NEAR(bar.dispersion_radius_m(), 1.055e-3 / std::sqrt(3.0), 1e-15);
  EXPECT_NEAR(pmma_bar().dispersion_radius_m(), 0.0075, 1e-15);
  EXPECT_NEAR(pmma_bar().area_m2(), std::numbers::pi * 0.0075 * 0.0075, 1e-15);
}

struct Change {
  const char* place;
  std::function<void(Bench&)> make;
};

void PrintTo(const Change& change, std::ostream* out) {
  *out << change.place;
}

class BenchRefusals : public ::testing::TestWithParam<Change> {};

TEST_P(BenchRefusals, NameTheKey) {
  Bench bench = paper_bench();
  GetParam().make(bench);
  EXPECT_EQ(place_refused(bench), GetParam().place);
}

INSTANTIATE_TEST_SUITE_P(
    NotNumbers, BenchRefusals,
    ::testing::Values(
        Change{"sampling_frequency_Hz", [](Bench& b) { b.sampling_frequency_Hz.value = kNan; }},
        Change{"bars.input.length_m", [](Bench& b) { b.input.length_m.value = kNan; }},
        Change{"bars.input.diameter_m", [](Bench& b) { b.input.diameter_m.value = kNan; }},
        Change{"bars.output.poisson_ratio", [](Bench& b) { b.output->poisson_ratio.value = kNan; }},
        Change{"bars.input.length_m_sd", [](Bench& b) { b.input.length_m.sd = kNan; }},
        Change{"bars.input.length_m_sd", [](Bench& b) { b.input.length_m.sd = -1e-3; }},
        Change{
            "bars.input.poisson_ratio_sd",
            [](Bench& b) { b.input.poisson_ratio.sd = std::numeric_limits<double>::infinity(); }},
        Change{"gauges[0].position_m", [](Bench& b) { b.gauges[0].position_m.value = kNan; }},
        Change{"specimen.length_m", [](Bench& b) { b.specimen->length_m.value = kNan; }},
        Change{"temperature_K", [](Bench& b) {
                 b.temperature_K = Measured{kNan, 0.0};
               }}));

// Both sides of a bound that a unit mistake must not pass.
INSTANTIATE_TEST_SUITE_P(
    Bounds, BenchRefusals,
    ::testing::Values(
        Change{"nothing", [](Bench& b) { b.input.length_m.value = 10.0; }},
        Change{"bars.input.length_m", [](Bench& b) { b.input.length_m.value = 15.0; }},
        Change{"nothing", [](Bench& b) { b.input.density_kg_m3.value = 25.0; }},
        Change{"bars.input.density_kg_m3", [](Bench& b) { b.input.density_kg_m3.value = 19.3; }},
        Change{"nothing",
               [](Bench& b) { b.gauges[0].position_m.value = std::nextafter(0.0, 1.0); }},
        Change{"nothing",
               [](Bench& b) { b.gauges[0].position_m.value = std::nextafter(0.7, 0.0); }},
        Change{"gauges[0].position_m",
               [](Bench& b) { b.gauges[0].position_m.value = std::nextafter(0.7, 1.0); }},
        Change{"nothing",
               [](Bench& b) {
                 b.specimen->poisson_ratio = Measured{-0.5, 0.0};
               }},
        Change{"nothing", [](Bench& b) { b.specimen->diameter_m.value = 0.0164; }},
        Change{"specimen.diameter_m", [](Bench& b) { b.specimen->diameter_m.value = 0.0166; }},
        Change{"bars.output.youngs_modulus_Pa",
               [](Bench& b) {
                 b.output->youngs_modulus_Pa = Measured{9e7, 0.0};
               }},
        Change{"nothing", [](Bench& b) {
                 b.output->youngs_modulus_Pa = Measured{3e9, 1e8};
               }}));

INSTANTIATE_TEST_SUITE_P(
    Parts, BenchRefusals,
    ::testing::Values(
        Change{"specimen", [](Bench& b) { b.specimen.reset(); }},
        Change{"bars.output", [](Bench& b) { b.output.reset(); }},
        Change{"ball", [](Bench& b) { b.ball = Ball{}; }},
        Change{"gauges", [](Bench& b) { b.gauges.clear(); }},
        Change{"gauges", [](Bench& b) { b.gauges.pop_back(); }},
        Change{"gauges[1].name", [](Bench& b) { b.gauges[1].name = "g1"; }},
        Change{"gauges[1].bar", [](Bench& b) { b.gauges[1].bar = "middle"; }},
        Change{"gauges[1].unit", [](Bench& b) { b.gauges[1].unit = "V"; }},
        Change{"gauges[0].position_m",
               [](Bench& b) { b.gauges[0].position_m.value = b.input.length_m; }},
        Change{"gauges[1].position_m", [](Bench& b) { b.gauges[1].position_m.value = 0.0; }},
        Change{"gauges[0].position_m", [](Bench& b) { b.gauges[0].position_m.value = 0.0; }},
        Change{"gauges[1].position_m",
               [](Bench& b) { b.gauges[1].position_m.value = b.output->length_m; }},
        Change{"nothing",
               [](Bench& b) {
                 b.gauges[1].position_m.value = b.output->length_m;
                 b.output->far_end = FarEnd::matched;
               }},
        Change{"bars.input.side_m", [](Bench& b) { b.input.section = Section::square; }}));

Bench one_bar(BenchKind kind, double position_m) {
  Bench bench = paper_bench();
  bench.kind = kind;
  bench.output.reset();
  bench.specimen.reset();
  bench.gauges.pop_back();
  bench.gauges[0].position_m.value = position_m;
  if (kind == BenchKind::impact) {
    bench.ball = Ball{{0.0427}, {0.03565}, Measured{0.0434}, false};
  }
  return bench;
}

// A ball's push is all at the struck face and nothing at the free end; no file says how a bar by
// itself is held.
TEST(Bench, OfOneBarRefusesAGaugeAtAnEndThatIsFreeForSure) {
  EXPECT_EQ(place_refused(one_bar(BenchKind::impact, 0.0)), "nothing");
  EXPECT_EQ(place_refused(one_bar(BenchKind::impact, 0.7)), "gauges[0].position_m");
  EXPECT_EQ(place_refused(one_bar(BenchKind::bar, 0.0)), "nothing");
  EXPECT_EQ(place_refused(one_bar(BenchKind::bar, 0.7)), "nothing");
}

}  // namespace
}  // namespace kolsky
