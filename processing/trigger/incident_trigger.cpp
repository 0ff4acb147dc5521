#include "processing/trigger/incident_trigger.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "processing/trigger/crossing.hpp"

namespace kolsky {
namespace {

constexpr auto kCell = static_cast<Tick>(BaselineTracker::kCell);
// A cell tells of baseline and noise when three quarters of it are quiet.
constexpr std::int64_t kQuietEnough = 3 * kCell / 4;
// Without a quiet cell for so long the baseline is lost: noise has grown many times, or a step.
constexpr std::size_t kMostNoisyCells = 16;
// An excursion that has not come back after so many rise times is the new baseline.
constexpr Tick kMostRises = 4;
// A code is at best a rounded number: variance 1/12.
constexpr double kRoundingVariance = 1.0 / 12.0;
constexpr std::size_t kLeastQuiet = 64;
constexpr double kPivotReach = 256.0;
// Samples of a restless cell that are judged together before each is looked at.
constexpr Tick kPiece = 32;

// Quiet samples from which the noise of the time is estimated.
std::size_t quiet_samples(const TriggerOptions& options) {
  return std::max<std::size_t>(1024, 4 * options.maximum_rise_samples);
}

// From the last low mean to the end of the fit a pulse takes two rises and two widths at most; the
// fit may reach a rise before it.
std::size_t pulse_samples(const TriggerOptions& options) {
  return 4 * (options.maximum_rise_samples + options.minimum_width_samples) + 16;
}

std::size_t history_samples(const TriggerOptions& options) {
  return std::max(options.learn_samples, quiet_samples(options) + pulse_samples(options));
}

// Towards zero, and less than the ends of the range.
std::int32_t whole(double codes) {
  constexpr double kMost = std::numeric_limits<std::int32_t>::max() - 1;
  return static_cast<std::int32_t>(std::min(std::max(codes, -kMost), kMost));
}

bool near(const Extremes& codes, std::int32_t pivot) {
  return codes.minimum >= std::int64_t{pivot} - kNear &&
         codes.maximum <= std::int64_t{pivot} + kNear;
}

Tick ticks(std::size_t samples) {
  return static_cast<Tick>(samples);
}

}  // namespace

/// The codes of this call and, before them, the history.
template <class Code>
struct IncidentTrigger::Run {
  const CodeHistory& history;
  Tick first;
  Tick end;
  std::span<const Code> codes;
  Extremes all;

  [[nodiscard]] std::int32_t at(Tick tick) const {
    return tick >= first ? codes[static_cast<std::size_t>(tick - first)] : history.at(tick);
  }
  [[nodiscard]] std::span<const Code> part(Tick from, Tick to) const {
    return codes.subspan(static_cast<std::size_t>(from - first),
                         static_cast<std::size_t>(to - from));
  }
};

IncidentTrigger::IncidentTrigger(const TriggerOptions& options)
    : options_((check(options), options)),
      tracker_({options.baseline_memory_samples, options.noise_memory_samples,
                options.maximum_rise_samples}),
      history_(history_samples(options)),
      scratch_(history_samples(options)) {}

void IncidentTrigger::reset_run() {
  if (phase_ == Phase::settling) {
    // The pulse was certain; its time has to do with the samples there are.
    pulse_.fit_tick = next_tick_ - 1;
    finish_pulse(Run<std::int16_t>{history_, next_tick_, next_tick_, {}, {}});
  }
  if (phase_ != Phase::holding) phase_ = Phase::learning;
  started_ = false;
}

void IncidentTrigger::reset() {
  started_ = false;
  phase_ = Phase::learning;
  tracker_.forget();
  baseline_codes_ = 0.0;
  waiting_count_ = 0;
}

double IncidentTrigger::noise_codes() const {
  return std::max(options_.minimum_noise_codes, std::sqrt(tracker_.noise_variance()));
}

std::optional<TriggerEvent> IncidentTrigger::feed(Tick first_tick,
                                                  std::span<const std::int16_t> codes,
                                                  const RunStatistics& statistics) {
  return take(first_tick, codes, statistics);
}

std::optional<TriggerEvent> IncidentTrigger::feed(Tick first_tick,
                                                  std::span<const std::int32_t> codes,
                                                  const RunStatistics& statistics) {
  return take(first_tick, codes, statistics);
}

template <class Code>
std::optional<TriggerEvent> IncidentTrigger::take(Tick first_tick, std::span<const Code> codes,
                                                  const RunStatistics& statistics) {
  if (!started_ || first_tick != next_tick_) start_run(first_tick);
  const auto size = static_cast<std::int64_t>(codes.size());
  const RunStatistics known = statistics.count == size ? statistics : run_statistics(codes);
  const Run<Code> run{
      history_, first_tick, first_tick + size, codes, {known.minimum, known.maximum}};
  Tick tick = run.first;
  while (tick < run.end) {
    switch (phase_) {
      case Phase::learning:
        tick = learn(run, tick);
        break;
      case Phase::watching:
        tick = watch(run, tick);
        break;
      case Phase::settling:
        tick = settle(run, tick);
        break;
      case Phase::holding:
        tick = std::min(run.end, hold_until_);
        if (tick == hold_until_) start_learning(tick);
        break;
    }
  }
  history_.append(first_tick, codes);
  next_tick_ = run.end;
  return next_waiting();
}

void IncidentTrigger::start_run(Tick tick) {
  reset_run();
  started_ = true;
  run_start_ = tick;
  const bool still_held = tick >= pulse_.found_tick && tick < hold_until_;
  if (phase_ != Phase::holding || !still_held) start_learning(tick);
}

void IncidentTrigger::start_learning(Tick tick) {
  phase_ = Phase::learning;
  phase_start_ = tick;
}

template <class Code>
Tick IncidentTrigger::learn(const Run<Code>& run, Tick from) {
  const Tick until = phase_start_ + ticks(options_.learn_samples);
  if (run.end < until) return run.end;
  const std::span<double> samples(scratch_.data(), options_.learn_samples);
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = run.at(phase_start_ + ticks(i));
  tracker_.start(estimate_quiet(samples), samples.size());
  phase_ = Phase::watching;
  noisy_cells_ = 0;
  excursion_ = {};
  excursion_.low_tick = until - 1;
  cell_ = {};
  level_variance_ = -1.0;
  start_cell(until);
  return std::max(from, until);
}

void IncidentTrigger::start_cell(Tick tick) {
  cell_.first_tick = tick;
  cell_.line = tracker_.next_cell();
  if (tracker_.noise_variance() != level_variance_) {
    level_variance_ = tracker_.noise_variance();
    cell_.level = level_codes();
    cell_.band = options_.hysteresis_share * cell_.level;
  }
  cell_.quiet = {};
  constexpr double kHalf = 0.5 * static_cast<double>(kCell - 1);
  baseline_codes_ = line_at(cell_, kHalf);
  // Conservative by more than the rounding: taken by itself each of these is within the band.
  constexpr double kRounding = 1e-6;
  const double reach = cell_.band - kHalf * std::abs(cell_.line.slope_codes) - kRounding;
  cell_.lowest_quiet = whole(baseline_codes_ - reach) + 1;
  cell_.highest_quiet = whole(baseline_codes_ + reach) - 1;
  // The pivot need only be near: left alone, it lets the next sums begin before this line is done.
  if (std::abs(baseline_codes_ - cell_.pivot) > kPivotReach) cell_.pivot = whole(baseline_codes_);
}

void IncidentTrigger::finish_cell() {
  const DeviationSums& quiet = cell_.quiet;
  if (quiet.count >= kQuietEnough) {
    const double share =
        quiet.count == kCell ? 1.0 / kCell : 1.0 / static_cast<double>(quiet.count);
    const double mean = static_cast<double>(quiet.sum) * share;
    tracker_.take(cell_.pivot + mean,
                  static_cast<double>(quiet.sum_of_squares) * share - mean * mean);
    noisy_cells_ = 0;
  } else {
    tracker_.skip();
    ++noisy_cells_;
  }
  const Tick next = cell_.first_tick + kCell;
  if (noisy_cells_ > kMostNoisyCells) {
    start_learning(next);
  } else {
    start_cell(next);
  }
}

double IncidentTrigger::line_at(const Cell& cell, double samples_after_first) const {
  return cell.line.value_codes + cell.line.slope_codes * samples_after_first;
}

bool IncidentTrigger::within_band(const Extremes& codes) const {
  return codes.minimum >= cell_.lowest_quiet && codes.maximum <= cell_.highest_quiet;
}

void IncidentTrigger::add_quiet(std::int64_t count, std::int64_t sum, std::int64_t sum_of_squares) {
  cell_.quiet.count += count;
  cell_.quiet.sum += sum;
  cell_.quiet.sum_of_squares += sum_of_squares;
}

// Over samples that are all within the band, if they are.
template <class Code>
bool IncidentTrigger::pass_over(const Run<Code>& run, Tick from, Tick end) {
  if (excursion_.tainted > 0) return false;
  const auto part = run.part(from, end);
  if (!within_band(run.all) && !within_band(extremes(part))) return false;
  if (near(run.all, cell_.pivot)) {
    const NearSums sums = near_sums(part, cell_.pivot);
    pass(end, end - from, sums.sum, sums.sum_of_squares);
  } else {
    const DeviationSums sums = deviation_sums(part, cell_.pivot);
    pass(end, sums.count, sums.sum, sums.sum_of_squares);
  }
  return true;
}

void IncidentTrigger::pass(Tick end, std::int64_t count, std::int64_t sum,
                           std::int64_t sum_of_squares) {
  add_quiet(count, sum, sum_of_squares);
  excursion_.outside = 0;
  excursion_.low_tick = end - 1;
}

// Whole quiet cells, as many as follow each other. Their sums do not wait for one another, the
// lines they are judged by do: so sums are taken for several cells before the first is judged.
template <class Code>
Tick IncidentTrigger::pass_over_cells(const Run<Code>& run, Tick from) {
  constexpr Tick kAhead = 8;
  std::array<NearSums, kAhead> sums;
  while (from == cell_.first_tick && excursion_.tainted == 0 && run.end - from >= 2 * kCell &&
         near(run.all, cell_.pivot)) {
    const Tick cells = std::min(kAhead, (run.end - from) / kCell);
    const Extremes all =
        within_band(run.all) ? run.all : extremes(run.part(from, from + cells * kCell));
    if (!within_band(all)) return from;
    const std::int32_t pivot = cell_.pivot;
    for (Tick i = 0; i < cells; ++i) {
      sums[static_cast<std::size_t>(i)] =
          near_sums(run.part(from + i * kCell, from + (i + 1) * kCell), pivot);
    }
    for (Tick i = 0; i < cells && cell_.pivot == pivot && within_band(all); ++i) {
      const NearSums& cell = sums[static_cast<std::size_t>(i)];
      from += kCell;
      pass(from, kCell, cell.sum, cell.sum_of_squares);
      finish_cell();
    }
  }
  return from;
}

template <class Code>
Tick IncidentTrigger::watch(const Run<Code>& run, Tick from) {
  from = pass_over_cells(run, from);
  if (from == run.end) return from;
  const Tick cell_end = cell_.first_tick + kCell;
  const Tick end = std::min(run.end, cell_end);
  if (!pass_over(run, from, end)) {
    while (from < end && phase_ == Phase::watching) {
      const Tick piece_end = std::min(end, from + kPiece);
      from = pass_over(run, from, piece_end) ? piece_end : look_closely(run, from, piece_end);
    }
  } else {
    from = end;
  }
  if (phase_ == Phase::watching && from == cell_end) finish_cell();
  return from;
}

double IncidentTrigger::mean_deviation(Tick tick) const {
  const auto width = static_cast<double>(options_.minimum_width_samples);
  const double middle = static_cast<double>(tick - cell_.first_tick) - 0.5 * (width - 1.0);
  return static_cast<double>(excursion_.window_sum) / width - line_at(cell_, middle);
}

template <class Code>
Tick IncidentTrigger::look_closely(const Run<Code>& run, Tick from, Tick end) {
  const std::size_t width = options_.minimum_width_samples;
  const Tick rise = ticks(options_.maximum_rise_samples);
  Excursion& now = excursion_;
  if (now.tainted == 0) {
    now.window_sum = 0;
    for (Tick tick = from - ticks(width); tick < from; ++tick) now.window_sum += run.at(tick);
  }
  for (Tick tick = from; tick < end; ++tick) {
    const std::int32_t code = run.at(tick);
    now.window_sum += std::int64_t{code} - run.at(tick - ticks(width));
    const double deviation = code - line_at(cell_, static_cast<double>(tick - cell_.first_tick));
    const int side = deviation >= cell_.band ? 1 : (deviation <= -cell_.band ? -1 : 0);
    if (side == 0) {
      now.outside = 0;
      now.tainted -= now.tainted > 0 ? 1 : 0;
      const std::int64_t off = held_deviation(code, cell_.pivot);
      add_quiet(1, off, off * off);
    } else {
      now.outside = side == now.side ? now.outside + 1 : 1;
      now.side = side;
      now.tainted = width;
    }
    const double mean = now.tainted > 0 ? mean_deviation(tick) : 0.0;
    if (std::abs(mean) < cell_.band) now.low_tick = tick;
    const Tick risen = tick - now.low_tick;
    if (now.outside >= width && std::abs(mean) >= cell_.level && risen <= rise) {
      pulse_ = {tick, now.low_tick, tick + std::max<Tick>(risen, 4), side, cell_};
      phase_ = Phase::settling;
      return tick + 1;
    }
    if (risen > kMostRises * rise) {
      start_learning(tick + 1);
      return tick + 1;
    }
  }
  return end;
}

template <class Code>
Tick IncidentTrigger::settle(const Run<Code>& run, Tick from) {
  if (run.end <= pulse_.fit_tick) return run.end;
  finish_pulse(run);
  return std::max(from, pulse_.fit_tick + 1);
}

template <class Code>
void IncidentTrigger::finish_pulse(const Run<Code>& run) {
  keep(fit(run));
  phase_ = Phase::holding;
  hold_until_ =
      std::max(pulse_.fit_tick + 1, pulse_.found_tick + 1 + ticks(options_.hold_off_samples));
}

template <class Code>
std::span<double> IncidentTrigger::deviations(const Run<Code>& run, Tick first, Tick end) {
  const std::span<double> into(scratch_.data(), static_cast<std::size_t>(end - first));
  for (std::size_t i = 0; i < into.size(); ++i) {
    const Tick tick = first + ticks(i);
    into[i] =
        pulse_.side *
        (run.at(tick) - line_at(pulse_.cell, static_cast<double>(tick - pulse_.cell.first_tick)));
  }
  return into;
}

template <class Code>
TriggerEvent IncidentTrigger::fit(const Run<Code>& run) {
  const Tick width = ticks(options_.minimum_width_samples);
  const Tick risen = pulse_.found_tick - pulse_.low_tick;
  const Tick first = std::max(run_start_, pulse_.low_tick - risen - width - 8);
  const std::span<const double> edge = deviations(run, first, pulse_.fit_tick + 1);
  auto guess = static_cast<std::size_t>(pulse_.found_tick - first);
  while (guess > 0 && edge[guess] >= pulse_.cell.level) --guess;
  std::optional<Crossing> crossing =
      fit_crossing(edge, guess, pulse_.cell.level, static_cast<std::size_t>(risen));
  if (!crossing) {
    crossing = Crossing{static_cast<double>(guess), pulse_.cell.level / static_cast<double>(risen),
                        1.0, 0.0, 1};
  }

  const Tick quiet_end = pulse_.low_tick - std::max(width, risen);
  const Tick quiet_first = std::max(run_start_, quiet_end - ticks(quiet_samples(options_)));
  double noise_variance = tracker_.noise_variance();
  if (quiet_end - quiet_first >= ticks(kLeastQuiet)) {
    const auto block = static_cast<std::size_t>(std::lround(1.0 / crossing->noise_share));
    noise_variance =
        block_noise_variance(deviations(run, quiet_first, quiet_end), block, pulse_.cell.band);
  }
  const double level_variance =
      0.25 * pulse_.cell.level * pulse_.cell.level * tracker_.noise_relative_variance();
  const double value_variance =
      std::max(noise_variance, kRoundingVariance) * crossing->noise_share +
      tracker_.baseline_variance() + level_variance;
  const double sigma = std::sqrt(value_variance / (crossing->slope * crossing->slope) +
                                 crossing->unresolved_variance);
  const double whole = std::floor(crossing->position);
  return TriggerEvent{first + static_cast<Tick>(whole), crossing->position - whole, sigma,
                      TriggerKind::incident};
}

void IncidentTrigger::keep(const TriggerEvent& event) {
  if (waiting_count_ < waiting_.size()) waiting_[waiting_count_++] = event;
}

std::optional<TriggerEvent> IncidentTrigger::next_waiting() {
  if (waiting_count_ == 0) return std::nullopt;
  const TriggerEvent event = waiting_.front();
  std::copy(waiting_.begin() + 1, waiting_.begin() + static_cast<std::ptrdiff_t>(waiting_count_),
            waiting_.begin());
  --waiting_count_;
  return event;
}

}  // namespace kolsky
