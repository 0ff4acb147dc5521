#include "processing/identification/noise_spectrum.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <utility>

#include "processing/base/wide.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

namespace {

constexpr std::size_t kHighestOrder = 12;

/// Autocovariances at lags 0 .. kHighestOrder, pooled over the stretches.
std::vector<double> autocovariances(const std::vector<std::span<const double>>& quiet,
                                    std::size_t& samples) {
  std::vector<double> covariance(kHighestOrder + 1, 0.0);
  samples = 0;
  for (const auto& stretch : quiet) {
    if (stretch.empty()) {
      continue;
    }
    const Eigen::Map<const Eigen::VectorXd> own(stretch.data(),
                                                static_cast<Eigen::Index>(stretch.size()));
    const Eigen::VectorXd about_mean = own.array() - own.mean();
    for (std::size_t lag = 0; lag <= kHighestOrder && lag < stretch.size(); ++lag) {
      const auto left = static_cast<Eigen::Index>(stretch.size() - lag);
      covariance[lag] += about_mean.tail(left).dot(about_mean.head(left));
    }
    samples += stretch.size();
  }
  for (double& value : covariance) {
    value /= static_cast<double>(std::max<std::size_t>(samples, 1));
  }
  return covariance;
}

constexpr std::size_t kFewestForSpectrum = 32;
constexpr std::size_t kMostSlowParts = 4;
constexpr int kMostRounds = 20;
/// Share of themselves by which weights that are settled still move in a round.
constexpr double kSettled = 1e-5;
/// What a part with its two numbers must add to the log likelihood.
constexpr double kWorthAPart = 3.0;
/// What the autoregressive model must be ahead: what slow noise does in a record of some length
/// follows from the other one alone.
constexpr double kClearlyAhead = 12.0;

/// Power per sample, over its variance, that first-order noise shows in a stretch: its spectrum
/// through the window's (Fejer's) kernel. @param samples  0: without the window
double slow_power(double keep, double cycles, double n) {
  const std::complex<double> z = keep * std::polar(1.0, -2.0 * std::numbers::pi * cycles);
  std::complex<double> sum = 1.0 / (1.0 - z);
  if (n > 0.0) {
    sum -= z * (1.0 - std::pow(z, n)) / (n * (1.0 - z) * (1.0 - z));
  }
  return 2.0 * sum.real() - 1.0;
}

/// The same at whole cycles of a window of n samples, where z^n is keep^n: in real numbers, with
/// h = sin^2(pi cycles),
///     (1 - keep^2) / d - 2 (1 - keep^n) / n * keep ((1 - keep)^2 - 2 (1 + keep^2) h) / d^2,
///     d = |1 - z|^2 = (1 - keep)^2 + 4 keep h.
Eigen::ArrayXd slow_power_at_bins(double keep, double n, const Eigen::ArrayXd& h) {
  const double square = keep * keep;
  const double apart = (1.0 - keep) * (1.0 - keep);
  const double ends = 2.0 * keep * (1.0 - std::pow(keep, n)) / n;
  const Eigen::ArrayXd inverse = (apart + 4.0 * keep * h).inverse();
  return inverse * (1.0 - square - ends * (apart - 2.0 * (1.0 + square) * h) * inverse);
}

/// Mean power of the stretches' last `samples` at the transform's bins but that at zero.
NoiseSpectrum::Seen periodogram(const std::vector<std::span<const double>>& quiet) {
  NoiseSpectrum::Seen seen;
  std::size_t shortest = SIZE_MAX;
  for (const auto& stretch : quiet) {
    if (!stretch.empty()) {
      shortest = std::min(shortest, stretch.size());
      seen.stretches += 1.0;
    }
  }
  if (seen.stretches == 0.0 || shortest < kFewestForSpectrum) {
    return {};
  }
  std::size_t samples = shortest / 2 * 2;
  while (good_transform_length(samples) != samples) {
    samples -= 2;
  }
  seen.samples = static_cast<double>(samples);
  DampedTransform transform(samples, 1.0, 1.0);
  std::vector<Complex> spectrum(transform.bins());
  const std::size_t bins = transform.bins() - 2;
  seen.power.resize(bins);
  for (const auto& stretch : quiet) {
    if (stretch.empty()) {
      continue;
    }
    transform.forward(stretch.last(samples), spectrum);
    for (std::size_t k = 0; k < bins; ++k) {
      seen.power[k] += std::norm(spectrum[k + 1]) / (seen.samples * seen.stretches);
    }
  }
  for (std::size_t k = 0; k < bins; ++k) {
    seen.cycles.push_back(static_cast<double>(k + 1) / seen.samples);
  }
  return seen;
}

/// What a gauge's noise is known by, one stretch of bins after the other.
class Spectra {
 public:
  void add(const NoiseSpectrum::Seen& seen) {
    const auto count = static_cast<Eigen::Index>(seen.power.size());
    if (count == 0) {
      return;
    }
    const Eigen::Map<const Eigen::ArrayXd> cycles(seen.cycles.data(), count);
    kinds_.push_back({seen.samples, (std::numbers::pi * cycles).sin().square()});
    append(Eigen::Map<const Eigen::ArrayXd>(seen.power.data(), count), power_);
    append(Eigen::ArrayXd::Constant(count, seen.stretches), stretches_);
    append(cycles, cycles_);
    longest_ = std::max(longest_, seen.samples);
  }

  [[nodiscard]] bool empty() const { return kinds_.empty(); }
  [[nodiscard]] double longest() const { return longest_; }
  [[nodiscard]] const Eigen::ArrayXd& power() const { return power_; }
  [[nodiscard]] const Eigen::ArrayXd& stretches() const { return stretches_; }
  [[nodiscard]] const Eigen::ArrayXd& cycles() const { return cycles_; }

  /// What first-order noise of unit variance shows in them.
  [[nodiscard]] Eigen::ArrayXd of_part(double keep) const {
    Eigen::ArrayXd shown;
    for (const Kind& kind : kinds_) {
      append(slow_power_at_bins(keep, kind.samples, kind.half_turn), shown);
    }
    return shown;
  }

  /// Where each octave's bins begin, and how many there are.
  [[nodiscard]] std::vector<std::pair<Eigen::Index, Eigen::Index>> octaves() const {
    std::vector<std::pair<Eigen::Index, Eigen::Index>> list;
    Eigen::Index begin = 0;
    for (const Kind& kind : kinds_) {
      const Eigen::Index bins = kind.half_turn.size();
      for (Eigen::Index first = 0; first < bins;) {
        const Eigen::Index count = std::min(bins, std::max<Eigen::Index>(2, 2 * first)) - first;
        list.emplace_back(begin + first, count);
        first += count;
      }
      begin += bins;
    }
    return list;
  }

  /// Whittle's log likelihood of a model's powers.
  [[nodiscard]] double log_likelihood(const Eigen::ArrayXd& model) const {
    return -(stretches_ * (model.log() + power_ / model)).sum();
  }

 private:
  struct Kind {
    double samples;
    Eigen::ArrayXd half_turn;  ///< sin^2(pi cycles)
  };

  static void append(const Eigen::ArrayXd& values, Eigen::ArrayXd& to) {
    Eigen::ArrayXd both(to.size() + values.size());
    both << to, values;
    to = std::move(both);
  }

  std::vector<Kind> kinds_;
  Eigen::ArrayXd power_;
  Eigen::ArrayXd stretches_;  ///< by bin
  Eigen::ArrayXd cycles_;
  double longest_ = 0.0;
};

Eigen::ArrayXd mean_power(const std::vector<Spectra>& gauges, const std::vector<double>& levels) {
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(gauges.front().power().size());
  for (std::size_t j = 0; j < gauges.size(); ++j) {
    sum += gauges[j].power() / levels[j];
  }
  return sum / static_cast<double>(gauges.size());
}

/// Where all gauges have the same spectrum, the chance of refusing it is about one in a thousand.
constexpr double kUnlike = 3.1;

/// Of each gauge, over the mean of all.
std::vector<double> levels_of(const std::vector<Spectra>& gauges) {
  constexpr int kRounds = 3;
  std::vector<double> levels(gauges.size(), 1.0);
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::ArrayXd mean = mean_power(gauges, levels);
    for (std::size_t j = 0; j < gauges.size(); ++j) {
      levels[j] = (gauges[j].power() / mean).mean();
    }
  }
  return levels;
}

/// By the scatter of their powers over the mean, octave by octave.
bool are_alike(const std::vector<Spectra>& gauges, const std::vector<double>& levels) {
  const Eigen::ArrayXd mean = mean_power(gauges, levels);
  double squares = 0.0;
  double octaves = 0.0;
  for (const auto& [first, count] : gauges.front().octaves()) {
    for (std::size_t j = 0; j < gauges.size(); ++j) {
      const Eigen::ArrayXd over =
          gauges[j].power().segment(first, count) / (levels[j] * mean.segment(first, count));
      squares += std::pow(over.mean() - 1.0, 2) * gauges[j].stretches().segment(first, count).sum();
    }
    octaves += 1.0;
  }
  const double freedom = (static_cast<double>(gauges.size()) - 1.0) * (octaves - 1.0);
  return squares < freedom + kUnlike * std::sqrt(2.0 * freedom);
}

// Bins go through the sums four at a time, whatever the machine: on every one to the same bits.
using Four = double __attribute__((vector_size(32), aligned(8), may_alias));

const Four* fours(const Eigen::ArrayXd& values) {
  return reinterpret_cast<const Four*>(values.data());
}

/// With zeros up to a multiple of four.
Eigen::ArrayXd in_fours(const Eigen::ArrayXd& values) {
  Eigen::ArrayXd out = Eigen::ArrayXd::Zero((values.size() + 3) / 4 * 4);
  out.head(values.size()) = values;
  return out;
}

KOLSKY_WIDE void put_inverse_of_sum(const std::vector<Eigen::ArrayXd>& parts,
                                    const std::vector<double>& weights, Eigen::ArrayXd& inverse) {
  auto* const inverses = reinterpret_cast<Four*>(inverse.data());
  for (Eigen::Index q = 0; q < inverse.size() / 4; ++q) {
    // Beyond the last bin all parts are 0: what they are divided by must not be.
    Four sum = Four{} + std::numeric_limits<double>::min();
    for (std::size_t part = 0; part < parts.size(); ++part) {
      sum += weights[part] * fours(parts[part])[q];
    }
    inverses[q] = 1.0 / sum;
  }
}

/// What data of this power ask of a part whose weight should grow or shrink, over what it gives.
/// @param inverse  of the sum of all parts
KOLSKY_WIDE double asked_over_given(const Eigen::ArrayXd& part, const Eigen::ArrayXd& inverse,
                                    const Eigen::ArrayXd& power, const Eigen::ArrayXd& stretches) {
  Four asked{};
  Four given{};
  for (Eigen::Index q = 0; q < part.size() / 4; ++q) {
    const Four own = fours(stretches)[q] * fours(part)[q] * fours(inverse)[q];
    given += own;
    asked += own * fours(inverse)[q] * fours(power)[q];
  }
  return (asked[0] + asked[1] + asked[2] + asked[3]) / (given[0] + given[1] + given[2] + given[3]);
}

}  // namespace

/// A sum of parts with positive weights, fitted to a periodogram.
class NoiseSpectrum::Fit {
 public:
  explicit Fit(const Spectra& data)
      : data_(&data),
        power_(in_fours(data.power())),
        stretches_(in_fours(data.stretches())),
        parts_{in_fours(Eigen::ArrayXd::Ones(data.power().size()))},
        weights_{data.power().mean()} {
    refine();
  }

  void add(double keep) {
    const Eigen::ArrayXd part = data_->of_part(keep);
    parts_.push_back(in_fours(part));
    weights_.push_back(0.3 * weights_[0] / part.mean());
    keeps_.push_back(keep);
    refine();
  }

  [[nodiscard]] double log_likelihood() const {
    Eigen::ArrayXd model = Eigen::ArrayXd::Zero(data_->power().size());
    for (std::size_t part = 0; part < parts_.size(); ++part) {
      model += weights_[part] * parts_[part].head(model.size());
    }
    return data_->log_likelihood(model);
  }
  [[nodiscard]] double white() const { return weights_[0]; }
  [[nodiscard]] std::vector<SlowPart> slow() const {
    std::vector<SlowPart> list;
    for (std::size_t i = 0; i < keeps_.size(); ++i) {
      list.push_back({weights_[i + 1], keeps_[i]});
    }
    return list;
  }

 private:
  /// Steps that multiply the weights and keep them positive. Under the square roots of these
  /// factors the likelihood is known never to fall; with the factors themselves, twice as far, it
  /// has not been seen to either (Fevotte and Idier 2011).
  void refine() {
    Eigen::ArrayXd inverse(power_.size());
    double moved = 1.0;
    for (int round = 0; round < kMostRounds && moved > kSettled; ++round) {
      put_inverse_of_sum(parts_, weights_, inverse);
      moved = 0.0;
      for (std::size_t part = 0; part < parts_.size(); ++part) {
        const double factor = asked_over_given(parts_[part], inverse, power_, stretches_);
        weights_[part] *= factor;
        moved = std::max(moved, std::abs(factor - 1.0));
      }
    }
  }

  const Spectra* data_;
  Eigen::ArrayXd power_;
  Eigen::ArrayXd stretches_;
  std::vector<Eigen::ArrayXd> parts_;  ///< what each shows at each bin; white noise first
  std::vector<double> weights_;        ///< likewise
  std::vector<double> keeps_;
};

double NoiseSpectrum::Autoregression::power(double cycles_per_sample) const {
  std::complex<double> denominator = 1.0;
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    const double phase = -2.0 * std::numbers::pi * cycles_per_sample * static_cast<double>(i + 1);
    denominator += coefficients[i] * std::polar(1.0, phase);
  }
  return innovation / std::norm(denominator);
}

NoiseSpectrum::Autoregression NoiseSpectrum::autoregression(
    const std::vector<std::span<const double>>& quiet) {
  std::size_t samples = 0;
  const std::vector<double> r = autocovariances(quiet, samples);
  Autoregression chosen{r[0], {}};
  if (r[0] <= 0.0) {
    return chosen;
  }
  // Levinson's recursion; of its orders the one with the smallest criterion is kept.
  std::vector<double> a;
  double error = r[0];
  double best = static_cast<double>(samples) * std::log(error);
  for (std::size_t order = 1; order <= kHighestOrder; ++order) {
    double reflection = r[order];
    for (std::size_t i = 0; i < a.size(); ++i) {
      reflection += a[i] * r[order - 1 - i];
    }
    reflection /= -error;
    std::vector<double> next(order);
    for (std::size_t i = 0; i < a.size(); ++i) {
      next[i] = a[i] + reflection * a[a.size() - 1 - i];
    }
    next[order - 1] = reflection;
    a = std::move(next);
    error *= 1.0 - reflection * reflection;
    const double criterion = static_cast<double>(samples) * std::log(std::max(error, 1e-300)) +
                             std::log(static_cast<double>(std::max<std::size_t>(samples, 3))) *
                                 static_cast<double>(order);
    if (criterion < best) {
      best = criterion;
      chosen = {error, a};
    }
  }
  return chosen;
}

NoiseSpectrum::NoiseSpectrum(const std::vector<std::span<const double>>& quiet)
    : NoiseSpectrum(quiet, Seen{}) {}

NoiseSpectrum::NoiseSpectrum(const std::vector<std::span<const double>>& quiet, const Seen& seen) {
  const Autoregression shaped = autoregression(quiet);
  Spectra data;
  data.add(periodogram(quiet));
  data.add(seen);
  if (data.empty() || shaped.innovation <= 0.0) {
    shaped_ = shaped;
    return;
  }
  Fit best(data);
  double likelihood = best.log_likelihood();
  for (std::size_t parts = 0; parts < kMostSlowParts; ++parts) {
    Fit next = best;
    double highest = -1e300;
    double likely = 1.0;
    const auto look = [&](double time) {
      Fit with = best;
      with.add(std::exp(-1.0 / time));
      if (const double its = with.log_likelihood(); its > highest) {
        highest = its;
        likely = time;
        next = with;
      }
    };
    for (double time = 1.0; time < 4.0 * data.longest(); time *= 2.0) {
      look(time);
    }
    if (highest < likelihood + kWorthAPart / 2.0) {
      break;  // what gains so little at octaves has not been seen to do between them
    }
    for (const double factor : {std::numbers::sqrt2, std::sqrt(std::numbers::sqrt2)}) {
      const double centre = likely;
      look(centre * factor);
      look(centre / factor);
    }
    if (highest < likelihood + kWorthAPart) {
      break;
    }
    likelihood = highest;
    best = next;
  }
  white_ = best.white();
  slow_ = best.slow();
  const Eigen::ArrayXd powers =
      data.cycles().unaryExpr([&](double cycles) { return shaped.power(cycles); });
  const double own = likelihood - 2.0 * static_cast<double>(slow_.size());
  const double others =
      data.log_likelihood(powers) - static_cast<double>(shaped.coefficients.size());
  if (others > own + kClearlyAhead) {
    shaped_ = shaped;
    slow_.clear();
  }
}

NoiseSpectrum NoiseSpectrum::at_level(double level) const {
  NoiseSpectrum scaled = *this;
  scaled.white_ *= level;
  scaled.shaped_.innovation *= level;
  for (SlowPart& part : scaled.slow_) {
    part.variance *= level;
  }
  return scaled;
}

std::vector<NoiseSpectrum> NoiseSpectrum::of_gauges(
    const std::vector<std::vector<std::span<const double>>>& quiet, const std::vector<Seen>& seen) {
  std::vector<Spectra> gauges(quiet.size());
  bool comparable = true;
  for (std::size_t j = 0; j < gauges.size(); ++j) {
    gauges[j].add(periodogram(quiet[j]));
    gauges[j].add(seen[j]);
    comparable = comparable && !gauges[j].empty() && gauges[j].power().minCoeff() > 0.0 &&
                 gauges[j].power().size() == gauges[0].power().size();
  }
  std::vector<NoiseSpectrum> spectra;
  const std::vector<double> levels = comparable ? levels_of(gauges) : std::vector<double>{};
  if (!comparable || !are_alike(gauges, levels)) {
    for (std::size_t j = 0; j < gauges.size(); ++j) {
      spectra.emplace_back(quiet[j], seen[j]);
    }
    return spectra;
  }
  std::vector<std::vector<double>> levelled;
  Seen together = seen.front();
  together.stretches = 0.0;
  std::fill(together.power.begin(), together.power.end(), 0.0);
  for (std::size_t j = 0; j < gauges.size(); ++j) {
    for (const auto& stretch : quiet[j]) {
      auto& own = levelled.emplace_back(stretch.begin(), stretch.end());
      std::transform(own.begin(), own.end(), own.begin(),
                     [&](double value) { return value / std::sqrt(levels[j]); });
    }
    together.stretches += seen[j].stretches;
    for (std::size_t k = 0; k < together.power.size(); ++k) {
      together.power[k] += seen[j].power[k] / (levels[j] * static_cast<double>(gauges.size()));
    }
  }
  const NoiseSpectrum shape({levelled.begin(), levelled.end()}, together);
  for (const double level : levels) {
    spectra.push_back(shape.at_level(level));
  }
  return spectra;
}

double NoiseSpectrum::power(double cycles_per_sample) const {
  return power_within(cycles_per_sample, 0.0);
}

double NoiseSpectrum::power_within(double cycles_per_sample, double samples) const {
  if (shaped_.innovation > 0.0) {
    return shaped_.power(cycles_per_sample);
  }
  double total = white_;
  for (const SlowPart& part : slow_) {
    total += part.power(cycles_per_sample, samples);
  }
  return total;
}

double NoiseSpectrum::SlowPart::power(double cycles_per_sample, double samples) const {
  return variance * slow_power(keep, cycles_per_sample, samples);
}

double NoiseSpectrum::SlowPart::variance_of_mean(double samples) const {
  return variance * slow_power(keep, 0.0, samples) / samples;
}

double NoiseSpectrum::variance_of_mean(std::size_t samples) const {
  const auto count = static_cast<double>(samples);
  if (shaped_.innovation > 0.0) {
    return shaped_.power(0.0) / count;
  }
  double total = white_ / count;
  for (const SlowPart& part : slow_) {
    total += part.variance_of_mean(count);
  }
  return total;
}

std::size_t NoiseSpectrum::order() const {
  return shaped_.innovation > 0.0 ? shaped_.coefficients.size() : 2 * slow_.size();
}

}  // namespace kolsky
