// Benches filed so that nothing between the bars, or no bar, could be what they make of a shot.
#include "processing/reduction/plausibility.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "processing/reduction/reducer.hpp"
#include "processing/reduction/validity.hpp"
#include "tests/generators/elastic_shpb.hpp"
#include "tests/unit/reduction/solved_bench.hpp"

namespace kolsky {
namespace {

using testing::check_of;
using testing::ElasticShpb;

Shot solved() {
  const ElasticShpb model;
  return model.shot(model.solve(), 4e-6, 16, 0.01, 1);
}

void expect_leading_failure(const Reduction& r, const std::string& name, const std::string& mend) {
  ASSERT_TRUE(r.quality.reducible) << r.quality.reason;
  const Check& check = check_of(r, name);
  EXPECT_EQ(check.verdict, Verdict::fail);
  EXPECT_EQ(r.quality.checks.front().verdict, Verdict::fail);
  EXPECT_NE(check.text.find(mend), std::string::npos) << check.text;
  const Quotable part = quotable_part(r);
  EXPECT_FALSE(part.any);
}

TEST(Plausibility, OfAnOrdinaryShotIsNotMentioned) {
  const Quality quality = Reducer().reduce(solved()).quality;
  for (const char* name : {"specimen_strain", "bar_strain", "striker_speed"}) {
    EXPECT_EQ(quality.find(name), nullptr) << name;
  }
}

TEST(Plausibility, ASpecimenShortenedByAllOfItsLengthFails) {
  Shot shot = solved();
  const Reduction right = Reducer().reduce(shot);
  const double most = *std::max_element(right.strain.begin(), right.strain.end());
  shot.bench.specimen->length_m.value *= most / 1.02;
  const Reduction r = Reducer().reduce(shot);
  expect_leading_failure(r, "specimen_strain", "specimen.length_m");
  EXPECT_NEAR(check_of(r, "specimen_strain").value, 1.02, 0.01);
  EXPECT_NE(quotable_part(r).text.find("all of its length"), std::string::npos);
  shot.bench.specimen->length_m.value *= 1.02 / 0.98;
  EXPECT_EQ(Reducer().reduce(shot).quality.find("specimen_strain"), nullptr);
}

TEST(Plausibility, MillivoltsReadAsVoltsFailAndTheGaugeIsNamed) {
  for (const std::size_t gauge : {0U, 1U}) {
    Shot shot = solved();
    shot.bench.gauges[gauge].unit = "V";
    shot.bench.gauges[gauge].strain_per_V = Measured{1000.0};
    const Reduction r = Reducer().reduce(shot);
    expect_leading_failure(r, "bar_strain", "mV");
    EXPECT_EQ(check_of(r, "bar_strain").text.find(shot.bench.gauges[gauge].name), 0U);
  }
}

TEST(Plausibility, OfBothBarsTheOneFurtherOffIsTold) {
  Shot shot = solved();
  for (Gauge& gauge : shot.bench.gauges) {
    gauge.unit = "V";
    gauge.strain_per_V = Measured{1000.0};
  }
  const Quality quality = Reducer().reduce(shot).quality;
  EXPECT_EQ(std::ranges::count(quality.checks, "bar_strain", &Check::name), 1);
}

/// A striker of the bar's material and section of which a bar holds half of the speed.
Shot with_striker(double share_of_strain) {
  const ElasticShpb model;
  Shot shot = model.shot(model.solve(), 1e-6, 16, 0.01, 1);
  const double speed = std::sqrt(model.youngs_modulus_Pa / model.density_kg_m3);
  shot.bench.striker = Striker{.length_m = Measured{0.25},
                               .diameter_m = Measured{model.diameter_m},
                               .density_kg_m3 = Measured{model.density_kg_m3}};
  shot.meta["striker_speed_m_per_s"] =
      std::to_string(2.0 * speed * model.pulse_strain / share_of_strain);
  return shot;
}

TEST(StrikerSpeed, ThatMakesTheIncidentPulsePasses) {
  const Check check = check_of(Reducer().reduce(with_striker(1.0)), "striker_speed");
  EXPECT_EQ(check.verdict, Verdict::pass);
  EXPECT_NEAR(check.value, 1.0, 0.01);
}

TEST(StrikerSpeed, AFactorOfTwoOffIsNamed) {
  for (const double share : {0.4, 2.5, 10.0}) {
    const Check check = check_of(Reducer().reduce(with_striker(share)), "striker_speed");
    EXPECT_EQ(check.verdict, Verdict::warn) << share;
    EXPECT_NEAR(check.value, share, 0.02 * share);
  }
}

TEST(StrikerSpeed, IsHeldAgainstTheStrikersOwnSectionAndMaterial) {
  Shot shot = with_striker(1.0);
  shot.bench.striker->diameter_m = Measured{0.5 * shot.bench.input.diameter_m};
  // A quarter of the section: Z/(1 + Z) is 0.2 in place of 0.5.
  EXPECT_NEAR(check_of(Reducer().reduce(shot), "striker_speed").value, 2.5, 0.03);
  shot.bench.striker->density_kg_m3 = Measured{1200.0};  // of which no modulus is filed
  EXPECT_EQ(Reducer().reduce(shot).quality.find("striker_speed"), nullptr);
}

TEST(StrikerSpeed, ThatIsNoNumberKeepsNothingFromBeingReduced) {
  Shot shot = with_striker(1.0);
  shot.meta["striker_speed_m_per_s"] = "fast";
  const Quality quality = Reducer().reduce(shot).quality;
  EXPECT_TRUE(quality.reducible);
  EXPECT_EQ(quality.find("striker_speed"), nullptr);
}

}  // namespace
}  // namespace kolsky
