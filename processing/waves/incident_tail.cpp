#include "processing/waves/incident_tail.hpp"

#include <algorithm>
#include <cmath>

#include "processing/waves/band_limit.hpp"
#include "processing/waves/bar_modes.hpp"
#include "processing/waves/each_exp.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

std::vector<double> incident_tail(std::span<const double> record, std::size_t known, const Bar& bar,
                                  const Compliance& compliance, double way_m, double period_s) {
  constexpr double kBand_Hz = 20e3;
  const auto lead = static_cast<std::size_t>(4.0 * BandLimit::smear_s(kBand_Hz) / period_s);
  DampedTransform transform(record.size() + 2 * lead, period_s);
  BandLimit band(transform, 16);
  const double front = front_speed_m_per_s(bar, compliance);
  std::vector<double> history(transform.length(), 0.0);
  std::copy_n(record.begin(), known, history.begin() + static_cast<std::ptrdiff_t>(lead));
  std::vector<Complex> spectrum(transform.bins());
  transform.forward(history, spectrum);
  // Times stay those of the gauge: only what a front does not do is carried.
  std::vector<Complex> stress_per_strain(spectrum.size());
  std::vector<Complex> J_per_Pa(spectrum.size());
  for (std::size_t k = 0; k < spectrum.size(); ++k) {
    const Complex s = transform.s(k);
    const Complex J = compliance.at(s);
    stress_per_strain[k] = s * (std::sqrt(bar.density_kg_m3.value * J) - 1.0 / front) * way_m;
    J_per_Pa[k] = J;
  }
  each_exp(stress_per_strain);
  for (std::size_t k = 0; k < spectrum.size(); ++k) {
    stress_per_strain[k] /= J_per_Pa[k];
  }
  const auto apply = [&](const auto& of_bin) {
    band.apply_half(kBand_Hz, spectrum);
    for (std::size_t k = 0; k < spectrum.size(); ++k) {
      // Beyond the filter nothing is left to be carried.
      spectrum[k] = std::norm(spectrum[k]) > 0.0 ? spectrum[k] * of_bin(k) : 0.0;
    }
  };
  apply([&](std::size_t k) { return stress_per_strain[k]; });
  transform.inverse(spectrum, history);
  const std::size_t over =
      lead + known - static_cast<std::size_t>(BandLimit::smear_s(kBand_Hz) / period_s);
  std::fill(history.begin() + static_cast<std::ptrdiff_t>(over), history.end(), 0.0);
  transform.forward(history, spectrum);
  apply([&](std::size_t k) { return 1.0 / stress_per_strain[k]; });
  transform.inverse(spectrum, history);
  std::vector<double> tail(record.size(), 0.0);
  for (std::size_t n = known; n < tail.size(); ++n) {
    tail[n] = history[lead + n];
  }
  return tail;
}

}  // namespace kolsky
