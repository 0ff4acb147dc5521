#include "processing/separation/separation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "processing/base/error.hpp"
#include "processing/base/range.hpp"
#include "processing/reduction/band_limit.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

namespace {

/// What the unknown waves look like at one gauge: P and Q, or one of them where an end is free.
struct Row {
  Complex right, left;
};

Row row_at(double x, double length_m, Complex gamma, const FreeEnds& ends) {
  Row row{std::exp(-gamma * x), std::exp(-gamma * (length_m - x))};
  if (ends.end) {
    row.right -= std::exp(-gamma * (2.0 * length_m - x));
    row.left = 0.0;
  } else if (ends.start) {
    row.left -= std::exp(-gamma * (length_m + x));
    row.right = 0.0;
  }
  return row;
}

/// Normal equations of the two waves.
struct Normal {
  double right = 0.0;
  double left = 0.0;
  Complex both = 0.0;  ///< conj(right) left

  void add(const Row& row, double weight) {
    right += weight * std::norm(row.right);
    left += weight * std::norm(row.left);
    both += weight * std::conj(row.right) * row.left;
  }
  [[nodiscard]] double determinant() const { return right * left - std::norm(both); }
};

void require_gauges(const Bar& bar, const std::vector<SeparationGauge>& gauges,
                    const FreeEnds& ends) {
  if (ends.start && ends.end) {
    throw InputError("ends", "are both free", "a bar that nothing drives has no waves to separate");
  }
  const std::size_t needed = ends.start || ends.end ? 1 : 2;
  if (gauges.size() < needed) {
    throw InputError("gauges", "are too few to separate left- and right-going waves",
                     "give two gauges, or one on a bar with a free end");
  }
  double least = 1e300;
  double most = -1e300;
  for (const SeparationGauge& gauge : gauges) {
    if (!(gauge.position_m >= 0.0 && gauge.position_m <= bar.length_m)) {
      throw InputError("gauges", "at " + in_words(gauge.position_m, "m") + " is off the bar",
                       "give positions from the bar's start");
    }
    if (gauge.values.size() != gauges.front().values.size() || gauge.values.empty()) {
      throw InputError("gauges", "have records of different lengths, or none",
                       "give all gauges of one shot");
    }
    least = std::min(least, gauge.position_m);
    most = std::max(most, gauge.position_m);
  }
  if (needed == 2 && !(most > least)) {
    throw InputError("gauges", "are all at one place", "give gauges at two places of the bar");
  }
}

/// Undamped frequencies to a limit, close enough to see what a passage does.
std::vector<Complex> axis_to(double limit_Hz, double passage_s) {
  constexpr double kPerPassage = 50.0;
  const double step_Hz = 0.5 / (passage_s * kPerPassage);
  std::vector<Complex> axis;
  for (double f = step_Hz; f < limit_Hz; f += step_Hz) {
    axis.emplace_back(0.0, 2.0 * std::numbers::pi * f);
  }
  return axis;
}

double weight_of(const SeparationGauge& gauge) {
  return gauge.noise_rms > 0.0 ? 1.0 / (gauge.noise_rms * gauge.noise_rms) : 1.0;
}

}  // namespace

WaveSeparation::WaveSeparation(const Bar& bar, const Compliance& compliance, WaveTheory theory,
                               const std::vector<SeparationGauge>& gauges, const FreeEnds& ends,
                               double period_s, double band_limit_Hz)
    : length_m_(bar.length_m),
      density_kg_m3_(bar.density_kg_m3),
      period_s_(period_s),
      band_limit_Hz_(band_limit_Hz),
      samples_(gauges.empty() ? 0 : gauges.front().values.size()),
      lead_(0) {
  require_gauges(bar, gauges, ends);
  // Waves are looked for where they came from, before the gauges saw them: room for two passages.
  const double passage_s = length_m_ / front_speed_m_per_s(bar, compliance);
  lead_ = static_cast<std::size_t>(std::ceil(2.5 * passage_s / period_s_)) + 16;
  const DampedTransform transform(samples_ + 2 * lead_, period_s_);
  for (std::size_t k = 0; k < transform.bins(); ++k) {
    path_.push_back(transform.s(k));
  }
  modes_ = bar_modes(theory, bar, compliance, path_);
  solve(gauges, ends);

  // Blindness is that of the undamped waves.
  const std::vector<Complex> axis = axis_to(band_limit_Hz_, passage_s);
  find_blind(gauges, ends, bar_modes(theory, bar, compliance, axis), axis);
}

Complex WaveSeparation::stiffness(std::size_t k) const {
  const Complex slowness = modes_[k].gamma / path_[k];
  return density_kg_m3_ / (slowness * slowness) * modes_[k].mean_over_surface;
}

std::vector<std::vector<Complex>> WaveSeparation::surface_strains(
    const std::vector<SeparationGauge>& gauges) const {
  DampedTransform transform(samples_ + 2 * lead_, period_s_);
  BandLimit band(transform, 16);
  std::vector<std::vector<Complex>> spectra;
  std::vector<double> padded(transform.length());
  for (const SeparationGauge& gauge : gauges) {
    std::fill(padded.begin(), padded.end(), 0.0);
    std::copy(gauge.values.begin(), gauge.values.end(),
              padded.begin() + static_cast<std::ptrdiff_t>(lead_));
    auto& spectrum = spectra.emplace_back(transform.bins());
    transform.forward(padded, spectrum);
    band.apply_half(band_limit_Hz_, spectrum);
    band.apply_half(band_limit_Hz_, spectrum);
    if (gauge.record == SeparationRecord::mean_stress_Pa) {
      for (std::size_t k = 0; k < spectrum.size(); ++k) {
        spectrum[k] /= stiffness(k);
      }
    }
  }
  return spectra;
}

void WaveSeparation::solve(const std::vector<SeparationGauge>& gauges, const FreeEnds& ends) {
  const auto spectra = surface_strains(gauges);
  for (std::size_t k = 0; k < path_.size(); ++k) {
    const Complex gamma = modes_[k].gamma;
    Normal normal;
    Complex right = 0.0;
    Complex left = 0.0;
    for (std::size_t j = 0; j < gauges.size(); ++j) {
      const Row row = row_at(gauges[j].position_m, length_m_, gamma, ends);
      const double weight = weight_of(gauges[j]);
      normal.add(row, weight);
      right += weight * std::conj(row.right) * spectra[j][k];
      left += weight * std::conj(row.left) * spectra[j][k];
    }
    if (ends.end) {
      right /= normal.right;
      left = -right * std::exp(-gamma * length_m_);
    } else if (ends.start) {
      left /= normal.left;
      right = -left * std::exp(-gamma * length_m_);
    } else {
      const Complex P = (right * normal.left - left * normal.both) / normal.determinant();
      left = (left * normal.right - right * std::conj(normal.both)) / normal.determinant();
      right = P;
    }
    right_.push_back(right);
    left_.push_back(left);
  }
}

void WaveSeparation::find_blind(const std::vector<SeparationGauge>& gauges, const FreeEnds& ends,
                                const std::vector<BarMode>& undamped,
                                const std::vector<Complex>& axis) {
  constexpr double kBlind = 5.0;
  double best = 0.0;
  for (const SeparationGauge& gauge : gauges) {
    best += weight_of(gauge);
  }
  std::vector<double> gain;
  for (const BarMode& mode : undamped) {
    Normal normal;
    for (const SeparationGauge& gauge : gauges) {
      normal.add(row_at(gauge.position_m, length_m_, mode.gamma, ends), weight_of(gauge));
    }
    const double known = ends.end     ? normal.right
                         : ends.start ? normal.left
                                      : normal.determinant() / std::max(normal.right, normal.left);
    gain.push_back(std::sqrt(best / std::max(known, 1e-300)));
  }
  for (std::size_t k = 0; k < gain.size(); ++k) {
    const bool highest =
        (k == 0 || gain[k] >= gain[k - 1]) && (k + 1 == gain.size() || gain[k] > gain[k + 1]);
    if (highest && gain[k] > kBlind) {
      blind_.push_back({axis[k].imag() / (2.0 * std::numbers::pi), gain[k]});
    }
  }
}

SeparatedWaves WaveSeparation::at(double position_m) const {
  DampedTransform transform(samples_ + 2 * lead_, period_s_);
  std::vector<Complex> right(path_.size());
  std::vector<Complex> left(path_.size());
  std::vector<Complex> stress(path_.size());
  std::vector<Complex> velocity(path_.size());
  for (std::size_t k = 0; k < path_.size(); ++k) {
    const Complex s = path_[k];
    const Complex gamma = modes_[k].gamma;
    right[k] = right_[k] * std::exp(-gamma * position_m);
    left[k] = left_[k] * std::exp(-gamma * (length_m_ - position_m));
    stress[k] = stiffness(k) * (right[k] + left[k]);
    velocity[k] = s / gamma * modes_[k].mean_over_surface * (right[k] - left[k]);
  }
  const auto history = [&](const std::vector<Complex>& spectrum) {
    std::vector<double> record(transform.length());
    transform.inverse(spectrum, record);
    const auto begin = record.begin() + static_cast<std::ptrdiff_t>(lead_);
    return std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(samples_));
  };
  return {history(right), history(left), history(stress), history(velocity)};
}

}  // namespace kolsky
