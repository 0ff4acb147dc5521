#include "processing/identification/lowest_bins.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

namespace kolsky {

namespace {

using Responses = std::vector<std::vector<double>>;

/// Bins whose noise is taken together: to 15 kHz in records of 4 ms. Where losses show in them, an
/// average over returns states deviations that are 4 to 8 % small.
constexpr std::size_t kLowestBins = 60;
/// Noise that falls with frequency across these bins leaves much of the loss to those above them:
/// twice as many are taken then, without which eta2's intervals are 4 % small.
constexpr std::size_t kLowestBinsUnderFallingNoise = 120;
/// Places at which noise enters, per bin: what moves faster is not in them. With six times as many
/// deviations differ by less than 0.1 %.
constexpr std::size_t kPlacesPerBin = 8;

/// What first-order noise does, by independent causes: `shown` is by strides of so many samples,
/// over which the noise is taken by its mean.
EightColumns driven(EightColumns shown, const NoiseSpectrum::SlowPart& part, double samples) {
  constexpr Eigen::Index kEight = EightColumns::kEight;
  const double keep = std::pow(part.keep, samples);
  const double sd = std::sqrt(part.variance_of_mean(samples));
  const double sd_of_new = sd * std::sqrt(1.0 - keep * keep);
  for (Eigen::Index p = 0; p < shown.panels(); ++p) {
    double* const panel = shown.panel(p);
    for (Eigen::Index at = kEight * (shown.rows() - 1) - 1; at >= 0; --at) {
      panel[at] += keep * panel[at + kEight];
    }
    for (Eigen::Index at = 0; at < kEight * shown.rows(); ++at) {
      panel[at] *= at < kEight ? sd : sd_of_new;
    }
  }
  return shown;
}

double angle_per_place(const BarData::Places& places, std::size_t bin) {
  return -2.0 * std::numbers::pi * static_cast<double>(bin + 1) /
         static_cast<double>(places.judged());
}

/// From a first one on, each turned by an angle from the one before it.
void turn_on(Complex first, double angle, std::span<Complex> phases) {
  const Complex turn = std::polar(1.0, angle);
  for (Complex& phase : phases) {
    phase = first;
    first *= turn;
  }
}

/// The first `quiet` rows less the sum of all rows over their number.
void take_off_quiet_mean(Eigen::Index quiet, EightColumns& shown) {
  constexpr Eigen::Index kEight = EightColumns::kEight;
  for (Eigen::Index p = 0; p < shown.panels(); ++p) {
    double* const panel = shown.panel(p);
    std::array<double, kEight> mean{};
    for (Eigen::Index at = 0; at < kEight * shown.rows(); ++at) {
      mean[static_cast<std::size_t>(at % kEight)] += panel[at] / static_cast<double>(quiet);
    }
    for (Eigen::Index at = 0; at < kEight * std::min(quiet, shown.rows()); ++at) {
      panel[at] -= mean[static_cast<std::size_t>(at % kEight)];
    }
  }
}

/// Whether slow noise begins to fall in the upper half of the lowest bins or just beyond them.
bool noise_falls_across_lowest_bins(const BarData& data, const BarNoise& noise) {
  const double top_cycles =
      static_cast<double>(kLowestBins) /
      (data.places().samples_per_place * static_cast<double>(data.places().judged()));
  for (std::size_t gauge = 0; gauge < data.gauges(); ++gauge) {
    for (const auto& part : noise.slow(gauge)) {
      const double knee_cycles = -std::log(part.keep) / (2.0 * std::numbers::pi);
      if (part.is_slow() && knee_cycles > 0.5 * top_cycles) {
        return true;
      }
    }
  }
  return false;
}

/// What a unit of gauge 0's reading over one stride shows at the others in the lowest bins. Columns
/// as the rows in `white`, a row a stride. The response from its place to the end of what is
/// judged: differences of sums over one response. The mean of the quiet strides is taken off, as it
/// is from the records.
EightColumns shown_by_first(const BarData& data, const Responses& responses, std::size_t bins,
                            std::size_t stride) {
  const BarData::Places& places = data.places();
  const std::size_t others = responses.size();
  const auto begin = static_cast<std::size_t>(places.records_begin);
  const std::size_t entries = (places.judged_end - begin) / stride;
  const double samples = static_cast<double>(stride) * places.samples_per_place;
  EightColumns shown(static_cast<Eigen::Index>(entries),
                     static_cast<Eigen::Index>(2 * others * bins));
  std::vector<Complex> phases(places.judged_end);
  std::vector<Complex> shifts(entries);
  std::vector<Complex> sums(places.judged_end + 1);
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const double angle = angle_per_place(places, bin);
    turn_on(1.0, angle, phases);
    turn_on(samples * data.undo_filter(bin) *
                std::polar(1.0, -angle * static_cast<double>(places.judged_begin)),
            angle * static_cast<double>(stride), shifts);
    for (std::size_t j = 0; j < others; ++j) {
      for (std::size_t n = 0; n < phases.size(); ++n) {
        sums[n + 1] = sums[n] + responses[j][n] * phases[n];
      }
      const auto column = static_cast<Eigen::Index>(2 * others * bin + j);
      for (std::size_t e = 0; e < entries; ++e) {
        const std::size_t late = e * stride;
        const std::size_t first = places.judged_begin > late ? places.judged_begin - late : 0;
        const Complex seen = shifts[e] * (sums[places.judged_end - late] - sums[first]);
        shown(static_cast<Eigen::Index>(e), column) = seen.real();
        shown(static_cast<Eigen::Index>(e), column + static_cast<Eigen::Index>(others)) =
            seen.imag();
      }
    }
  }
  take_off_quiet_mean(std::max<Eigen::Index>(
                          1, static_cast<Eigen::Index>((places.quiet_end - places.records_begin) /
                                                       static_cast<double>(stride))),
                      shown);
  return shown;
}

/// The same of a gauge's own reading in its own columns, from where the judging begins.
EightColumns shown_by_own(const BarData::Places& places, std::size_t bins, std::size_t stride) {
  EightColumns shown(static_cast<Eigen::Index>(places.judged() / stride),
                     static_cast<Eigen::Index>(2 * bins));
  for (Eigen::Index bin = 0; bin < static_cast<Eigen::Index>(bins); ++bin) {
    const double angle =
        angle_per_place(places, static_cast<std::size_t>(bin)) * static_cast<double>(stride);
    for (Eigen::Index e = 0; e < shown.rows(); ++e) {
      const Complex seen = std::polar(static_cast<double>(stride), angle * static_cast<double>(e));
      shown(e, 2 * bin) = seen.real();
      shown(e, 2 * bin + 1) = seen.imag();
    }
  }
  return shown;
}

}  // namespace

std::size_t bins_taken_together(const BarData& data, const BarNoise& noise) {
  const std::size_t wanted =
      noise_falls_across_lowest_bins(data, noise) ? kLowestBinsUnderFallingNoise : kLowestBins;
  return std::min(wanted, data.judged_path().size());
}

LowerTriangle factor_of_lowest_bins(const BarData& data, const BarNoise& noise,
                                    const std::vector<std::vector<double>>& responses,
                                    std::size_t lowest_bins) {
  const BarData::Places& places = data.places();
  const auto others = static_cast<Eigen::Index>(data.gauges() - 1);
  const auto bins = static_cast<Eigen::Index>(lowest_bins);
  const auto judged = static_cast<double>(places.judged());
  const auto stride = std::max<std::size_t>(1, places.judged() / (kPlacesPerBin * lowest_bins));
  const double samples = static_cast<double>(stride) * places.samples_per_place;
  // Power per sample of what is not in the slow parts, which are treated each by itself.
  const auto steady = [&](std::size_t gauge, std::size_t bin) {
    double power = noise.power[gauge][bin] * places.samples_per_place / judged;
    const double cycles =
        data.judged_path()[bin].imag() / (2.0 * std::numbers::pi) * data.records().front().period_s;
    for (const auto& part : noise.slow(gauge)) {
      power -= part.power(cycles);
    }
    return std::max(power, 0.0);
  };
  EightColumns by_first = shown_by_first(data, responses, lowest_bins, stride);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(2 * others * bins, 2 * others * bins);
  for (const auto& part : noise.slow(0)) {
    add_square(driven(by_first, part, samples), covariance);
  }
  for (Eigen::Index bin = 0; bin < bins; ++bin) {
    const double sd = std::sqrt(steady(0, static_cast<std::size_t>(bin)) / samples);
    for (Eigen::Index i = 0; i < 2 * others; ++i) {
      by_first.scale(2 * others * bin + i, sd);
    }
  }
  add_square(by_first, covariance);
  for (Eigen::Index j = 0; j < others; ++j) {
    const auto gauge = static_cast<std::size_t>(j) + 1;
    Eigen::MatrixXd own = Eigen::MatrixXd::Zero(2 * bins, 2 * bins);
    if (!noise.slow(gauge).empty()) {
      const EightColumns by_own = shown_by_own(places, lowest_bins, stride);
      for (const auto& part : noise.slow(gauge)) {
        add_square(driven(by_own, part, samples), own);
      }
    }
    for (Eigen::Index bin = 0; bin < bins; ++bin) {
      const double half =
          0.5 * steady(gauge, static_cast<std::size_t>(bin)) * judged / places.samples_per_place;
      own(2 * bin, 2 * bin) += half;
      own(2 * bin + 1, 2 * bin + 1) += half;
    }
    const auto place = [&](Eigen::Index i) { return 2 * others * (i / 2) + j + others * (i % 2); };
    for (Eigen::Index a = 0; a < 2 * bins; ++a) {
      for (Eigen::Index b = 0; b <= a; ++b) {
        covariance(place(a), place(b)) += own(a, b);
      }
    }
  }
  const Eigen::LLT<Eigen::MatrixXd, Eigen::Lower> factor(covariance);
  return LowerTriangle(factor.matrixLLT());
}

}  // namespace kolsky
