#include "processing/reduction/quality.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "processing/reduction/cut_off.hpp"
#include "processing/reduction/formatted.hpp"
#include "processing/reduction/loop_summary.hpp"
#include "processing/reduction/record_faults.hpp"

namespace kolsky {

namespace {

constexpr double kEnergyLimit = 0.05;
constexpr double kLateralLimit = 0.05;
constexpr double kGaugeLengthLimit = 0.02;
constexpr double kBandLossLimit = 0.02;
constexpr double kSignalToNoiseLimit_dB = 30.0;
constexpr double kSignalToNoiseFloor_dB = 15.0;
constexpr double kOverlapFloor = 5.0;  // limits
constexpr double kClosureLimit = 0.10;
constexpr double kSeparationLimit = 0.10;
constexpr double kSeparationNoiseLimit = 0.02;
constexpr double kFewQuietSamples = 64;
/// Share of the peak force below which a specimen counts as unloaded.
constexpr double kUnloaded = 0.10;
/// The largest strain within the last of so many parts of the histories: it may well grow on.
constexpr std::size_t kLastPart = 50;

/// The loading: from the start to the largest strain.
Check equilibrium(const Reduction& r, std::size_t end) {
  double squares = 0.0;
  double sum = 0.0;
  for (std::size_t n = 0; n < end; ++n) {
    const double difference = r.force_front_N[n] - r.force_back_N[n];
    squares += difference * difference;
    sum += (r.force_front_N[n] + r.force_back_N[n]) / 2.0;
  }
  const auto count = static_cast<double>(end);
  const double mean = std::abs(sum) / count;
  Check check{.name = "equilibrium", .limit = kEquilibriumLimit, .unit = "1", .text = {}};
  check.value = mean > 0.0 ? std::sqrt(squares / count) / mean : 1.0;
  check.verdict = check.value <= kEquilibriumLimit ? Verdict::pass : Verdict::warn;
  check.text =
      check.verdict == Verdict::pass
          ? formatted("front and back force agree to %.1f %% rms over the loading (limit %.0f %%)",
                      100 * check.value, 100 * kEquilibriumLimit)
          : formatted(
                "front and back force differ by %.1f %% rms over the loading (limit %.0f %%): "
                "not in equilibrium, or the bench is not as filed",
                100 * check.value, 100 * kEquilibriumLimit);
  return check;
}

double decibels(double peak, double noise_rms) {
  constexpr double kNoiseless_dB = 200.0;
  if (peak <= 0.0) {
    return -kNoiseless_dB;
  }
  if (noise_rms <= 0.0) {
    return kNoiseless_dB;
  }
  return std::min(kNoiseless_dB, 20.0 * std::log10(peak / noise_rms));
}

Check signal_to_noise(const QualityInputs& in) {
  const double input_dB = decibels(in.input_peak, in.input_noise_rms);
  const double output_dB = decibels(in.output_peak, in.output_noise_rms);
  Check check{.name = "signal_to_noise", .limit = kSignalToNoiseLimit_dB, .unit = "dB", .text = {}};
  check.value = std::min(input_dB, output_dB);
  check.verdict = check.value >= kSignalToNoiseLimit_dB   ? Verdict::pass
                  : check.value >= kSignalToNoiseFloor_dB ? Verdict::warn
                                                          : Verdict::fail;
  check.text =
      formatted("pulse peaks over noise rms: %.1f dB on the input bar, %.1f dB on the output bar",
                input_dB, output_dB);
  if (in.output_peak <= 0.0) {
    check.text += ": the output bar's gauge reads the same all along, is it connected?";
  }
  return check;
}

Check window_overlap(const QualityInputs& in) {
  Check check{.name = "window_overlap", .limit = in.push_limit, .unit = "1", .text = {}};
  check.value = in.push_left_share;
  check.verdict = check.value <= check.limit                   ? Verdict::pass
                  : check.value <= kOverlapFloor * check.limit ? Verdict::warn
                                                               : Verdict::fail;
  check.text =
      check.verdict == Verdict::pass
          ? formatted(
                "the striker has left before the reflection hides its push: %.1f %% of "
                "the peak is left "
                "(limit %.1f %%)",
                100 * check.value, 100 * check.limit)
          : formatted(
                "%.1f %% of the striker's push is left when the reflection hides it "
                "(limit %.1f %%), if it stays %.0f %% of the largest strain is missing",
                100 * check.value, 100 * check.limit, 100 * check.value * in.strain_per_push) +
                ": it takes " + longer_window(in.gauge_to_specimen_m, in.wave_speed_m_per_s);
  return check;
}

/// The same where the waves are told apart by more than time.
Check separated_overlap(const QualityInputs& in) {
  Check check{.name = "window_overlap", .limit = in.push_limit, .unit = "1", .text = {}};
  check.value = in.push_left_share;
  const SeparationJudgement& separated = *in.separated;
  check.text = formatted("%.1f %% of the striker's push is left when the reflection hides it",
                         100 * check.value) +
               ": the waves both ways are told apart by " + separated.gauges +
               (separated.assumes_equilibrium ? " and the output bar's force" : "") +
               (separated.ends_in_loading ? "; the record ends before the first loading does" : "");
  check.verdict = separated.ends_in_loading ? Verdict::warn : Verdict::pass;
  return check;
}

std::string blind_text(const std::vector<double>& blind_Hz) {
  if (blind_Hz.empty()) {
    return "; blind at no frequency within the band";
  }
  constexpr std::size_t kMost = 6;
  std::string text = "; blind at ";
  for (std::size_t i = 0; i < std::min(kMost, blind_Hz.size()); ++i) {
    text += (i == 0 ? "" : ", ") + formatted("%.2f", 1e-3 * blind_Hz[i]);
  }
  return text + (blind_Hz.size() > kMost ? " ... kHz" : " kHz");
}

/// What the gauges' noise becomes where they tell the waves apart: little at first, more with time,
/// most of it at the frequencies at which they are blind.
Check separated_noise(const SeparationJudgement& separated) {
  Check check{.name = "separated_noise", .limit = kSeparationNoiseLimit, .unit = "1", .text = {}};
  check.value = separated.noise_share;
  check.verdict = check.value <= kSeparationNoiseLimit ? Verdict::pass : Verdict::warn;
  check.text = formatted(
                   "telling the waves apart leaves noise of %.2f %% of its peak in the front force "
                   "at the histories' end (limit %.0f %%)",
                   100 * check.value, 100 * kSeparationNoiseLimit) +
               blind_text(separated.blind_Hz);
  return check;
}

/// A check of front against back where both are the output bar's.
Check untested(Check check, Verdict verdict) {
  check.value = 0.0;
  check.verdict = verdict;
  check.text = "not tested: the front face's force is taken to be the back's";
  return check;
}

double mean_force_N(const Reduction& r, std::size_t n) {
  return std::abs(r.force_front_N[n] + r.force_back_N[n]) / 2.0;
}

/// Where the specimen has come back furthest before it is loaded again, as by a wave that returns;
/// the last sample where it is not.
std::size_t at_rest(const Reduction& r, std::size_t end) {
  constexpr double kFree = 0.1;
  constexpr double kLoaded = 0.25;
  double peak = 0.0;
  for (std::size_t n = 0; n < end; ++n) {
    peak = std::max(peak, mean_force_N(r, n));
  }
  bool free = false;
  std::size_t furthest = end - 1;
  for (std::size_t n = end; n < r.time_s.size(); ++n) {
    free = free || mean_force_N(r, n) < kFree * peak;
    if (free && mean_force_N(r, n) > kLoaded * peak) {
      return furthest;
    }
    furthest = std::abs(r.strain[n]) < std::abs(r.strain[furthest]) ? n : furthest;
  }
  return r.time_s.size() - 1;
}

/// Whether what loads the specimen is over before the record is.
Check record_end(const QualityInputs& in, const Reduction& r, double missing_s,
                 std::size_t loaded) {
  const std::size_t samples = r.time_s.size();
  double peak = 0.0;
  for (std::size_t n = 0; n < samples; ++n) peak = std::max(peak, mean_force_N(r, n));
  Check check{.name = "record_end", .limit = kUnloaded, .unit = "1", .text = {}};
  const double ends_us = 1e6 * r.time_s.back();
  if (missing_s <= 0.0) {
    check.text = formatted("the record holds all of the %.0f us that are reduced", ends_us);
    return check;
  }
  check.value = peak > 0.0 ? mean_force_N(r, samples - 1) / peak : 1.0;
  const bool still_loading = loaded + samples / kLastPart >= samples;
  check.verdict = check.value <= kUnloaded ? (in.may_shorten ? Verdict::pass : Verdict::warn)
                  : still_loading          ? Verdict::fail
                                           : Verdict::warn;
  check.text = formatted(
      "the record ends at %.0f us, %.0f us too soon, with %.0f %% of the peak "
      "force on the specimen",
      ends_us, 1e6 * missing_s, 100 * check.value);
  if (check.verdict == Verdict::fail) {
    check.text += " and its strain still growing: neither peak is known; record for longer";
  }
  return check;
}

Check loop_closure(const Reduction& r, std::size_t end) {
  const std::size_t rest = at_rest(r, end);
  const double largest = std::abs(r.strain[end - 1]);
  Check check{.name = "loop_closure", .limit = kClosureLimit, .unit = "1", .text = {}};
  check.value = largest > 0.0 ? std::abs(r.strain[rest]) / largest : 0.0;
  check.verdict = check.value <= kClosureLimit ? Verdict::pass : Verdict::warn;
  const std::string left = formatted("%.1f %% of the largest strain is left at %.0f us",
                                     100 * check.value, 1e6 * r.time_s[rest]) +
                           (rest + 1 < r.time_s.size() ? ", before it is loaded again" : "");
  check.text = check.verdict == Verdict::pass
                   ? "the loop closes: " + left
                   : "the loop is open: " + left +
                         " (permanent strain, slow recovery, or the bench is not as filed)";
  return check;
}

double largest_of(std::span<const double> history) {
  double largest = 0.0;
  for (const double value : history) {
    largest = std::max(largest, std::abs(value));
  }
  return largest;
}

/// First time at which a history passes a level that it reaches.
double rise_s(std::span<const double> time_s, std::span<const double> history, double level) {
  for (std::size_t n = 1; n < history.size(); ++n) {
    const double before = std::abs(history[n - 1]);
    const double now = std::abs(history[n]);
    if (now >= level) {
      const double share = now > before ? (level - before) / (now - before) : 1.0;
      return time_s[n - 1] + std::clamp(share, 0.0, 1.0) * (time_s[n] - time_s[n - 1]);
    }
  }
  return 0.0;
}

/// How much later the back force rises than the front force, and what noise moves that by.
struct Lag {
  double value_s = 0.0;
  double sigma_s = 0.0;
};

/// What noise moves the passage of a level by: the noise there over the rise's slope, as a tenth of
/// what is reached to either side has it.
double passage_sigma_s(std::span<const double> time_s, std::span<const double> history,
                       std::span<const double> noise, double share, double reached) {
  if (noise.empty()) {
    return 0.0;
  }
  constexpr double kBeside = 0.1;
  const double takes_s = rise_s(time_s, history, (share + kBeside) * reached) -
                         rise_s(time_s, history, (share - kBeside) * reached);
  const auto at = std::ranges::lower_bound(time_s, rise_s(time_s, history, share * reached));
  const auto n = std::min(static_cast<std::size_t>(at - time_s.begin()), noise.size() - 1);
  return noise[n] * takes_s / (2.0 * kBeside * reached);
}

/// At levels that both reach, the larger of two. What is filed wrong moves all levels alike. In a
/// soft specimen under a steep pulse the forces grow in steps, in turn at front and back, and at
/// some level the back is first: never at all.
/// @param front_noise_N  one sigma; empty where it is not known
Lag front_back_lag_of(const Reduction& r, std::size_t end, std::span<const double> front_noise_N) {
  const std::span<const double> time_s(r.time_s.data(), end);
  const std::span<const double> front(r.force_front_N.data(), end);
  const std::span<const double> back(r.force_back_N.data(), end);
  const double reached = std::min(largest_of(front), largest_of(back));
  const auto at = [&](double share) {
    return Lag{rise_s(time_s, back, share * reached) - rise_s(time_s, front, share * reached),
               reached > 0.0 ? passage_sigma_s(time_s, front, front_noise_N, share, reached) : 0.0};
  };
  return std::ranges::max(at(0.25), at(0.5), {}, &Lag::value_s);
}

Check front_back_lag(const QualityInputs& in, const Reduction& r, std::size_t end) {
  // The back cannot lead: it hears of the pulse through the specimen. Two samples are timing error,
  // and what separating the waves leaves of noise moves the times at which a slow rise passes.
  constexpr double kStandsOut = 3.0;
  const double step_s = r.time_s[1] - r.time_s[0];
  const Lag lag =
      front_back_lag_of(r, end,
                        in.separated ? std::span<const double>(in.separated->front_noise_N)
                                     : std::span<const double>());
  Check check{.name = "front_back_lag", .unit = "s", .text = {}};
  check.value = lag.value_s;
  check.limit = -std::max({2.0 * step_s, 1e-6, kStandsOut * lag.sigma_s});
  check.verdict = check.value >= check.limit ? Verdict::pass : Verdict::warn;
  check.text =
      check.verdict == Verdict::pass && check.value >= 0.0
          ? formatted("the back force rises %.1f us after the front force", 1e6 * check.value)
      : check.verdict == Verdict::pass
          ? formatted(
                "the back force rises %.1f us before the front force, which timing and noise may "
                "make of it (limit %.1f us)",
                -1e6 * check.value, -1e6 * check.limit)
          : formatted(
                "the back force rises %.1f us before the front force (limit %.1f us): positions, "
                "wave speed or channel delays are not as filed",
                -1e6 * check.value, -1e6 * check.limit);
  return check;
}

/// rms(front - back) after the returns begin, over the largest force before: both faces unload
/// together, so what is left then is what the separation of the waves left.
double separation_mismatch(const Reduction& r, std::size_t from) {
  double largest = 0.0;
  for (std::size_t n = 0; n < from; ++n) {
    largest = std::max(largest, std::abs(r.force_back_N[n]));
  }
  double squares = 0.0;
  for (std::size_t n = from; n < r.time_s.size(); ++n) {
    squares += std::pow(r.force_front_N[n] - r.force_back_N[n], 2);
  }
  const auto count = static_cast<double>(r.time_s.size() - from);
  return largest > 0.0 ? std::sqrt(squares / count) / largest : 1.0;
}

void shorten(Reduction& r, std::size_t count) {
  for (auto* history : {&r.time_s, &r.stress_Pa, &r.strain, &r.strain_rate_per_s, &r.force_front_N,
                        &r.force_back_N, &r.incident, &r.reflected, &r.transmitted}) {
    history->resize(count);
  }
}

/// Judges how the returns from the far ends were separated, and cuts the histories before them if
/// badly.
Check separate(const QualityInputs& in, Reduction& r) {
  Check check{.name = "separation", .limit = kSeparationLimit, .unit = "1", .text = {}};
  const auto after = std::lower_bound(r.time_s.begin(), r.time_s.end(), in.returns_from_s);
  const auto from = static_cast<std::size_t>(after - r.time_s.begin());
  constexpr std::size_t kFewest = 8;
  if (from < kFewest || from + kFewest > r.time_s.size()) {
    check.text = "the histories end before anything is back from the bars' far ends";
    return check;
  }
  check.value = separation_mismatch(r, from);
  if (check.value <= kSeparationLimit) {
    check.text = formatted(
        "waves back from the far ends, from %.0f us on, leave %.1f %% between front and back "
        "(limit %.0f %%)",
        1e6 * in.returns_from_s, 100 * check.value, 100 * kSeparationLimit);
    return check;
  }
  check.verdict = Verdict::warn;
  check.text = formatted(
      "waves back from the far ends, from %.0f us on, leave %.0f %% between front and back: "
      "lengths, wave "
      "speed or the far ends are not as filed",
      1e6 * in.returns_from_s, 100 * check.value);
  if (in.may_shorten && !in.separated) {
    shorten(r, from);
    check.text += "; the histories end there";
  }
  return check;
}

/// The work that both faces do on the specimen must be what its stress does over its strain and
/// what its mass takes up in speed; what is left over is an error of the bench.
Check energy_balance(const QualityInputs& in, const Reduction& r, std::size_t end) {
  const double step_s = r.time_s[1] - r.time_s[0];
  double faces_J = 0.0;
  double loop_J = 0.0;
  double speed = 0.0;
  for (std::size_t n = 0; n < end; ++n) {
    const double front = in.specimen_length_m * in.front_rate_per_s[n];
    const double closing = in.specimen_length_m * r.strain_rate_per_s[n];
    const double back = front - closing;
    faces_J += step_s * (r.force_front_N[n] * front - r.force_back_N[n] * back);
    loop_J += step_s * (r.force_front_N[n] + r.force_back_N[n]) / 2.0 * closing;
    speed = (front + back) / 2.0;
  }
  const double motion_J = 0.5 * in.specimen_mass_kg * speed * speed;
  Check check{.name = "energy_balance", .limit = kEnergyLimit, .unit = "1", .text = {}};
  check.value =
      std::abs(loop_J) > 0.0 ? std::abs(faces_J - loop_J - motion_J) / std::abs(loop_J) : 1.0;
  check.verdict = check.value <= kEnergyLimit ? Verdict::pass : Verdict::warn;
  check.text = formatted(
      "over the loading the bars put %.3g J into the specimen, its stress over its strain takes "
      "%.3g J, its motion %.2g J: %.1f %% unaccounted for (limit %.0f %%)",
      faces_J, loop_J, motion_J, 100 * check.value, 100 * kEnergyLimit);
  return check;
}

Check band(const QualityInputs& in, const Reduction& r) {
  Check check{.name = "band", .limit = kBandLossLimit, .unit = "1", .text = {}};
  check.value = in.band_loss;
  check.verdict = check.value <= kBandLossLimit ? Verdict::pass : Verdict::warn;
  // 10 to 90 % of a step through the filter.
  constexpr double kRise = 0.44;
  check.text = formatted(
      "frequencies up to %.1f kHz are used; what is left out held %.2f %% of the incident pulse's "
      "energy, steps rise in %.1f us",
      1e-3 * r.band_limit_Hz, 100 * check.value, 1e6 * kRise / r.band_limit_Hz);
  return check;
}

/// What elementary waves leave out. The exact ones take as long to reduce by.
Check wave_theory(const QualityInputs& in) {
  Check check{.name = "wave_theory",
              .value = in.moved_by_lateral_inertia,
              .limit = kLateralLimit,
              .unit = "1",
              .verdict = Verdict::warn,
              .text = {}};
  check.text = formatted(
      "elementary waves leave out the bars' lateral inertia, which moves %.1f %% of this pulse on "
      "its way from the gauge to the specimen (limit %.0f %%): fronts ring, and peaks are too "
      "high; reduce with --dispersion exact",
      100 * check.value, 100 * kLateralLimit);
  return check;
}

/// What gauges that are long against a front leave out.
Check gauge_length(const QualityInputs& in) {
  Check check{.name = "gauge_length",
              .value = in.lost_in_gauge_length,
              .limit = kGaugeLengthLimit,
              .unit = "1",
              .verdict = Verdict::warn,
              .text = {}};
  check.text = formatted(
      "a gauge of %.3g mm reads the mean over its length, which takes %.1f %% (rms) off how fast "
      "this pulse rises and falls (limit %.0f %%), and a reduction takes readings for those at its "
      "middle: rates at fronts are too low; use shorter gauges or longer rises",
      1e3 * in.gauge_length_m, 100 * check.value, 100 * kGaugeLengthLimit);
  return check;
}

/// An arrival that was given against what the record shows.
Check arrival(double late_s, double way_s) {
  Check check{
      .name = "arrival", .value = late_s, .limit = kArrivalLimit_s, .unit = "s", .text = {}};
  if (std::abs(late_s) <= kArrivalLimit_s) {
    check.text = formatted("given, %.1f us off the foot that the record shows", 1e6 * late_s);
    return check;
  }
  check.verdict = Verdict::warn;
  check.text = formatted(
      "given %.1f us %s than the foot of the first pulse at the gauge: %s; what is printed as the "
      "arrival is at the specimen, %.1f us after that foot",
      1e6 * std::abs(late_s), late_s > 0.0 ? "later" : "earlier",
      late_s > 0.0 ? "what the pulse does before is left out"
                   : "the pulse's end may count as reflected",
      1e6 * way_s);
  return check;
}

Check quiet_start(const Reduction& r) {
  const auto samples = static_cast<double>(r.quiet_samples);
  Check check{.name = "quiet_start",
              .value = samples,
              .limit = kFewQuietSamples,
              .unit = "samples",
              .text = {}};
  if (r.quiet_samples == 0) {
    check.verdict = Verdict::fail;
    check.text = std::string(
                     "the record begins within the pulse, or less than 10 us before it, so that "
                     "baseline, noise and arrival are not known: ") +
                 kRecordFromBefore;
    return check;
  }
  check.verdict = samples >= kFewQuietSamples ? Verdict::pass : Verdict::warn;
  check.text = formatted("baseline and noise are from %.0f samples before the pulse (wanted: %.0f)",
                         samples, kFewQuietSamples);
  return check;
}

}  // namespace

Verdict Quality::verdict() const {
  Verdict worst = reducible ? Verdict::pass : Verdict::fail;
  for (const Check& check : checks) {
    worst = std::max(worst, check.verdict);
  }
  return worst;
}

const Check* Quality::find(const std::string& check) const {
  const auto at = std::find_if(checks.begin(), checks.end(),
                               [&](const Check& candidate) { return candidate.name == check; });
  return at == checks.end() ? nullptr : &*at;
}

Reduction not_reducible(std::string reason, std::string mend) {
  Reduction reduction;
  reduction.quality.reason = std::move(reason);
  reduction.quality.mend = std::move(mend);
  return reduction;
}

std::string longer_window(double gauge_to_specimen_m, double wave_speed_m_per_s) {
  return formatted(
             "a pulse that is over within %.0f us, a gauge further from the specimen than %.3g m "
             "(half of the wave speed times the pulse's length, %.2g mm for each us of it), ",
             2e6 * gauge_to_specimen_m / wave_speed_m_per_s, gauge_to_specimen_m,
             0.5e-3 * wave_speed_m_per_s) +
         "or waves told apart by a second place on the input bar (--separate gauges) or the output "
         "bar's force (--separate equilibrium)";
}

FlatTop longest_flat_top(const Shot& shot) {
  using Code = std::numeric_limits<std::int32_t>;
  FlatTop longest;
  const std::size_t gauges = std::min(shot.channels.size(), shot.bench.gauges.size());
  for (std::size_t i = 0; i < gauges; ++i) {
    const ChannelRecord& channel = shot.channels[i];
    if (channel.code_min != Code::min() || channel.code_max != Code::max()) continue;
    longest.ends_filed = false;
    // In codes: a unit is no matter.
    const std::vector<double> record(channel.codes.begin(), channel.codes.end());
    if (const auto top = cut_off(record); top && top->count > longest.samples) {
      longest.gauge = channel.gauge;
      longest.samples = top->count;
    }
  }
  return longest;
}

Check clipping(const FlatTop& flat_top) {
  Check check{.name = "clipping", .limit = 0.0, .unit = "samples", .text = {}};
  if (flat_top.samples > 0) {
    check.value = static_cast<double>(flat_top.samples);
    check.verdict = Verdict::warn;
    check.text = flat_top.gauge + " stays at its record's extreme for " +
                 std::to_string(flat_top.samples) +
                 " samples: clipped before it was imported? A table does not say where its "
                 "converter ends";
    return check;
  }
  check.text = flat_top.ends_filed ? "no code at the converter's ends"
                                   : "no flat top; a table does not say where its converter ends";
  return check;
}

std::string unusable_because(const Shot& shot) {
  if (!shot.gaps.empty()) {
    const Gap& gap = shot.gaps.front();
    return (gap.known ? std::to_string(gap.samples) + " samples are missing"
                      : std::string("an unknown number of samples is missing")) +
           " in the window at sample " + std::to_string(gap.first_tick - shot.first_tick);
  }
  // A photo-sensor may well stand at an end of its converter.
  const std::size_t gauges = std::min(shot.channels.size(), shot.bench.gauges.size());
  for (std::size_t i = 0; i < gauges; ++i) {
    const ChannelRecord& channel = shot.channels[i];
    const auto clipped = clipped_samples(channel);
    if (!clipped.empty()) {
      return std::to_string(clipped.size()) + " codes of " + channel.gauge +
             " are at the converter's ends, the first at sample " + std::to_string(clipped.front());
    }
  }
  return {};
}

void judge(const QualityInputs& inputs, Reduction& reduction) {
  const std::size_t held = reduction.time_s.size();
  const Check separation = separate(inputs, reduction);
  const bool cut = reduction.time_s.size() < held;
  const std::size_t end = loading_end(reduction);
  const bool assumed = inputs.separated && inputs.separated->assumes_equilibrium;
  const Check agree = equilibrium(reduction, end);
  const Check lag = front_back_lag(inputs, reduction, end);
  const Check energy = energy_balance(inputs, reduction, end);
  const Check start = quiet_start(reduction);
  reduction.quality.checks = {assumed ? untested(agree, Verdict::warn) : agree,
                              signal_to_noise(inputs),
                              inputs.separated ? separated_overlap(inputs) : window_overlap(inputs),
                              clipping(inputs.flat_top),
                              loop_closure(reduction, end),
                              record_end(inputs, reduction, cut ? 0.0 : inputs.missing_s, end),
                              assumed ? untested(lag, Verdict::pass) : lag,
                              assumed ? untested(separation, Verdict::pass) : separation,
                              assumed ? untested(energy, Verdict::pass) : energy,
                              band(inputs, reduction),
                              start};
  if (start.verdict == Verdict::fail) {  // what else fails may follow from that
    auto& checks = reduction.quality.checks;
    std::rotate(checks.begin(), checks.end() - 1, checks.end());
  }
  if (inputs.moved_by_lateral_inertia > kLateralLimit) {
    reduction.quality.checks.push_back(wave_theory(inputs));
  }
  if (inputs.lost_in_gauge_length > kGaugeLengthLimit) {
    reduction.quality.checks.push_back(gauge_length(inputs));
  }
  if (inputs.arrival_late_s) {
    reduction.quality.checks.push_back(arrival(*inputs.arrival_late_s, inputs.way_to_specimen_s));
  }
  if (inputs.separated) {
    reduction.quality.checks.push_back(separated_noise(*inputs.separated));
  }
}

}  // namespace kolsky
