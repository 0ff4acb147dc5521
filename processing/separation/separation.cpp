#include "processing/separation/separation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "processing/base/error.hpp"
#include "processing/base/range.hpp"
#include "processing/waves/band_limit.hpp"
#include "processing/waves/lateral_delay.hpp"
#include "processing/waves/seen_modes.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

namespace {

/// What the unknown waves look like at one gauge: P and Q, or one of them where an end is free.
struct Row {
  Complex right, left;
};

/// exp(-gamma (L - x)), without another exponential where that costs no digits.
Complex from_end_to(double x, double length_m, Complex gamma, Complex across, Complex from_start) {
  constexpr double kFarFromNothing = 1e-100;
  return std::norm(from_start) > kFarFromNothing ? across / from_start
                                                 : std::exp(-gamma * (length_m - x));
}

/// @param across  exp(-gamma L)
Row row_at(double x, double length_m, Complex gamma, Complex across, const FreeEnds& ends) {
  const Complex from_start = std::exp(-gamma * x);
  if (ends.end_matched) {
    return {from_start, 0.0};
  }
  const Complex from_end = from_end_to(x, length_m, gamma, across, from_start);
  if (ends.end) {
    return {from_start - across * from_end, 0.0};
  }
  if (ends.start) {
    return {0.0, from_end - across * from_start};
  }
  return {from_start, from_end};
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

std::size_t gauges_needed(const FreeEnds& ends) {
  return ends.start || ends.end || ends.end_matched ? 1 : 2;
}

void require_gauges(const Bar& bar, const std::vector<SeparationGauge>& gauges,
                    const FreeEnds& ends) {
  if (ends.start && (ends.end || ends.end_matched)) {
    throw InputError("ends", "are both free", "a bar that nothing drives has no waves to separate");
  }
  const std::size_t needed = gauges_needed(ends);
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

double weight_of(const SeparationGauge& gauge) {
  return gauge.noise_rms > 0.0 ? 1.0 / (gauge.noise_rms * gauge.noise_rms) : 1.0;
}

/// The longest way on which the gauges see two waves part: what they are blind to comes back every
/// c / (2 way).
double way_between(const std::vector<SeparationGauge>& gauges, const FreeEnds& ends,
                   double length_m) {
  double least = length_m;
  double most = 0.0;
  for (const SeparationGauge& gauge : gauges) {
    least = std::min(least, gauge.position_m);
    most = std::max(most, gauge.position_m);
  }
  const double way = ends.end ? length_m - least : ends.start ? most : most - least;
  return way > 0.0 ? way : length_m;
}

/// How much worse the worse known wave is known than by as many gauges that see it alone.
class NoiseGain {
 public:
  NoiseGain(const std::vector<SeparationGauge>& gauges, const FreeEnds& ends, double length_m)
      : gauges_(gauges), ends_(ends), length_m_(length_m) {
    for (const SeparationGauge& gauge : gauges) {
      best_ += weight_of(gauge);
    }
  }

  [[nodiscard]] double at(Complex gamma) const {
    const Complex across = std::exp(-gamma * length_m_);
    Normal normal;
    for (const SeparationGauge& gauge : gauges_) {
      normal.add(row_at(gauge.position_m, length_m_, gamma, across, ends_), weight_of(gauge));
    }
    const double known = ends_.end || ends_.end_matched ? normal.right
                         : ends_.start                  ? normal.left
                                       : normal.determinant() / std::max(normal.right, normal.left);
    return std::sqrt(best_ / std::max(known, 1e-300));
  }

 private:
  const std::vector<SeparationGauge>& gauges_;
  const FreeEnds& ends_;
  double length_m_;
  double best_ = 0.0;
};

/// Where a peak is highest between frequencies that are next to it, the modes there on a straight
/// line between theirs.
BlindFrequency highest_near(const NoiseGain& gain, const std::vector<Complex>& axis,
                            const std::vector<BarMode>& modes, std::size_t peak) {
  constexpr int kSteps = 20;
  const auto frequency_Hz = [](Complex s) { return s.imag() / (2.0 * std::numbers::pi); };
  BlindFrequency highest{frequency_Hz(axis[peak]), gain.at(modes[peak].gamma)};
  const auto look = [&](std::size_t from, std::size_t to) {
    for (int step = 1; step < kSteps; ++step) {
      const double share = static_cast<double>(step) / kSteps;
      const double here =
          gain.at(modes[from].gamma + share * (modes[to].gamma - modes[from].gamma));
      if (here > highest.noise_gain) {
        highest = {frequency_Hz(axis[from] + share * (axis[to] - axis[from])), here};
      }
    }
  };
  if (peak > 0) {
    look(peak - 1, peak);
  }
  if (peak + 1 < axis.size()) {
    look(peak, peak + 1);
  }
  return highest;
}

/// Undamped frequencies to a limit.
std::vector<Complex> axis_to(double limit_Hz, double step_Hz) {
  std::vector<Complex> axis;
  axis.reserve(static_cast<std::size_t>(limit_Hz / step_Hz) + 1);
  for (double f = step_Hz; f < limit_Hz; f += step_Hz) {
    axis.emplace_back(0.0, 2.0 * std::numbers::pi * f);
  }
  return axis;
}

}  // namespace

/// Transform and filter of one length.
struct WaveSeparation::Work {
  DampedTransform transform;
  BandLimit band;

  Work(std::size_t samples, double period_s)
      : transform(samples, period_s), band(transform, kPulseOfNoUse) {}

 private:
  static constexpr std::size_t kPulseOfNoUse = 16;
};

std::vector<BlindFrequency> blind_frequencies(const Bar& bar, const Compliance& compliance,
                                              WaveTheory theory,
                                              const std::vector<SeparationGauge>& gauges,
                                              const FreeEnds& ends, double band_limit_Hz) {
  require_gauges(bar, gauges, ends);
  constexpr double kBlind = 5.0;
  constexpr double kPerSpacing = 50.0;
  const double spacing_Hz =
      front_speed_m_per_s(bar, compliance) / (2.0 * way_between(gauges, ends, bar.length_m));
  // Blindness is that of the undamped waves.
  const std::vector<Complex> axis = axis_to(band_limit_Hz, spacing_Hz / kPerSpacing);
  const std::vector<BarMode> modes = seen_modes(theory, bar, compliance, axis);
  const NoiseGain noise_gain(gauges, ends, bar.length_m);
  std::vector<double> gain;
  gain.reserve(axis.size());
  for (const BarMode& mode : modes) {
    gain.push_back(noise_gain.at(mode.gamma));
  }
  std::vector<BlindFrequency> blind;
  for (std::size_t k = 0; k < gain.size(); ++k) {
    const bool highest =
        (k == 0 || gain[k] >= gain[k - 1]) && (k + 1 == gain.size() || gain[k] > gain[k + 1]);
    if (highest && gain[k] > kBlind) {
      // At the lowest frequencies of all the waves' sum is all that is seen.
      blind.push_back(k == 0 ? BlindFrequency{0.0, gain[k]}
                             : highest_near(noise_gain, axis, modes, k));
    }
  }
  return blind;
}

WaveSeparation::WaveSeparation(const Bar& bar, const Compliance& compliance, WaveTheory theory,
                               const std::vector<SeparationGauge>& gauges, const FreeEnds& ends,
                               double period_s, double band_limit_Hz)
    : length_m_(bar.length_m),
      period_s_(period_s),
      band_limit_Hz_(band_limit_Hz),
      samples_(gauges.empty() ? 0 : gauges.front().values.size()),
      lead_(0) {
  require_gauges(bar, gauges, ends);
  // Waves are looked for where they came from, before the gauges saw them: room for two passages.
  const double passage_s = length_m_ / front_speed_m_per_s(bar, compliance);
  // And for what the filter spreads to both sides: what wraps round, damping makes larger than
  // everything else.
  const double room_s = 2.5 * passage_s + 2.0 * BandLimit::reach_s(band_limit_Hz_);
  lead_ = static_cast<std::size_t>(std::ceil(room_s / period_s_)) + 16;
  work_ = std::make_unique<Work>(samples_ + 2 * lead_, period_s_);
  const std::size_t bins = BandLimit::bins_within(work_->transform, band_limit_Hz_);
  path_.reserve(bins);
  for (std::size_t k = 0; k < bins; ++k) {
    path_.push_back(work_->transform.s(k));
  }
  modes_ = seen_modes(theory, bar, compliance, path_);
  across_.reserve(bins);
  stiffness_.reserve(bins);
  for (std::size_t k = 0; k < bins; ++k) {
    const Complex slowness = modes_[k].gamma / path_[k];
    if (path_[k].imag() <= 2.0 * std::numbers::pi * band_limit_Hz_) {
      slowest_s_per_m_ = std::max(slowest_s_per_m_, std::abs(slowness));
    }
    across_.push_back(std::exp(-modes_[k].gamma * length_m_));
    stiffness_.push_back(bar.density_kg_m3.value / (slowness * slowness) *
                         modes_[k].mean_over_surface);
  }
  slowest_s_per_m_ = std::max(
      slowest_s_per_m_,
      1.0 / front_speed_m_per_s(bar, compliance) +
          lateral_delay_within(lateral_delay_s_per_m(theory, bar, compliance, modes_, path_), path_,
                               band_limit_Hz_));
  share_out(gauges, ends);
  solve(gauges);
  if (gauges.size() > gauges_needed(ends)) {
    // exp(-2 eta t) = 1e-3
    looks_ahead_ = static_cast<std::size_t>(3.45 / path_.front().real() / period_s_);
  }
}

WaveSeparation::~WaveSeparation() = default;

void WaveSeparation::share_out(const std::vector<SeparationGauge>& gauges, const FreeEnds& ends) {
  for (const SeparationGauge& gauge : gauges) {
    // Of a stress the noise is filed as the strain that it would be of long waves.
    const double unit =
        gauge.record == SeparationRecord::mean_stress_Pa ? std::abs(stiffness_.front()) : 1.0;
    shares_.push_back({gauge.position_m, unit * gauge.noise_rms, {}, {}});
    shares_.back().right.reserve(path_.size());
    shares_.back().left.reserve(path_.size());
  }
  std::vector<Row> rows(gauges.size());
  for (std::size_t k = 0; k < path_.size(); ++k) {
    const Complex gamma = modes_[k].gamma;
    const Complex across = across_[k];
    Normal normal;
    for (std::size_t j = 0; j < gauges.size(); ++j) {
      rows[j] = row_at(gauges[j].position_m, length_m_, gamma, across, ends);
      normal.add(rows[j], weight_of(gauges[j]));
    }
    for (std::size_t j = 0; j < gauges.size(); ++j) {
      // A stress tells the strain times the stiffness.
      const Complex unit =
          gauges[j].record == SeparationRecord::mean_stress_Pa ? 1.0 / stiffness_[k] : 1.0;
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
  DampedTransform& transform = work_->transform;
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
    work_->band.apply(band_limit_Hz_, *wave);
  }
}

WaveSeparation::Way WaveSeparation::way_to(double position_m) const {
  if (position_m == 0.0) {
    return {std::vector<Complex>(path_.size(), 1.0), across_};
  }
  if (position_m == length_m_) {
    return {across_, std::vector<Complex>(path_.size(), 1.0)};
  }
  Way way;
  way.from_start.reserve(path_.size());
  way.from_end.reserve(path_.size());
  for (const BarMode& mode : modes_) {
    way.from_start.push_back(std::exp(-mode.gamma * position_m));
    way.from_end.push_back(std::exp(-mode.gamma * (length_m_ - position_m)));
  }
  return way;
}

std::size_t WaveSeparation::known(double position_m) const {
  double nearest_m = length_m_;
  for (const Share& share : shares_) {
    nearest_m = std::min(nearest_m, std::abs(share.position_m - position_m));
  }
  const auto travel = static_cast<std::size_t>(std::ceil(nearest_m * slowest_s_per_m_ / period_s_));
  return samples_ - std::min(samples_, travel + looks_ahead_);
}

SeparatedWaves WaveSeparation::at(double position_m, StrainOf strain) const {
  DampedTransform& transform = work_->transform;
  const Way way = way_to(position_m);
  std::vector<Complex> right(path_.size());
  std::vector<Complex> left(path_.size());
  std::vector<Complex> stress(path_.size());
  std::vector<Complex> velocity(path_.size());
  for (std::size_t k = 0; k < path_.size(); ++k) {
    const Complex to_right = right_[k] * way.from_start[k];
    const Complex to_left = left_[k] * way.from_end[k];
    const Complex mean = modes_[k].mean_over_surface;
    const Complex read = strain == StrainOf::section ? mean : 1.0;
    right[k] = read * to_right;
    left[k] = read * to_left;
    stress[k] = stiffness_[k] * (to_right + to_left);
    velocity[k] = path_[k] / modes_[k].gamma * mean * (to_right - to_left);
  }
  const auto history = [&](const std::vector<Complex>& spectrum) {
    std::vector<double> record(samples_);
    transform.inverse(spectrum, record, lead_);
    return record;
  };
  return {history(right), history(left), history(stress), history(velocity)};
}

std::vector<double> WaveSeparation::stress_noise_Pa(double position_m, std::size_t quiet) const {
  DampedTransform& transform = work_->transform;
  std::vector<Complex> answer(transform.bins());
  std::vector<double> record(transform.length());
  std::vector<double> variance(samples_, 0.0);
  // The stress of a filtered wave that starts with the record.
  Way way = way_to(position_m);
  const double start_s = static_cast<double>(lead_) * period_s_;
  for (std::size_t k = 0; k < path_.size(); ++k) {
    const Complex stress = stiffness_[k] * std::exp(-path_[k] * start_s);
    way.from_start[k] *= stress;
    way.from_end[k] *= stress;
  }
  for (auto* direction : {&way.from_start, &way.from_end}) {
    work_->band.apply(band_limit_Hz_, *direction);
  }
  for (const Share& share : shares_) {
    const double white = share.noise_rms * share.noise_rms;
    if (white <= 0.0) {
      continue;
    }
    // The stress after one sample's unit error at the record's start.
    for (std::size_t k = 0; k < path_.size(); ++k) {
      answer[k] = share.right[k] * way.from_start[k] + share.left[k] * way.from_end[k];
    }
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
