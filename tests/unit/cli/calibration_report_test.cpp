#include "clients/cli/reports/calibration_report.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace kolsky::cli
