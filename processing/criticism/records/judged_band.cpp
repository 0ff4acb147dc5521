#include "processing/criticism/records/judged_band.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "processing/base/error.hpp"
#include "processing/reduction/pulse.hpp"
#include "processing/reduction/requested.hpp"
#include "processing/waves/band_limit.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

namespace {

/// Zeros before and after each record, in time: the filter reaches to both sides, and what it
/// smears before the first sample would come round to the end, where undamping raises it.
constexpr double kLead_s = 100e-6;
/// The filter passes half at this multiple of the highest frequency that is judged.
constexpr double kFilterOverBand = 1.6;
/// Beyond this multiple of the filter's limit it has left nothing.
constexpr double kFilteredFrom = 2.2;
/// What the filter smears over the cut ends of a record reaches this many of its widths into it:
/// 5e-5 of what is cut off is left there, a tenth of a microstrain of a whole pulse.
constexpr double kEdge = 6.5;
constexpr std::size_t kFewestJudged = 64;
constexpr std::size_t kMostDecimation = 8;
/// Power over noise at the highest frequency judged. Where the source is as much noise as signal,
/// an effect's test rests on how well the noise of each gauge is known, and says little of the
/// effect. Between two bars, whose echoes ring, what is not linear fits noise there all the sooner:
/// a gauge's length of 60 mm was named among 151 campaigns with nothing hidden, judged to 12.
double power_over_noise(BenchKind kind) {
  return kind == BenchKind::shpb ? 30.0 : 15.0;
}

std::size_t small_factors(std::size_t n) {
  for (;; ++n) {
    std::size_t left = n;
    for (const std::size_t factor : {2U, 3U, 5U}) {
      while (left % factor == 0) {
        left /= factor;
      }
    }
    if (left == 1) {
      return n;
    }
  }
}

std::size_t shortest(const Campaign& campaign) {
  std::size_t samples = campaign.shots.front().strain.front().size();
  for (const CampaignShot& shot : campaign.shots) {
    samples = std::min(samples, shot.strain.front().size());
  }
  return samples;
}

std::size_t longest(const Campaign& campaign) {
  std::size_t samples = 0;
  for (const CampaignShot& shot : campaign.shots) {
    samples = std::max(samples, shot.strain.front().size());
  }
  return samples;
}

/// A length that stays even with small factors however far it is decimated.
std::size_t transform_length(std::size_t samples) {
  return 2 * kMostDecimation *
         small_factors((samples + 2 * kMostDecimation - 1) / (2 * kMostDecimation));
}

/// Where the middle shot's pulse falls below the noise of the reference gauge.
double limit_by_noise_Hz(const Campaign& campaign) {
  DampedTransform transform(longest(campaign), campaign.period_s, kWrapDamping);
  BandLimit limit(transform, transform.length());
  std::vector<double> limits_Hz;
  for (const CampaignShot& shot : campaign.shots) {
    const auto& record = shot.strain[campaign.reference];
    const double step = campaign.step[campaign.reference];
    const double noise =
        std::hypot(quiet_before(record, shot.quiet_samples).noise_rms, step / std::sqrt(12.0));
    limits_Hz.push_back(limit.from_noise(record, noise, power_over_noise(campaign.bench.kind)));
  }
  const auto middle = limits_Hz.begin() + static_cast<std::ptrdiff_t>(limits_Hz.size() / 2);
  std::nth_element(limits_Hz.begin(), middle, limits_Hz.end());
  return *middle;
}

/// Of an elastic wave through one radius of the bench's thicker bar, or where no modulus is filed
/// at this speed.
double time_through_radius_s(const Bench& bench, double unknown_speed_m_per_s) {
  const auto of_bar = [&](const Bar& bar) {
    const double speed_m_per_s = bar.youngs_modulus_Pa
                                     ? std::sqrt(*bar.youngs_modulus_Pa / bar.density_kg_m3)
                                     : unknown_speed_m_per_s;
    return bar.dispersion_radius_m() / speed_m_per_s;
  };
  const double input_s = of_bar(bench.input);
  return bench.output ? std::max(input_s, of_bar(*bench.output)) : input_s;
}

/// Surface gauges see little of waves as short as the bar is thick.
double limit_by_bars_Hz(const Bench& bench) {
  constexpr double kBlind = 0.25;
  constexpr double kPmma_m_per_s = 2200.0;
  return kBlind / time_through_radius_s(bench, kPmma_m_per_s);
}

/// Exact waves are known where they are damped little on their way through a radius (see
/// PochhammerChree): what is shorter is transformed as if it were so long.
std::size_t least_samples(const Campaign& campaign) {
  constexpr double kMostDamped = 0.08;
  constexpr double kSlow_m_per_s = 1500.0;
  const double least_s =
      -std::log(kWrapDamping) * time_through_radius_s(campaign.bench, kSlow_m_per_s) / kMostDamped;
  return static_cast<std::size_t>(std::ceil(least_s / campaign.period_s));
}

/// Even, of factors for which transforms have kernels of their own: 994 samples take six times as
/// long as 990.
bool is_quickly_transformed(std::size_t n) {
  for (const std::size_t factor : {2U, 3U, 5U, 7U, 11U, 13U}) {
    while (n % factor == 0) {
      n /= factor;
    }
  }
  return n == 1;
}

/// All but the records' edges, whatever is quickly transformed: what is not judged may hold the
/// whole of an effect (an end's reflection that comes as the record closes). A quicker length takes
/// what it needs of the edge before the pulses, where there is only noise to smear.
void choose_window(const Campaign& campaign, std::size_t edge, JudgedBand& band) {
  constexpr double kMostOfEdge = 0.6;
  const std::size_t d = band.decimation;
  const auto quiet = [&](const CampaignShot& shot) { return shot.quiet_samples > edge; };
  const auto spare = std::ranges::all_of(campaign.shots, quiet)
                         ? static_cast<std::size_t>(kMostOfEdge * static_cast<double>(edge / d))
                         : 0;
  const std::size_t all = (shortest(campaign) - 2 * edge) / (2 * d) * 2;
  std::size_t quick = all;
  while (!is_quickly_transformed(quick) && quick + 2 <= all + spare) {
    quick += 2;
  }
  band.judged = is_quickly_transformed(quick) ? quick : all;
  band.begin = edge - (band.judged - all) * d;
}

}  // namespace

JudgedBand judged_band(const Campaign& campaign, double asked_Hz) {
  const double rate_Hz = 1.0 / campaign.period_s;
  if (asked_Hz > 0.0) {
    require_band_of_record(asked_Hz, rate_Hz);
  }
  JudgedBand band;
  band.limit_Hz = asked_Hz > 0.0
                      ? asked_Hz
                      : std::min({limit_by_noise_Hz(campaign), limit_by_bars_Hz(campaign.bench),
                                  rate_Hz / 2.0 / (kFilterOverBand * kFilteredFrom)});
  band.filter_Hz = kFilterOverBand * band.limit_Hz;
  while (2 * band.decimation <= kMostDecimation &&
         rate_Hz / static_cast<double>(2 * band.decimation) / 2.0 >
             kFilteredFrom * band.filter_Hz) {
    band.decimation *= 2;
  }
  const std::size_t d = band.decimation;
  band.lead = d * static_cast<std::size_t>(std::ceil(kLead_s * rate_Hz / static_cast<double>(d)));
  const std::size_t edge =
      d * static_cast<std::size_t>(std::ceil(kEdge * BandLimit::smear_s(band.filter_Hz) * rate_Hz /
                                             static_cast<double>(d)));
  const std::size_t samples = shortest(campaign);
  if (samples < 2 * edge + kFewestJudged * d) {
    throw InputError(
        "samples",
        fmt::format("are too few: {} for a band up to {:.3g} Hz", samples, band.limit_Hz),
        asked_Hz > 0.0 ? "ask for a higher band limit" : "give longer records");
  }
  choose_window(campaign, edge, band);
  band.bin_width_Hz = rate_Hz / static_cast<double>(d * band.judged);
  band.bins_judged =
      std::min(band.judged / 2 - 1, static_cast<std::size_t>(band.limit_Hz / band.bin_width_Hz));
  if (band.bins_judged < 4) {
    throw InputError("band limit", "leaves no frequency to judge",
                     "give a wider band or a longer record");
  }
  band.transformed =
      transform_length(std::max(longest(campaign) + 2 * band.lead, least_samples(campaign)));
  const double carried_Hz = rate_Hz / static_cast<double>(band.transformed);
  band.bins_carried =
      std::min(band.transformed / d / 2 + 1,
               static_cast<std::size_t>(kFilteredFrom * band.filter_Hz / carried_Hz) + 1);
  return band;
}

}  // namespace kolsky
