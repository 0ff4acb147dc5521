#pragma once

#include <functional>
#include <vector>

#include "processing/impact/solid.hpp"

namespace kolsky::testing {

/// A round bar in axisymmetric finite elements, pressed on one end: records with true lateral
/// inertia that know nothing of wave theory.
struct PressedBar {
  double diameter_m = 0.0;
  double length_m = 0.0;
  impact::Solid solid;
  std::size_t across = 8;        ///< elements over the radius
  std::vector<double> gauges_m;  ///< from the pressed end
  double duration_s = 0.0;
  std::function<double(double)> pressure_Pa;  ///< over time
};

struct BarRecords {
  double interval_s = 0.0;
  std::vector<std::vector<double>> strain;  ///< at the surface by gauge, compression positive
};

[[nodiscard]] BarRecords press(const PressedBar& bar);

/// One bell of pressure, sin^2.
[[nodiscard]] std::function<double(double)> bell(double length_s, double peak_Pa);

struct BarWave {
  double speed_m_per_s = 0.0;
  double attenuation_per_m = 0.0;
};

/// What waves of one frequency do between the first two gauges.
/// @param nominal_m_per_s  finds the turn of the phase
[[nodiscard]] BarWave wave_between(const BarRecords& records, double distance_m,
                                   double frequency_Hz, double nominal_m_per_s);

}  // namespace kolsky::testing
