#include "processing/separation/separation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "processing/base/error.hpp"
#include "processing/base/range.hpp"
#include "processing/waves/band_limit.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

namespace {

/// What the unknown waves look like at one gauge: P and Q, or one of them where an end is free.
struct Row {
  Complex right, left;
};

Row row_at(double x, double length_m, Complex gamma, const FreeEnds& ends) {
  Row row{std::exp(-gamma * x), std::exp(-gamma * (length_m - x))};
  if (ends.end_matched) {
    row.left = 0.0;
  } else if (ends.end) {
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
  if (ends.start && (ends.end || ends.end_matched)) {
    throw InputError("ends", "are both free", "a bar that nothing drives has no waves to separate");
  }
  const std::size_t needed = ends.start || ends.end || ends.end_matched ? 1 : 2;
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
      front_speed_m_per_s_(front_speed_m_per_s(bar, compliance)),
      samples_(gauges.empty() ? 0 : gauges.front().values.size()),
      lead_(0) {
  require_gauges(bar, gauges, ends);
  // Waves are looked for where they came from, before the gauges saw them: room for two passages.
  const double passage_s = length_m_ / front_speed_m_per_s_;
  lead_ = static_cast<std::size_t>(std::ceil(2.5 * passage_s / period_s_)) + 16;
  const DampedTransform transform(samples_ + 2 * lead_, period_s_);
  const std::size_t bins = BandLimit::bins_within(transform, band_limit_Hz_);
  for (std::size_t k = 0; k < bins; ++k) {
    path_.push_back(transform.s(k));
  }
  modes_ = bar_modes(theory, bar, compliance, path_);
  share_out(gauges, ends);
  solve(gauges);
  const std::size_t needed = ends.start || ends.end || ends.end_matched ? 1 : 2;
  if (gauges.size() > needed) {
    // exp(-2 eta t) = 1e-3
    looks_ahead_ = static_cast<std::size_t>(3.45 / path_.front().real() / period_s_);
  }

  // Blindness is that of the undamped waves.
  const std::vector<Complex> axis = axis_to(band_limit_Hz_, passage_s);
  find_blind(gauges, ends, bar_modes(theory, bar, compliance, axis), axis);
}

Complex WaveSeparation::stiffness(std::size_t k) const {
  const Complex slowness = modes_[k].gamma / path_[k];
  return density_kg_m3_ / (slowness * slowness) * modes_[k].mean_over_surface;
}

void WaveSeparation::share_out(const std::vector<SeparationGauge>& gauges, const FreeEnds& ends) {
  for (const SeparationGauge& gauge : gauges) {
    shares_.push_back({gauge.position_m, gauge.noise_rms, {}, {}});
  }
  std::vector<Row> rows(gauges.size());
  for (std::size_t k = 0; k < path_.size(); ++k) {
    const Complex gamma = modes_[k].gamma;
    const Complex across = std::exp(-gamma * length_m_);
    Normal normal;
    for (std::size_t j = 0; j < gauges.size(); ++j) {
      rows[j] = row_at(gauges[j].position_m, length_m_, gamma, ends);
      normal.add(rows[j], weight_of(gauges[j]));
    }
    for (std::size_t j = 0; j < gauges.size(); ++j) {
      // A stress tells the strain times the stiffness.
      const Complex unit =
          gauges[j].record == SeparationRecord::mean_stress_Pa ? 1.0 / stiffness(k) : 1.0;
      const Complex to_right = unit * weight_of(gauges[j]) * std::conj(rows[j].right);
      const Complex to_left = unit * weight_of(gauges[j]) * std::conj(rows[j].left);
      Complex right = 0.0;
      Complex left = 0.0;
      if (ends.end || ends.end_matched) {
        right = to_right / normal.right;
        left = ends.end_matched ? 0.0 : -right * across;
      } else if (ends.start) {
        left = to_left / normal.left;
        right = -left * across;
      } else {
        right = (to_right * normal.left - to_left * normal.both) / normal.determinant();
        left = (to_left * normal.right - to_right * std::conj(normal.both)) / normal.determinant();
      }
      shares_[j].right.push_back(right);
      shares_[j].left.push_back(left);
    }
  }
}

void WaveSeparation::solve(const std::vector<SeparationGauge>& gauges) {
  DampedTransform transform(samples_ + 2 * lead_, period_s_);
  BandLimit band(transform, 16);
  std::vector<double> padded(transform.length());
  std::vector<Complex> spectrum(transform.bins());
  right_.assign(path_.size(), 0.0);
  left_.assign(path_.size(), 0.0);
  for (std::size_t j = 0; j < gauges.size(); ++j) {
    std::fill(padded.begin(), padded.end(), 0.0);
    std::copy(gauges[j].values.begin(), gauges[j].values.end(),
              padded.begin() + static_cast<std::ptrdiff_t>(lead_));
    transform.forward(padded, spectrum);
    for (std::size_t k = 0; k < path_.size(); ++k) {
      right_[k] += shares_[j].right[k] * spectrum[k];
      left_[k] += shares_[j].left[k] * spectrum[k];
    }
  }
  for (auto* wave : {&right_, &left_}) {
    band.apply_half(band_limit_Hz_, *wave);
    band.apply_half(band_limit_Hz_, *wave);
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
    const double known = ends.end || ends.end_matched ? normal.right
                         : ends.start                 ? normal.left
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

std::size_t WaveSeparation::known(double position_m) const {
  double nearest_m = length_m_;
  for (const Share& share : shares_) {
    nearest_m = std::min(nearest_m, std::abs(share.position_m - position_m));
  }
  const auto travel =
      static_cast<std::size_t>(std::ceil(nearest_m / front_speed_m_per_s_ / period_s_));
  return samples_ - std::min(samples_, travel + looks_ahead_);
}

SeparatedWaves WaveSeparation::at(double position_m, StrainOf strain) const {
  DampedTransform transform(samples_ + 2 * lead_, period_s_);
  std::vector<Complex> right(transform.bins());
  std::vector<Complex> left(transform.bins());
  std::vector<Complex> stress(transform.bins());
  std::vector<Complex> velocity(transform.bins());
  for (std::size_t k = 0; k < path_.size(); ++k) {
    const Complex gamma = modes_[k].gamma;
    const Complex to_right = right_[k] * std::exp(-gamma * position_m);
    const Complex to_left = left_[k] * std::exp(-gamma * (length_m_ - position_m));
    const Complex mean = modes_[k].mean_over_surface;
    const Complex read = strain == StrainOf::section ? mean : 1.0;
    right[k] = read * to_right;
    left[k] = read * to_left;
    stress[k] = stiffness(k) * (to_right + to_left);
    velocity[k] = path_[k] / gamma * mean * (to_right - to_left);
  }
  const auto history = [&](const std::vector<Complex>& spectrum) {
    std::vector<double> record(transform.length());
    transform.inverse(spectrum, record);
    const auto begin = record.begin() + static_cast<std::ptrdiff_t>(lead_);
    return std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(samples_));
  };
  return {history(right), history(left), history(stress), history(velocity)};
}

std::vector<double> WaveSeparation::stress_noise_Pa(double position_m, std::size_t quiet) const {
  DampedTransform transform(samples_ + 2 * lead_, period_s_);
  BandLimit band(transform, 16);
  std::vector<Complex> answer(transform.bins());
  std::vector<double> record(transform.length());
  std::vector<double> variance(samples_, 0.0);
  for (const Share& share : shares_) {
    const double white = share.noise_rms * share.noise_rms;
    if (white <= 0.0) {
      continue;
    }
    // The stress after one sample's unit error at the record's start.
    for (std::size_t k = 0; k < path_.size(); ++k) {
      const Complex gamma = modes_[k].gamma;
      const double start_s = static_cast<double>(lead_) * period_s_;
      answer[k] = stiffness(k) * std::exp(-path_[k] * start_s) *
                  (share.right[k] * std::exp(-gamma * position_m) +
                   share.left[k] * std::exp(-gamma * (length_m_ - position_m)));
    }
    band.apply_half(band_limit_Hz_, std::span(answer).first(path_.size()));
    band.apply_half(band_limit_Hz_, std::span(answer).first(path_.size()));
    transform.inverse(answer, record);
    double squares = 0.0;
    double sum = 0.0;
    for (std::size_t n = 0; n < record.size(); ++n) {
      squares += record[n] * record[n];
      sum += record[n];
      const std::size_t time = n + quiet;  // in the padded record
      if (time >= lead_ && time - lead_ < samples_) {
        variance[time - lead_] +=
            white * (squares + (quiet > 0 ? sum * sum / static_cast<double>(quiet) : 0.0));
      }
    }
  }
  for (double& value : variance) {
    value = std::sqrt(value);
  }
  return variance;
}

}  // namespace kolsky
