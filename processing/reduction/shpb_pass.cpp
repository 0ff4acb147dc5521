#include "processing/reduction/shpb_pass.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "processing/base/error.hpp"
#include "processing/base/range.hpp"
#include "processing/reduction/corrections.hpp"
#include "processing/reduction/formatted.hpp"
#include "processing/reduction/loop_summary.hpp"
#include "processing/reduction/plausibility.hpp"
#include "processing/reduction/pulse.hpp"
#include "processing/reduction/quality.hpp"
#include "processing/reduction/quiet_drift.hpp"
#include "processing/reduction/record_faults.hpp"
#include "processing/reduction/requested.hpp"
#include "processing/reduction/separated_faces.hpp"
#include "processing/waves/seen_modes.hpp"

namespace kolsky {

namespace {

/// A run above the level shorter than this is a spike, not a pulse.
constexpr double kShortestPulse_s = 5e-6;
/// Of the band that the noise allows: a limit below that rounds the pulse's foot off.
constexpr double kMostCut = 0.7;
/// Of a history.
constexpr double kFewestSamples = 8.0;
/// Noise's deviations beyond which something is not its account.
constexpr double kStandsOut = 3.0;

double largest(std::span<const double> values) {
  double most = 0.0;
  for (const double value : values) {
    most = std::max(most, std::abs(value));
  }
  return most;
}

/// One reduction in progress: what is found on the way from the records to the histories.
class Pass {
 public:
  Pass(const Shot& shot, const BarStation& in, const BarStation& out,
       const ReductionOptions& options, ShpbPlans& plans, ShpbTables& tables)
      : shot_(shot),
        in_(in),
        out_(out),
        options_(options),
        t_(plans),
        bars_(tables),
        rate_Hz_(shot.rate.Hz()),
        period_s_(shot.rate.period_s()) {}

  Reduction run() {
    Reduction reduction = reduced();
    if (incident_found_ && quiet_ == 0) {
      tell_late_record(reduction.quality);
    }
    return reduction;
  }

 private:
  /// Without a sample before the pulse neither baseline nor arrival is known: every other reason
  /// may follow from that.
  void tell_late_record(Quality& quality) const {
    if (!quality.reducible) {
      quality.reason = "the record begins within the pulse at " + first_gauge() +
                       ", or less than 10 us before it, and " + quality.reason;
      quality.mend = std::string(kRecordFromBefore) + "; else " + quality.mend;
    }
  }

  Reduction reduced() {
    if (!find_incident()) {
      return not_reducible("no incident pulse stands out of the noise on " + first_gauge(),
                           "give a shot's whole record, from before the impact, with that gauge's "
                           "bridge supplied");
    }
    if (split_ >= shot_.samples()) {
      return not_reducible("the record ends before the specimen's answer reaches " + first_gauge(),
                           record_longer());
    }
    transform_records();
    locate_arrival();
    weigh_hidden_push();
    separate();
    if (!faces_ && push_still_rises()) {
      return push_not_seen();
    }
    if (!choose_window()) {
      return nothing_in_window();
    }
    if (faces_) {
      take_separated();
    } else {
      fill_histories();
    }
    fill_strain();
    // The checks go by the sense in which the stress loads.
    set_stress(options_.stress, options_.corrections, *shot_.bench.specimen,
               std::span<const double>(front_rate_per_s_).first(reduction_.time_s.size()),
               reduction_);
    if (options_.corrections.friction && is_pulled(reduction_)) {
      return not_reducible(
          "friction is asked for, of a specimen that is pulled: no face is pressed",
          "leave friction out");
    }
    judge_quality();
    reduction_.assumed_from_s = assumed_from_s();
    return std::move(reduction_);
  }

  /// The push still rises when it is hidden: of a short bar, or after an arrival that is not its
  /// foot.
  [[nodiscard]] Reduction push_not_seen() const {
    if (arrival_late_s_ && std::abs(*arrival_late_s_) > kArrivalLimit_s) {
      return not_reducible(
          formatted("the arrival given is %.1f us %s than the foot of the first pulse at %s",
                    1e6 * std::abs(*arrival_late_s_), *arrival_late_s_ > 0.0 ? "later" : "earlier",
                    first_gauge().c_str()),
          "give the foot at that gauge: the arrival that is printed is at the specimen");
    }
    return not_reducible(
        formatted("the reflection hides the push at %s %.0f us after its foot, while it still "
                  "rises: the bar is too short for this pulse",
                  first_gauge().c_str(), 2e6 * travel_to_specimen_s()),
        "it takes " + longer_window(in_.gauge_to_specimen_m, wave_speed_m_per_s()) +
            "; of a record that begins within the pulse the reflection is taken for it: record for "
            "longer before the trigger");
  }
  [[nodiscard]] Reduction nothing_in_window() const {
    const double asked = options_.duration_s.value_or(HUGE_VAL) * rate_Hz_;
    if (asked < kFewestSamples) {
      return not_reducible(formatted("the duration asked for, %.3g us, is less than %.0f samples",
                                     1e6 * asked * period_s_, kFewestSamples),
                           formatted("ask for %.3g us at least", 1e6 * kFewestSamples * period_s_));
    }
    return not_reducible("the record ends before the pulse has loaded the specimen",
                         record_longer());
  }
  [[nodiscard]] const std::string& first_gauge() const {
    return shot_.channels[in_.channels.front()].gauge;
  }
  /// Of a front, from the gauge that sees the push.
  [[nodiscard]] double travel_to_specimen_s() const {
    return bars_.input.front_time_s(in_.gauge_to_specimen_m);
  }
  [[nodiscard]] double wave_speed_m_per_s() const {
    return in_.gauge_to_specimen_m / travel_to_specimen_s();
  }
  /// By how much until the pulse has come and gone at the specimen, if it is as long as the bar
  /// lets it be.
  [[nodiscard]] std::string record_longer() const {
    const double answered = gauge_foot_ + 4.0 * travel_to_specimen_s() * rate_Hz_;
    const double missing = answered - static_cast<double>(shot_.samples());
    return formatted("record for longer, by some %.0f us",
                     1e6 * period_s_ * std::max(missing, rate_Hz_ * 10e-6));
  }

  bool find_incident() {
    const auto width = static_cast<std::size_t>(std::ceil(kShortestPulse_s * rate_Hz_));
    const double round_trip_s = 2.0 * bars_.input.front_time_s(in_.gauge_to_specimen_m);
    const auto reach = static_cast<std::size_t>(round_trip_s * rate_Hz_);
    read_raw_station(shot_, in_, t_.input_strain);
    std::optional<Rise> rise;
    double foot = 0.0;
    if (options_.arrival_s) {
      foot = *options_.arrival_s * rate_Hz_;
      if (const auto first =
              find_first_pulse(t_.input_strain, std::max<std::size_t>(width, 3), reach)) {
        arrival_late_s_ = (foot - rough_foot(*first, reach)) * period_s_;
      }
      rise = rise_after_foot(t_.input_strain, foot, reach, rate_Hz_);
    } else {
      rise = find_first_pulse(t_.input_strain, std::max<std::size_t>(width, 3), reach);
      if (!rise) {
        return false;
      }
      foot = rough_foot(*rise, reach);
    }
    const auto clearance = kFootClearance_s * rate_Hz_;
    quiet_ = static_cast<std::size_t>(std::max(0.0, foot - clearance));
    incident_found_ = true;
    // Only now is it known how long the gauges are unstrained, which the bridges' equations start
    // from.
    read_station(shot_, in_, quiet_, t_.input_strain);
    read_station(shot_, out_, quiet_, t_.output_strain);
    sense_ = t_.input_strain[rise->index + 1] < 0.0 ? -1.0 : 1.0;
    input_noise_ = quiet_before(t_.input_strain, quiet_).noise_rms;
    output_noise_ = quiet_before(t_.output_strain, quiet_).noise_rms;
    gauge_foot_ = foot;
    split_ = static_cast<std::size_t>(std::max(0.0, foot + round_trip_s * rate_Hz_));
    return true;
  }

  /// Foot at the gauge itself, from the unfiltered record.
  double rough_foot(const Rise& rise, std::size_t reach) {
    const std::size_t half = rise.index;
    const double baseline = quiet_before(t_.input_strain, std::min<std::size_t>(half, 32)).baseline;
    const std::size_t end = std::min(t_.input_strain.size(), half + reach);
    auto& shifted = t_.scratch;
    for (std::size_t n = 0; n < end; ++n) {
      shifted[n] = rise.sense * (t_.input_strain[n] - baseline);
    }
    const double peak = *std::max_element(shifted.begin() + static_cast<std::ptrdiff_t>(half),
                                          shifted.begin() + static_cast<std::ptrdiff_t>(end));
    return foot_of(shifted, half, peak, 0.0).index;
  }

  void transform_records() {
    choose_band(incident_strain().subspan(quiet_));
    t_.transform.forward(t_.input_strain, in_band(t_.rest));
    t_.transform.forward(t_.output_strain, in_band(t_.output_spectrum));
    for (auto* spectrum : {&t_.rest, &t_.output_spectrum}) {
      t_.band.apply(reduction_.band_limit_Hz, in_band(*spectrum));
    }
    complete_incident();
    for (std::size_t k = 0; k < bins_; ++k) {
      t_.rest[k] -= t_.incident[k];
    }
  }

  /// The incident pulse at its gauge, as long as the specimen's answer does not hide it.
  [[nodiscard]] std::span<const double> incident_strain() const {
    return std::span<const double>(t_.input_strain).first(split_);
  }

  void choose_band(std::span<const double> pulse) {
    const double of_noise_Hz = t_.band.from_noise(pulse, input_noise_);
    double limit_Hz = options_.band_limit_Hz.value_or(
        std::min(of_noise_Hz, options_.most_band_Hz.value_or(of_noise_Hz)));
    foot_is_rounded_ = limit_Hz < kMostCut * of_noise_Hz;
    bins_ = BandLimit::bins_within(t_.transform, limit_Hz);
    bars_.reach(t_, bins_);
    const double blind_from_Hz = bars_.blind_from_Hz(t_, bins_);
    if (options_.band_limit_Hz) {
      require_band_seen(limit_Hz, blind_from_Hz);
      require_band_of_pulse(limit_Hz);
    } else {
      limit_Hz = std::min(limit_Hz, highest_band_limit_Hz(blind_from_Hz));
      bins_ = BandLimit::bins_within(t_.transform, limit_Hz);
    }
    reduction_.band_limit_Hz = limit_Hz;
    band_loss_ = t_.band.loss(pulse, input_noise_, limit_Hz);
  }

  /// Below that the filter mixes the pulse with the specimen's answer to it, and what is carried
  /// back with it grows without bounds.
  void require_band_of_pulse(double limit_Hz) const {
    const double alone_s = (static_cast<double>(split_) - gauge_foot_) * period_s_;
    if (BandLimit::smear_s(limit_Hz) > alone_s) {
      throw InputError(
          "band_limit_Hz",
          formatted("%s is too low: a filter with that limit reaches over %.0f us, and %s sees the "
                    "pulse alone for %.0f us",
                    in_words(limit_Hz, "Hz").c_str(), 1e6 * BandLimit::smear_s(limit_Hz),
                    first_gauge().c_str(), 1e6 * alone_s),
          formatted("give at least %.0f Hz",
                    std::ceil(limit_Hz * BandLimit::smear_s(limit_Hz) / alone_s)));
    }
  }

  /// All of a spectrum that the band limit leaves.
  [[nodiscard]] std::span<Complex> in_band(std::vector<Complex>& spectrum) const {
    return std::span(spectrum).first(bins_);
  }

  /// Gives the incident pulse the tail that the specimen's answer hides: at the impacted end it is
  /// the striker's push, which is over before the hidden part would have started there, unless it
  /// is to be taken to go on.
  void complete_incident() {
    const std::span<Complex> incident = in_band(t_.incident);
    t_.transform.forward(incident_strain(), incident);
    t_.band.apply_half(reduction_.band_limit_Hz, incident);
    if (options_.theory == WaveTheory::elementary) {
      moved_by_lateral_inertia_ = moved_by_lateral_inertia(incident);
    }
    bars_.kernels.push_from_incident(incident);
    const double known =
        static_cast<double>(split_) - BandLimit::smear_s(reduction_.band_limit_Hz) * rate_Hz_;
    push_end_ = std::min(static_cast<std::size_t>(std::max(0.0, known)), shot_.samples());
    const std::span<double> push = std::span(t_.history).first(shot_.samples());
    t_.transform.inverse(incident, push.first(push_end_));
    judge_push(push.first(push_end_));
    let_push_go_on(push, options_.push_goes_on * push_left_Pa_);
    incident_from_push(push, incident);
  }

  /// Share of a pulse, rms over rms, that lateral inertia moves on its way to the specimen: by the
  /// phase that Love's bar adds, k = (w/c) sqrt(1 + (nu a w/c)^2 / 2).
  [[nodiscard]] double moved_by_lateral_inertia(std::span<const Complex> pulse) const {
    const Bar& bar = shot_.bench.input;
    const double nu_a_m = bar.poisson_ratio.value * bar.diameter_m.value / 2.0;
    double moved = 0.0;
    double all = 0.0;
    for (std::size_t k = 0; k < pulse.size(); ++k) {
      const double wavenumber_per_m = t_.transform.s(k).imag() / wave_speed_m_per_s();
      const double love = std::sqrt(1.0 + std::pow(nu_a_m * wavenumber_per_m, 2) / 2.0);
      const double turn = wavenumber_per_m * (love - 1.0) * in_.gauge_to_specimen_m;
      const double power = std::norm(pulse[k]);
      moved += power * std::norm(std::polar(1.0, turn) - 1.0);
      all += power;
    }
    return all > 0.0 ? std::sqrt(moved / all) : 0.0;
  }

  /// Behind what is known of it: for as long again as it is known, which is beyond the loading.
  void let_push_go_on(std::span<double> push_Pa, double stress_Pa) const {
    const std::span<double> behind = push_Pa.subspan(push_end_);
    const auto known =
        static_cast<std::size_t>(std::max(0.0, static_cast<double>(push_end_) - gauge_foot_));
    const auto end = behind.begin() + static_cast<std::ptrdiff_t>(std::min(known, behind.size()));
    std::fill(behind.begin(), end, stress_Pa);
    std::fill(end, behind.end(), 0.0);
  }

  void incident_from_push(std::span<const double> push_Pa, std::span<Complex> incident) {
    t_.transform.forward(push_Pa, incident);
    bars_.kernels.incident_from_push(incident);
    t_.band.apply_half(reduction_.band_limit_Hz, incident);
  }

  /// How much of the push is left at the end of what is known of it, averaged over a few samples so
  /// that it is the push that is judged and not the noise.
  void judge_push(std::span<const double> push) {
    const auto few = std::min(push.size(), static_cast<std::size_t>(10e-6 * rate_Hz_) + 1);
    for (const double stress_Pa : push.last(few)) {
      push_left_Pa_ += stress_Pa / static_cast<double>(few);
    }
    push_peak_Pa_ = largest(push);
    push_left_share_ = push_peak_Pa_ > 0.0 ? std::abs(push_left_Pa_) / push_peak_Pa_ : 1.0;
    // Less than that is the noise's account.
    push_noise_share_ = kStandsOut * input_noise_ / std::max(largest(incident_strain()), 1e-300) /
                        std::sqrt(static_cast<double>(std::max<std::size_t>(few, 1)));
    if (push_left_share_ > push_noise_share_) {
      reduction_.push_left_share = push_left_share_;
    }
  }

  /// Whether what the gauge sees of the push alone ends on its rise: on a ramp the last fifth of
  /// the window is 1.3 times the one before and near the peak, on a plateau that creeps no more
  /// than 1.05; what is left of a push that has gone may be anything, but is small.
  [[nodiscard]] bool push_still_rises() const {
    constexpr double kRises = 1.15;
    constexpr double kLeastOfPeak = 0.6;
    const std::span<const double> push =
        incident_strain().subspan(static_cast<std::size_t>(std::max(0.0, gauge_foot_)));
    const std::size_t fifth = push.size() / 5;
    if (fifth == 0) {
      return true;
    }
    const auto mean = [&](std::span<const double> part) {
      return sense_ * std::accumulate(part.begin(), part.end(), 0.0) / static_cast<double>(fifth);
    };
    const double last = mean(push.last(fifth));
    const double before = mean(push.last(2 * fifth).first(fifth));
    const double noise = input_noise_ * std::sqrt(2.0 / static_cast<double>(fifth));
    return last > kLeastOfPeak * largest(push) && last > kRises * before &&
           last - before > kStandsOut * noise;
  }

  /// What a push that went on at its peak would take off the largest strain, as a share of it: all
  /// of it counts as reflected, and what it would have done at the specimen is missing. Need not be
  /// known where nothing of the push stands out.
  void weigh_hidden_push() {
    if (push_left_share_ <= push_noise_share_) {
      return;
    }
    const std::size_t begin = std::min(t_.scratch.size(), first_of_histories() + t_.key.delay);
    const auto many = static_cast<std::size_t>(first_return_s() * rate_Hz_);
    const std::size_t count = std::min(many, t_.scratch.size() - begin);
    const std::span<const double> rate = strain_rate().subspan(begin, count);
    double strain = 0.0;
    double most = 0.0;
    std::size_t end = 0;
    for (std::size_t n = 0; n < count; ++n) {
      strain += sense_ * rate[n];
      if (strain > most) {
        most = strain;
        end = n + 1;
      }
    }
    const std::span<double> push = std::span(t_.scratch).first(shot_.samples());
    std::fill(push.begin(), push.begin() + static_cast<std::ptrdiff_t>(push_end_), 0.0);
    let_push_go_on(push, push_peak_Pa_);
    const std::span<Complex> hidden = in_band(t_.hidden);
    incident_from_push(push, hidden);
    std::transform(hidden.begin(), hidden.end(), t_.hidden_in_rest.begin(),
                   [](Complex value) { return -value; });
    bars_.kernels.rate_of_front({hidden, in_band(t_.hidden_in_rest), {}}, in_band(t_.work));
    const std::span<double> of_hidden = std::span(t_.scratch).first(end);
    t_.transform.inverse(in_band(t_.work), of_hidden, begin);
    const double missing = std::accumulate(of_hidden.begin(), of_hidden.end(), 0.0);
    strain_per_push_ = most > 0.0 ? std::abs(missing) / most : 1.0;
  }

  /// The share of the push that may be left: it takes no more than so much off the largest strain,
  /// or does not stand out of the noise.
  [[nodiscard]] double overlap_limit() const {
    return strain_per_push_
               ? std::max(kOverlapLimit / std::max(1.0, *strain_per_push_), push_noise_share_)
               : push_noise_share_;
  }

  /// t = 0: the foot of the incident pulse after it has been carried to interface A. Where the band
  /// ends below what the noise allows, the filter has rounded that foot: then the one at the gauge,
  /// before any filter, and a front's way from there.
  void locate_arrival() {
    carry(&CarryingKernels::right_going_front, t_.history);
    const double travel = bars_.input.front_time_s(in_.gauge_to_specimen_m) * rate_Hz_;
    Foot foot{.index = gauge_foot_ + travel};
    if (!options_.arrival_s && foot_is_rounded_) {
      foot = first_foot(t_.input_strain, gauge_foot_, static_cast<double>(split_), input_noise_);
      foot.index += travel;
    } else if (!options_.arrival_s) {
      const double late = travel + static_cast<double>(t_.key.delay);
      foot = first_foot(t_.history, gauge_foot_ + late, static_cast<double>(split_) + late,
                        input_noise_ * t_.band.noise_share(reduction_.band_limit_Hz));
      foot.index -= static_cast<double>(t_.key.delay);
    }
    reduction_.arrival_s = foot.index * period_s_;
    reduction_.arrival_sigma_s = foot.sigma * period_s_;
  }

  /// The foot of the pulse whose peak lies between two samples of a record.
  [[nodiscard]] Foot first_foot(std::span<const double> record, double from, double to,
                                double noise_rms) {
    const auto begin = static_cast<std::size_t>(from);
    const std::size_t end = std::min(record.size(), static_cast<std::size_t>(to));
    for (std::size_t n = 0; n < end; ++n) {
      t_.scratch[n] = sense_ * record[n];
    }
    const std::span<const double> pulse(t_.scratch.data(), end);
    const auto peak =
        std::max_element(pulse.begin() + static_cast<std::ptrdiff_t>(begin), pulse.end());
    auto half = static_cast<std::size_t>(peak - pulse.begin());
    while (half > 0 && pulse[half] > *peak / 2.0) {
      --half;
    }
    return foot_of(pulse, half, *peak, noise_rms);
  }

  /// Tells the waves apart by more than time, where that is asked for or needed and possible.
  void separate() {
    Separation how = options_.separation;
    if (how == Separation::as_needed) {
      how = push_left_share_ > overlap_limit() && gauges_at_two_places(shot_.bench, "input")
                ? Separation::gauges
                : Separation::never;
    }
    reduction_.separation = how;
    if (how != Separation::never) {
      faces_ = separated_faces(shot_, bars_, how, quiet_, reduction_.band_limit_Hz);
    }
  }

  /// From the arrival until the first wave is back from a far end, or where waves are separated
  /// until the first loading is over if that is later; as far as the record allows: the waves at
  /// the specimen are known up to a front's travel before the record's end.
  bool choose_window() {
    const double arrival = reduction_.arrival_s * rate_Hz_;
    first_ = first_of_histories();
    const double duration_s =
        options_.duration_s.value_or(std::max(first_return_s(), first_loading_s()));
    // A wave that is under a gauge where the record ends is cut there, a step, and the filter looks
    // ahead: one smear before it is still off by 4 % of that wave, three by half of a per cent.
    const double ahead = 3.0 * BandLimit::smear_s(reduction_.band_limit_Hz) * rate_Hz_;
    const double wanted = arrival + duration_s * rate_Hz_;
    const double last = std::min(wanted, known_samples() - ahead);
    missing_s_ = (wanted - last) * period_s_;
    if (last < arrival + kFewestSamples) {
      return false;
    }
    count_ = static_cast<std::size_t>(last) - first_;
    return true;
  }

  [[nodiscard]] std::size_t first_of_histories() const {
    return static_cast<std::size_t>(std::ceil(reduction_.arrival_s * rate_Hz_));
  }

  /// From the arrival until the first wave is back at the specimen from a far end.
  [[nodiscard]] double first_return_s() const {
    return 2.0 * std::min(bars_.input.front_time_s(shot_.bench.input.length_m),
                          far_end_time_s(shot_.bench.output->length_m));
  }

  /// How far the record tells what happened at the specimen.
  double known_samples() const {
    return static_cast<double>(faces_ ? faces_->known
                                      : shot_.samples() -
                                            longest_travel(shot_, bars_.input, bars_.output));
  }

  /// From the arrival to the end of the first loading, where waves are separated.
  double first_loading_s() const {
    if (!faces_) {
      return 0.0;
    }
    const auto end = static_cast<double>(first_loading_end(*faces_, first_));
    return (end - static_cast<double>(first_)) * period_s_;
  }

  /// Seconds a front needs over a stretch of the output bar that ends at its far end, if anything
  /// comes back from there.
  double far_end_time_s(double distance_m) const {
    return bars_.output.waves.far_end == FarEnd::free ? bars_.output.front_time_s(distance_m)
                                                      : std::numeric_limits<double>::infinity();
  }

  CarryingKernels::Inputs inputs() {
    return {in_band(t_.incident), in_band(t_.rest), in_band(t_.output_spectrum)};
  }

  using Kernel = void (CarryingKernels::*)(const CarryingKernels::Inputs&,
                                           std::span<Complex>) const;

  /// The history behind a kernel, from sample `first` of the late ones on.
  void carry(Kernel kernel, std::span<double> history, std::size_t first = 0) {
    (bars_.kernels.*kernel)(inputs(), in_band(t_.work));
    t_.transform.inverse(in_band(t_.work), history, first);
  }

  /// Of the specimen, late as `t_.history` is.
  std::span<const double> strain_rate() {
    if (!strain_rate_known_) {
      carry(&CarryingKernels::strain_rate, t_.strain_rate);
      strain_rate_known_ = true;
    }
    return t_.strain_rate;
  }

  /// The same, cut to the window.
  std::vector<double> history(Kernel kernel) {
    std::vector<double> cut(count_);
    carry(kernel, cut, first_ + t_.key.delay);
    return cut;
  }

  /// What t_.history holds, within the window.
  std::vector<double> window() const {
    const auto begin = t_.history.begin() + static_cast<std::ptrdiff_t>(first_ + t_.key.delay);
    return {begin, begin + static_cast<std::ptrdiff_t>(count_)};
  }

  /// @pre t_.history still holds the right-going wave at interface A
  void fill_histories() {
    reduction_.incident = window();
    reduction_.force_front_N = history(&CarryingKernels::force_front);
    reduction_.force_back_N = history(&CarryingKernels::force_back);
    reduction_.reflected = history(&CarryingKernels::left_going_front);
    reduction_.transmitted = history(&CarryingKernels::right_going_back);
    front_rate_per_s_ = history(&CarryingKernels::rate_of_front);
    const std::span<const double> rate = strain_rate().subspan(t_.key.delay, shot_.samples());
    const std::span<const double> seen = rate.subspan(first_, count_);
    reduction_.strain_rate_per_s.assign(seen.begin(), seen.end());
    strain_before_ = strain_before_window(rate);
  }

  void take_separated() {
    const auto window_of = [&](const std::vector<double>& whole) {
      const auto begin = whole.begin() + static_cast<std::ptrdiff_t>(first_);
      return std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(count_));
    };
    reduction_.incident = window_of(faces_->incident);
    reduction_.reflected = window_of(faces_->reflected);
    reduction_.transmitted = window_of(faces_->transmitted);
    reduction_.force_front_N = window_of(faces_->force_front_N);
    reduction_.force_back_N = window_of(faces_->force_back_N);
    front_rate_per_s_ = window_of(faces_->rate_of_front_per_s);
    reduction_.strain_rate_per_s = window_of(faces_->strain_rate_per_s);
    strain_before_ = strain_before_window(faces_->strain_rate_per_s);
  }

  void fill_strain() {
    reduction_.time_s.resize(count_);
    reduction_.stress_Pa.resize(count_);
    reduction_.strain.resize(count_);
    double strain = strain_before_;
    for (std::size_t n = 0; n < count_; ++n) {
      reduction_.time_s[n] = static_cast<double>(first_ + n) * period_s_ - reduction_.arrival_s;
      reduction_.strain[n] = strain;
      if (n + 1 < count_) {
        strain += period_s_ *
                  (reduction_.strain_rate_per_s[n] + reduction_.strain_rate_per_s[n + 1]) / 2.0;
      }
    }
  }

  /// The rate integrated over what the low-pass has smeared before the arrival.
  /// @param rate  from the shot's first sample on
  double strain_before_window(std::span<const double> rate) const {
    const double lead = 2.0 * BandLimit::smear_s(reduction_.band_limit_Hz) * rate_Hz_;
    const auto begin = static_cast<std::size_t>(std::max(0.0, static_cast<double>(first_) - lead));
    double strain = 0.0;
    for (std::size_t n = begin; n < first_; ++n) {
      strain += period_s_ * (rate[n] + rate[n + 1]) / 2.0;
    }
    return strain;
  }

  void judge_quality() {
    QualityInputs q;
    q.input_peak = largest(incident_strain());
    q.input_noise_rms = input_noise_;
    const auto travel =
        static_cast<std::size_t>((bars_.input.front_time_s(in_.gauge_to_specimen_m) +
                                  bars_.output.front_time_s(out_.gauge_to_specimen_m)) *
                                 rate_Hz_);
    const std::size_t begin =
        std::min(static_cast<std::size_t>(gauge_foot_) + travel, shot_.samples());
    const std::size_t end = std::min(begin + count_, shot_.samples());
    q.output_peak = largest(std::span<const double>(t_.output_strain).subspan(begin, end - begin));
    q.output_noise_rms = output_noise_;
    q.push_left_share = push_left_share_;
    q.push_limit = overlap_limit();
    q.gauge_to_specimen_m = in_.gauge_to_specimen_m;
    q.wave_speed_m_per_s = wave_speed_m_per_s();
    q.strain_per_push = strain_per_push_.value_or(0.0);
    q.returns_from_s = 2.0 * std::min(bars_.input.front_time_s(in_.gauge_to_far_end_m),
                                      far_end_time_s(out_.gauge_to_far_end_m));
    q.may_shorten = !options_.duration_s;
    q.missing_s = missing_s_;
    q.flat_top = longest_flat_top(shot_);
    reduction_.quiet_samples = faces_ ? faces_->quiet : quiet_;
    const Specimen& specimen = *shot_.bench.specimen;
    q.front_rate_per_s = front_rate_per_s_;
    q.specimen_length_m = specimen.length_m;
    if (specimen.density_kg_m3) {
      q.specimen_mass_kg = *specimen.density_kg_m3 * specimen.area_m2() * specimen.length_m;
    }
    q.band_loss = band_loss_;
    q.moved_by_lateral_inertia = moved_by_lateral_inertia_;
    q.arrival_late_s = arrival_late_s_;
    q.way_to_specimen_s = bars_.input.front_time_s(in_.gauge_to_specimen_m);
    if (faces_) {
      q.separated = separation_judgement();
    }
    reduction_.quality.reducible = true;
    judge(q, reduction_);
    judge_sizes(q.input_peak);
    if (auto drift = quiet_drift(shot_, reduction_.quiet_samples, end)) {
      reduction_.quality.checks.push_back(*std::move(drift));
    }
  }

  /// What cannot be, whatever the specimen is.
  void judge_sizes(double incident_peak) {
    auto& checks = reduction_.quality.checks;
    const auto add = [&](std::optional<Check> check) {
      if (check) {
        checks.push_back(*std::move(check));
      }
    };
    // One check of a name: the bar that is further off.
    auto input = impossible_bar_strain(shot_, in_, t_.input_strain);
    auto output = impossible_bar_strain(shot_, out_, t_.output_strain);
    add(input && !(output && output->value > input->value) ? std::move(input) : std::move(output));
    add(impossible_specimen_strain(reduction_));
    add(striker_speed(shot_, in_, incident_peak, wave_speed_m_per_s()));
  }

  SeparationJudgement separation_judgement() const {
    SeparationJudgement judgement;
    const std::size_t last = first_ + count_ - 1;
    const double peak = largest(reduction_.force_front_N);
    judgement.gauges = faces_->gauges;
    judgement.noise_share = peak > 0.0 ? faces_->front_noise_N[last] / peak : 1.0;
    judgement.blind_Hz = faces_->blind_Hz;
    const auto begin = faces_->front_noise_N.begin() + static_cast<std::ptrdiff_t>(first_);
    judgement.front_noise_N.assign(begin, begin + static_cast<std::ptrdiff_t>(count_));
    judgement.assumes_equilibrium = reduction_.separation == Separation::equilibrium;
    judgement.ends_in_loading = first_loading_end(*faces_, first_) >= faces_->known;
    return judgement;
  }

  /// From when a specimen that was taken to be in equilibrium may be: its own waves have crossed it
  /// a few times by then, as fast as the modulus has them that its peak stress has over its strain.
  [[nodiscard]] double assumed_from_s() const {
    constexpr double kCrossings = 4.0;
    constexpr double kUnknown = std::numeric_limits<double>::infinity();
    if (reduction_.separation != Separation::equilibrium) {
      return 0.0;
    }
    const Specimen& specimen = *shot_.bench.specimen;
    const auto end =
        reduction_.stress_Pa.begin() + static_cast<std::ptrdiff_t>(loading_end(reduction_));
    const auto peak = std::max_element(reduction_.stress_Pa.begin(), end, [](double a, double b) {
      return std::abs(a) < std::abs(b);
    });
    const double modulus_Pa =
        *peak / reduction_.strain[static_cast<std::size_t>(peak - reduction_.stress_Pa.begin())];
    if (!specimen.density_kg_m3 || !(modulus_Pa > 0.0)) {
      return kUnknown;
    }
    return kCrossings * specimen.length_m / std::sqrt(modulus_Pa / *specimen.density_kg_m3);
  }

  const Shot& shot_;
  const BarStation& in_;
  const BarStation& out_;
  const ReductionOptions& options_;
  ShpbPlans& t_;
  ShpbTables& bars_;
  std::size_t bins_ = 0;  ///< within the band
  double rate_Hz_;
  double period_s_;
  double sense_ = 1.0;
  double gauge_foot_ = 0.0;
  bool foot_is_rounded_ = false;          ///< by a band that ends below what the noise allows
  std::optional<double> arrival_late_s_;  ///< of one that was given, than the foot that is found
  std::size_t push_end_ = 0;              ///< of what is known of the push, in samples of its own
  double push_left_Pa_ = 0.0;
  double push_peak_Pa_ = 0.0;
  double push_left_share_ = 0.0;
  double push_noise_share_ = 0.0;  ///< what that must exceed to stand out of the noise
  std::optional<double> strain_per_push_;
  bool strain_rate_known_ = false;
  double band_loss_ = 0.0;
  double moved_by_lateral_inertia_ = 0.0;
  double strain_before_ = 0.0;
  double missing_s_ = 0.0;
  std::vector<double> front_rate_per_s_;
  std::optional<SeparatedFaces> faces_;
  double input_noise_ = 0.0;
  double output_noise_ = 0.0;
  std::size_t quiet_ = 0;
  bool incident_found_ = false;
  std::size_t split_ = 0;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  Reduction reduction_;
};

}  // namespace

Reduction shpb_pass(const Shot& shot, const BarStation& in, const BarStation& out,
                    const ReductionOptions& options, ShpbPlans& plans, ShpbTables& tables) {
  return Pass(shot, in, out, options, plans, tables).run();
}

}  // namespace kolsky
