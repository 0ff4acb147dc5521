#include "processing/reduction/validity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "processing/reduction/loop_summary.hpp"
#include "processing/reduction/pulse.hpp"
#include "processing/reduction/quality.hpp"
#include "processing/reduction/stations.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

namespace {

constexpr double kWindow_s = 10e-6;
constexpr double kFewestForce = 0.05;  // of the peak
/// Of the pulse's energy: less is its edges, more the height of what is between them.
constexpr double kMostLeftOut = 0.1;
constexpr double kUseful_dB = 10.0;
constexpr double kBand_Hz = 1e3;  // that power is averaged over, at least
constexpr std::size_t kBands = 40;

/// Sums of the first n values.
std::vector<double> running_sums(const std::vector<double>& values) {
  std::vector<double> sums(values.size() + 1, 0.0);
  for (std::size_t n = 0; n < values.size(); ++n) {
    sums[n + 1] = sums[n] + values[n];
  }
  return sums;
}

std::string quote_text(const Quotable& part) {
  std::array<char, 100> text{};
  (void)std::snprintf(text.data(), text.size(),
                      "from %.1f to %.1f us, strains of %.3g to %.3g: ", 1e6 * part.from_s,
                      1e6 * part.to_s, part.from_strain, part.to_strain);
  return text.data() +
         std::string(part.assumed
                         ? "there the specimen is loaded and its own waves have crossed it a few "
                           "times; that both faces carry the same force is assumed, not tested"
                         : "there both faces carry the same force and the specimen is loaded");
}

/// Why the curve must not be quoted at all; empty where it may.
std::string curve_in_doubt(const Reduction& r) {
  // Causes before what follows from them.
  for (const char* name : {"quiet_start", "gauge_sign", "gauge_order", "gauge_silent", "bar_strain",
                           "specimen_strain"}) {
    const Check* check = r.quality.find(name);
    if (check != nullptr && check->verdict == Verdict::fail) {
      return check->text;
    }
  }
  const Check* overlap = r.quality.find("window_overlap");
  if (overlap != nullptr && overlap->verdict != Verdict::pass &&
      r.separation == Separation::never) {
    return overlap->text;
  }
  const Check* energy = r.quality.find("energy_balance");
  if (energy != nullptr && energy->verdict != Verdict::pass) {
    return energy->text;
  }
  const Check* band = r.quality.find("band");
  return band != nullptr && band->value > kMostLeftOut ? band->text : std::string();
}

/// A stretch of the loading, in samples.
struct Stretch {
  std::size_t begin = 0;
  std::size_t count = 0;
};

/// The longest in which the faces agree throughout.
Stretch longest_agreement(const Reduction& r, std::size_t end) {
  const auto apart = disagreement(r);
  Stretch best;
  std::size_t from = 0;
  for (std::size_t n = 0; n + 1 < end; ++n) {
    if (!(apart[n] <= kEquilibriumLimit)) {
      from = n + 1;
    } else if (n + 1 - from > best.count) {
      best = {from, n + 1 - from};
    }
  }
  return best;
}

/// The rest of the loading from when equilibrium may be assumed.
Stretch assumed_agreement(const Reduction& r, std::size_t end) {
  const auto from = static_cast<std::size_t>(
      std::lower_bound(r.time_s.begin(), r.time_s.end(), r.assumed_from_s) - r.time_s.begin());
  return from + 1 < end ? Stretch{from, end - 1 - from} : Stretch{};
}

const char* nothing_to_quote(const Reduction& r) {
  if (r.separation != Separation::equilibrium) {
    return "no part of the curve: the faces never carry the same force while it is loaded";
  }
  return std::isfinite(r.assumed_from_s)
             ? "no part of the curve: that both faces carry the same force is assumed, not tested, "
               "and the loading is over before the specimen's own waves have crossed it a few times"
             : "no part of the curve: that both faces carry the same force is assumed, not tested, "
               "and without specimen.density_kg_m3 nothing says from when that may be";
}

/// Power of a record by band, over that of its noise [dB].
class BandPower {
 public:
  BandPower(std::size_t samples, double period_s, std::size_t quiet, double highest_Hz)
      : transform_(samples, period_s, 1.0),
        spectrum_(transform_.bins()),
        quiet_(quiet),
        width_(std::max<std::size_t>(
            1,
            static_cast<std::size_t>(std::max(kBand_Hz, highest_Hz / static_cast<double>(kBands)) /
                                     transform_.bin_width_Hz()))) {}

  [[nodiscard]] std::vector<double> of(const std::vector<double>& record) {
    const double noise = quiet_before(record, quiet_).noise_rms;
    const double noise_power = noise * noise * static_cast<double>(record.size());
    const bool silent = *std::max_element(record.begin(), record.end()) ==
                        *std::min_element(record.begin(), record.end());
    transform_.forward(record, spectrum_);
    std::vector<double> bands;
    for (std::size_t k = 1; k + width_ <= spectrum_.size() && bands.size() < kBands; k += width_) {
      double power = 0.0;
      for (std::size_t i = k; i < k + width_; ++i) {
        power += std::norm(spectrum_[i]) / static_cast<double>(width_);
      }
      constexpr double kMost_dB = 200.0;
      bands.push_back(silent ? -kMost_dB
                      : noise_power > 0.0
                          ? std::min(kMost_dB, 10.0 * std::log10(power / noise_power + 1e-20))
                          : kMost_dB);
    }
    return bands;
  }

  [[nodiscard]] double centre_Hz(std::size_t band) const {
    return (1.0 + (static_cast<double>(band) + 0.5) * static_cast<double>(width_) - 0.5) *
           transform_.bin_width_Hz();
  }
  [[nodiscard]] double top_Hz(std::size_t band) const {
    return static_cast<double>((band + 1) * width_) * transform_.bin_width_Hz();
  }

 private:
  DampedTransform transform_;
  std::vector<Complex> spectrum_;
  std::size_t quiet_;
  std::size_t width_;
};

}  // namespace

std::vector<double> disagreement(const Reduction& r) {
  const std::size_t count = std::min(r.force_front_N.size(), r.force_back_N.size());
  std::vector<double> list(r.time_s.size(), std::numeric_limits<double>::quiet_NaN());
  if (count < 2 || r.separation == Separation::equilibrium) {
    return list;
  }
  std::vector<double> difference(count);
  std::vector<double> mean(count);
  double peak = 0.0;
  for (std::size_t n = 0; n < count; ++n) {
    difference[n] = r.force_front_N[n] - r.force_back_N[n];
    mean[n] = (r.force_front_N[n] + r.force_back_N[n]) / 2.0;
    peak = std::max(peak, std::abs(mean[n]));
  }
  const auto differences = running_sums(difference);
  const auto means = running_sums(mean);
  const auto half = static_cast<std::size_t>(kWindow_s / 2.0 / (r.time_s[1] - r.time_s[0]));
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t from = n > half ? n - half : 0;
    const std::size_t to = std::min(count, n + half + 1);
    const double force = std::abs(means[to] - means[from]);
    if (force > kFewestForce * peak * static_cast<double>(to - from)) {
      list[n] = std::abs(differences[to] - differences[from]) / force;
    }
  }
  return list;
}

Quotable quotable_part(const Reduction& r) {
  Quotable part;
  if (!r.quality.reducible) {
    part.text = "no part of the curve: there is none, " + r.quality.reason;
    return part;
  }
  const std::string doubt = curve_in_doubt(r);
  if (!doubt.empty()) {
    part.text = "no part of the curve: " + doubt;
    return part;
  }
  part.text = nothing_to_quote(r);
  const std::size_t end = loading_end(r);
  const bool assumed = r.separation == Separation::equilibrium;
  const Stretch best = assumed ? assumed_agreement(r, end) : longest_agreement(r, end);
  constexpr std::size_t kFewest = 4;
  if (best.count < kFewest) {
    return part;
  }
  const std::size_t last = best.begin + best.count - 1;
  part = {true,           assumed, r.time_s[best.begin], r.time_s[last], r.strain[best.begin],
          r.strain[last], {}};
  part.text = quote_text(part);
  return part;
}

SpectralQuality spectral_quality(const Shot& shot, const Reduction& reduction) {
  SpectralQuality quality;
  if (!reduction.quality.reducible || reduction.time_s.empty() || shot.channels.empty()) {
    return quality;
  }
  const BarStation in = station_on(shot.bench, "input");
  const BarStation out = station_on(shot.bench, "output");
  const std::size_t quiet = reduction.quiet_samples;
  std::vector<double> strain(shot.samples());
  BandPower bands(shot.samples(), shot.rate.period_s(), quiet, 1.5 * reduction.band_limit_Hz);
  read_station(shot, in, quiet, strain);
  quality.input_dB = bands.of(strain);
  read_station(shot, out, quiet, strain);
  quality.output_dB = bands.of(strain);
  bool useful = true;
  for (std::size_t i = 0; i < quality.input_dB.size(); ++i) {
    quality.frequency_Hz.push_back(bands.centre_Hz(i));
    useful = useful && std::min(quality.input_dB[i], quality.output_dB[i]) >= kUseful_dB;
    if (useful) {
      quality.useful_band_Hz = bands.top_Hz(i);
    }
  }
  return quality;
}

}  // namespace kolsky
