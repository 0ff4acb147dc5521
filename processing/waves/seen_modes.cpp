#include "processing/waves/seen_modes.hpp"

#include <cmath>

#include "processing/waves/band_limit.hpp"

namespace kolsky {

std::vector<BarMode> seen_modes(WaveTheory theory, const Bar& bar, const Compliance& compliance,
                                const std::vector<Complex>& path) {
  std::vector<BarMode> modes = bar_modes(theory, bar, compliance, path);
  if (theory == WaveTheory::elementary) {
    return modes;
  }
  const double front_slowness = 1.0 / front_speed_m_per_s(bar, compliance);
  const double slowest = slowest_over_front(theory) * front_slowness;
  double going = front_slowness;
  for (std::size_t k = 1; k < modes.size(); ++k) {
    const Complex step = path[k] - path[k - 1];
    const double slowness = (modes[k].gamma - modes[k - 1].gamma).imag() / step.imag();
    const bool seen = !is_blind(modes[k]);
    if (slowness >= 0.0 && slowness <= slowest && seen) {
      going = slowness;
      continue;
    }
    BarMode last = modes[k - 1];
    if (!seen) {  // a little above, so that it is still said to be blind from here on
      const Complex& above = modes[k].mean_over_surface;
      last.mean_over_surface = above * (kBlindMeanOverSurface * (1.0 + 1e-6) / std::abs(above));
    }
    for (std::size_t n = k; n < modes.size(); ++n) {
      modes[n] = last;
      modes[n].gamma = last.gamma + (path[n] - path[k - 1]) * going;
    }
    break;
  }
  return modes;
}

double highest_band_limit_Hz(double blind_from_Hz) {
  constexpr double kLeft = 0.01;
  return blind_from_Hz / BandLimit::falls_to(kLeft);
}

}  // namespace kolsky
