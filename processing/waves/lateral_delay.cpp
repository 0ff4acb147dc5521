#include "processing/waves/lateral_delay.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "processing/waves/band_limit.hpp"
#include "processing/waves/seen_modes.hpp"

namespace kolsky {

std::vector<double> lateral_delay_s_per_m(WaveTheory theory, const Bar& bar,
                                          const Compliance& compliance,
                                          std::span<const BarMode> modes,
                                          const std::vector<Complex>& path) {
  if (theory == WaveTheory::elementary) {
    return {};
  }
  const double front_s_per_m = 1.0 / front_speed_m_per_s(bar, compliance);
  const double most_s_per_m = (slowest_over_front(theory) - 1.0) * front_s_per_m;
  const std::vector<BarMode> elementary = bar_modes(WaveTheory::elementary, bar, compliance, path);
  std::vector<double> delay_s_per_m(modes.size(), 0.0);
  for (std::size_t k = 1; k < modes.size(); ++k) {
    const Complex more =
        (modes[k].gamma - elementary[k].gamma) - (modes[k - 1].gamma - elementary[k - 1].gamma);
    const double own = more.imag() / (path[k] - path[k - 1]).imag();
    delay_s_per_m[k] = std::max(delay_s_per_m[k - 1], std::min(own, most_s_per_m));
  }
  return delay_s_per_m;
}

double lateral_delay_within(std::span<const double> delay_s_per_m, std::span<const Complex> path,
                            double band_limit_Hz) {
  constexpr double kLeft = 0.01;
  if (delay_s_per_m.empty()) {
    return 0.0;
  }
  const double up_to_per_s = 2.0 * std::numbers::pi * band_limit_Hz * BandLimit::falls_to(kLeft);
  const auto beyond = std::ranges::find_if(path.first(delay_s_per_m.size()),
                                           [&](Complex s) { return s.imag() > up_to_per_s; });
  const auto bin = static_cast<std::size_t>(beyond - path.begin());
  return delay_s_per_m[std::min(bin, delay_s_per_m.size() - 1)];
}

}  // namespace kolsky
