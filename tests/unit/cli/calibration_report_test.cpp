#include "clients/cli/reports/calibration_report.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace kolsky::cli {
namespace {

Calibration with_speed(Measured speed_m_per_s) {
  PartResult part;
  part.shots = 3;
  part.wave_speed_m_per_s = speed_m_per_s;
  part.wave_speed_at_Hz = 10e3;
  Calibration calibration;
  calibration.parts.push_back(part);
  return calibration;
}

TEST(CalibrationReport, ASpeedThatMayBeAnythingIsNoResult) {
  const Calibration told = with_speed({2173.7, 0.4});
  EXPECT_NE(report(told, {}).find("wave speed 2173.70 ± 0.4 m/s at 10 kHz"), std::string::npos)
      << report(told, {});
  const Calibration open = with_speed({16.49, 3e10});
  const std::string text = report(open, {});
  EXPECT_NE(text.find("wave speed: these shots do not tell it"), std::string::npos) << text;
  EXPECT_EQ(text.find("16.49"), std::string::npos) << text;
  EXPECT_NE(to_text(describe(open, {})).find("\"wave_speed_m_per_s\":null"), std::string::npos)
      << to_text(describe(open, {}));
}

/// One gauge whose bridge is amplified 200 times, one with a plain factor, one with a shunt.
Bench three_gauges() {
  Bench bench;
  for (const char* const name : {"bridge", "factor", "shunt"}) {
    bench.gauges.emplace_back().name = name;
  }
  bench.gauges[0].bridge = Bridge{.gain = {200.0, 1.0}};
  bench.gauges[1].strain_per_V = Measured{0.002, 1e-5};
  bench.gauges[2].bridge = Bridge{.shunt_resistance_ohm = 1e5, .shunt_reading_V = 0.5};
  return bench;
}

/// Of a gauge: "gauge-factor:bridge".
CalibratedNumber number_of(CalibratedNumber::Of of, const std::string& effect,
                           const std::string& gauge, const Measured& filed,
                           const Measured& measured) {
  CalibratedNumber number;
  number.of = of;
  number.id = effect + ":" + gauge;
  number.gauge = gauge;
  number.filed = filed;
  number.measured = number.combined = measured;
  return number;
}

Calibration with_part(const PartResult& part) {
  Calibration calibration;
  calibration.parts.push_back(part);
  return calibration;
}

const BenchEdit* edit_of(const std::vector<BenchEdit>& edits, std::size_t gauge,
                         const std::string& key) {
  const BenchEdit* last = nullptr;
  for (const BenchEdit& edit : edits) {
    last = edit.index == gauge && edit.key == key ? &edit : last;
  }
  return last;
}

TEST(CalibrationReport, AGaugeOfTheOtherSignIsFiledAsInverted) {
  PartResult part;
  part.inverted = {"bridge", "factor", "shunt"};
  // Beside the sign the plain factor is off by 1 %.
  CalibratedNumber gain =
      number_of(CalibratedNumber::Of::gain, "gauge-factor", "factor", {1.0, 0.001}, {1.01, 0.001});
  gain.standing = Standing::differs;
  part.numbers.push_back(gain);
  const Bench bench = three_gauges();
  const std::string text = report(with_part(part), bench);
  for (const std::string gauge : {"bridge", "factor", "shunt"}) {
    EXPECT_NE(text.find("put gauges." + gauge + ".inverted = true"), std::string::npos) << text;
  }
  const std::vector<BenchEdit> edits = corrections(with_part(part), bench);
  for (const std::size_t gauge : {0U, 1U, 2U}) {
    ASSERT_TRUE(edit_of(edits, gauge, "inverted"));
    EXPECT_EQ(edit_of(edits, gauge, "inverted")->text, "true");
  }
  ASSERT_TRUE(edit_of(edits, 1, "strain_per_V"));
  EXPECT_NEAR(std::stod(*edit_of(edits, 1, "strain_per_V")->text), 0.002 / 1.01, 1e-12);
  EXPECT_GT(std::stod(*edit_of(edits, 1, "strain_per_V_sd")->text), 0.0);
}

TEST(CalibrationReport, NothingIsFiledOfAFitThatDescribesNothing) {
  PartResult part;
  part.numbers.push_back(number_of(CalibratedNumber::Of::position, "gauge-position", "bridge",
                                   {0.5, 3e-4}, {0.5001, 1e-4}));
  part.chi2_reduced = 1.0;
  EXPECT_FALSE(corrections(with_part(part), three_gauges()).empty());
  part.chi2_reduced = 3e4;
  EXPECT_TRUE(corrections(with_part(part), three_gauges()).empty());
}

TEST(CalibrationReport, EachBarsOwnModulusGoesToThatBar) {
  CalibratedNumber modulus;
  modulus.of = CalibratedNumber::Of::elastic_modulus;
  modulus.id = "output:bar-modulus";
  modulus.bar = "output";
  modulus.standing = Standing::differs;
  modulus.filed = {220e9, 0.4e9};
  modulus.measured = modulus.combined = {207e9, 0.2e9};
  PartResult part;
  part.lay = BarsLay::together;
  part.numbers.push_back(modulus);
  const std::vector<BenchEdit> edits = corrections(with_part(part), three_gauges());
  ASSERT_EQ(edits.size(), 2U);
  for (const BenchEdit& edit : edits) {
    EXPECT_EQ(edit.table, "bars.output");
  }
}

// What the shots do not show of a number is no measurement of it.
TEST(CalibrationReport, WhatIsUnseenIsSaidToBeToldOnlySoWell) {
  CalibratedNumber gain = number_of(CalibratedNumber::Of::gain, "gauge-factor", "bridge",
                                    {1.0, 0.006}, {9.718551, 98.0});
  gain.standing = Standing::unseen;
  PartResult part;
  part.numbers.push_back(gain);
  const std::string text = report(with_part(part), three_gauges());
  EXPECT_EQ(text.find("9.718551"), std::string::npos) << text;
  EXPECT_NE(text.find("unseen: the shots tell it to ± 98 only"), std::string::npos) << text;
}

}  // namespace
}  // namespace kolsky::cli
