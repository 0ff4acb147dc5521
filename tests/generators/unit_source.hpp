#pragma once

#include <span>
#include <vector>

namespace kolsky::testing {

/// The bell that every source is a sum of: the quintic B-spline over six knots, from time 0 on.
/// What a linear bar does to it is reckoned once; any pulse is then a sum of shifted copies,
/// without error.
struct UnitSource {
  double knot_s = 4e-6;
  static constexpr double kKnots = 6.0;

  [[nodiscard]] double at(double time_s) const;
  [[nodiscard]] double duration_s() const { return kKnots * knot_s; }
};

/// Histories from time 0 on at equal steps, one per station.
struct Responses {
  double step_s = 0.0;
  std::vector<std::vector<double>> strain;
};

/// One history as the answer to coefficients at the knots: out[n] = sum_k c_k h(n period - k knot -
/// lag), a knot lasting a whole number of sampling periods. A negative lag shows what began before
/// the record.
[[nodiscard]] std::vector<double> superpose(std::span<const double> response, double step_s,
                                            std::span<const double> coefficients,
                                            std::size_t periods_per_knot, double period_s,
                                            double lag_s, std::size_t samples);

}  // namespace kolsky::testing
