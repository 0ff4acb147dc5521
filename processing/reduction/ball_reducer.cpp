#include "processing/reduction/ball_reducer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "processing/base/error.hpp"
#include "processing/bridge/bridge.hpp"
#include "processing/reduction/ball_deviations.hpp"
#include "processing/reduction/ball_flight.hpp"
#include "processing/reduction/ball_kernels.hpp"
#include "processing/reduction/ball_quality.hpp"
#include "processing/reduction/ball_speeds.hpp"
#include "processing/reduction/ball_stations.hpp"
#include "processing/reduction/contact_numbers.hpp"
#include "processing/reduction/pulse.hpp"
#include "processing/reduction/quality.hpp"
#include "processing/reduction/stations.hpp"
#include "processing/waves/band_limit.hpp"

namespace kolsky {

namespace {

/// A run above the level shorter than this is a spike.
constexpr double kShortestPulse_s = 5e-6;
/// The baseline is taken from so much before the wave: mains hum turns by a twentieth meanwhile.
constexpr double kBaseline_s = 1e-3;
/// Beyond it gauges show how the bar rings, not what the ball does (docs/impact.md).
constexpr double kHighestLowPass_Hz = 50e3;
constexpr double kLeastThreshold = 0.01;
constexpr double kThresholdOverNoise = 4.0;
constexpr double kAfterContact_s = 50e-6;
constexpr std::size_t kFewestDraws = 20;

void require_bench(const Shot& shot) {
  if (!shot.bench.input.youngs_modulus_Pa) {
    throw InputError("bars.input.youngs_modulus_Pa",
                     "is missing: the ball's force is taken from an elastic bar",
                     "give the bar's modulus");
  }
  const std::size_t channels = shot.bench.channels().size();
  if (shot.channels.size() != channels) {
    throw InputError("gauges",
                     std::to_string(channels) + " channels are filed but the shot has " +
                         std::to_string(shot.channels.size()),
                     "file one gauge per channel, then the photo-sensors, in their order");
  }
}

double rms(std::span<const double> values) {
  double squares = 0.0;
  for (const double value : values) {
    squares += value * value;
  }
  return values.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(values.size()));
}

/// One reduction in progress. Force histories count from the record's first sample at the face.
class Pass {
 public:
  Pass(const Shot& shot, const std::vector<Station>& stations, const ReductionOptions& options,
       BallPlans& plans, BallKernels& kernels)
      : shot_(shot),
        bar_(shot.bench.input),
        stations_(stations),
        options_(options),
        t_(plans),
        kernels_(kernels),
        rate_Hz_(shot.rate.Hz()),
        period_s_(shot.rate.period_s()),
        front_speed_m_per_s_(front_speed(bar_)) {}

  static double front_speed(const Bar& bar) {
    return std::sqrt(*bar.youngs_modulus_Pa / bar.density_kg_m3);
  }

  Reduction run() {
    if (!find_wave()) {
      return not_reducible("no wave stands out of the noise on " +
                           names_of(stations_[0], shot_.bench));
    }
    if (!read_strains()) {
      return not_reducible("a reading is beyond what its gauge's bridge can give");
    }
    choose_band();
    find_forces();
    weigh(std::vector<bool>(stations_.size(), true), best_);
    if (!locate_touch(best_)) {
      return not_reducible("the first wave is tensile: a ball only pushes; check `positive`");
    }
    choose_stations();
    if (!locate_touch(force_)) {
      return not_reducible("the record ends before the ball has pushed");
    }
    fill_history();
    measure();
    const BallFlight flight = ball_flight(shot_, reduction_.arrival_s);
    speed_problem_ = flight.problem;
    set_speeds(flight, shot_.bench.ball ? shot_.bench.ball->mass_kg : std::nullopt,
               *reduction_.ball);
    judge_quality();
    return std::move(reduction_);
  }

 private:
  double travel_samples(double distance_m) const {
    return distance_m / front_speed_m_per_s_ * rate_Hz_;
  }

  /// From first touch until the far end's reflection, carried back, overlies a station's force.
  double clean_samples(const Station& station) const {
    return 2.0 * travel_samples(station.gauge_to_far_end_m);
  }

  bool find_wave() {
    std::vector<double> readings(shot_.samples());
    read_raw_station(shot_, stations_[0], readings);
    const auto width =
        std::max<std::size_t>(3, static_cast<std::size_t>(std::ceil(kShortestPulse_s * rate_Hz_)));
    const auto reach_samples = static_cast<std::size_t>(clean_samples(stations_[0]));
    const auto rise = find_first_pulse(readings, width, reach_samples);
    if (!rise) {
      return false;
    }
    const double baseline = quiet_before(readings, std::min<std::size_t>(rise->index, 32)).baseline;
    const std::size_t end = std::min(readings.size(), rise->index + reach_samples);
    for (std::size_t n = 0; n < end; ++n) {
      readings[n] = rise->sense * (readings[n] - baseline);
    }
    const double peak =
        *std::max_element(readings.begin() + static_cast<std::ptrdiff_t>(rise->index),
                          readings.begin() + static_cast<std::ptrdiff_t>(end));
    foot_ = options_.arrival_s ? *options_.arrival_s * rate_Hz_
                               : foot_of(readings, rise->index, peak, 0.0).index;
    return true;
  }

  /// Samples of a station before the wave arrives there.
  std::size_t quiet_samples(const Station& station) const {
    const double later =
        travel_samples(station.gauge_to_specimen_m - stations_[0].gauge_to_specimen_m);
    const double end = foot_ + later - kFootClearance_s * rate_Hz_;
    return std::min(shot_.samples(), static_cast<std::size_t>(std::max(0.0, end)));
  }

  /// @return whether every reading is a strain
  bool read_strains() {
    const auto baseline = static_cast<std::size_t>(kBaseline_s * rate_Hz_);
    strains_.assign(stations_.size(), std::vector<double>(shot_.samples()));
    noise_strain_.clear();
    for (std::size_t i = 0; i < stations_.size(); ++i) {
      std::vector<double>& strain = strains_[i];
      const std::size_t quiet = quiet_samples(stations_[i]);
      read_station(shot_, stations_[i], quiet, strain);
      baseline_samples_ = std::max<std::size_t>(1, std::min(quiet, baseline));
      const std::span<const double> before(strain.data() + quiet - std::min(quiet, baseline),
                                           std::min(quiet, baseline));
      const double level = mean_of(before);
      for (double& value : strain) {
        value -= level;
      }
      noise_strain_.push_back(quiet_before(strain, quiet).noise_rms);
      if (!std::all_of(strain.begin(), strain.end(), [](double v) { return std::isfinite(v); })) {
        return false;
      }
    }
    return true;
  }

  /// The wave at a station, until the far end answers there.
  std::span<const double> wave_at(std::size_t i) const {
    const std::size_t quiet = quiet_samples(stations_[i]);
    const auto length = static_cast<std::size_t>(clean_samples(stations_[i]));
    const std::size_t most = std::min(length, t_.key.longest_pulse);
    return std::span<const double>(strains_[i])
        .subspan(quiet)
        .first(std::min(most, shot_.samples() - quiet));
  }

  void choose_band() {
    const auto quietest = static_cast<std::size_t>(
        std::min_element(noise_strain_.begin(), noise_strain_.end()) - noise_strain_.begin());
    const std::span<const double> wave = wave_at(quietest);
    double limit_Hz = options_.band_limit_Hz.value_or(0.0);
    if (!options_.band_limit_Hz) {
      limit_Hz = std::min(kHighestLowPass_Hz, t_.band.from_noise(wave, noise_strain_[quietest]));
    }
    bins_ = BandLimit::bins_within(t_.transform, limit_Hz);
    reach(kernels_, t_, bar_, options_.theory, stations_, bins_);
    reduction_.band_limit_Hz = limit_Hz;
    band_loss_ = t_.band.loss(wave, noise_strain_[quietest], limit_Hz);
    const auto largest = std::max_element(wave.begin(), wave.end());
    peak_strain_ = largest == wave.end() ? 0.0 : *largest;
    peak_over_noise_ = noise_strain_[quietest] > 0.0
                           ? std::max(peak_strain_, 1e-300) / noise_strain_[quietest]
                           : std::numeric_limits<double>::infinity();
  }

  /// The force on the face by each station.
  void find_forces() {
    forces_.assign(stations_.size(), {});
    std::vector<double> late(shot_.samples() + t_.key.delay);
    for (std::size_t i = 0; i < stations_.size(); ++i) {
      t_.transform.forward(strains_[i], t_.spectrum);
      t_.band.apply_half(reduction_.band_limit_Hz, t_.spectrum);
      t_.band.apply_half(reduction_.band_limit_Hz, t_.spectrum);
      for (std::size_t k = 0; k < bins_; ++k) {
        t_.spectrum[k] *= kernels_.force_of_strain[i][k];
      }
      std::fill(t_.spectrum.begin() + static_cast<std::ptrdiff_t>(bins_), t_.spectrum.end(), 0.0);
      t_.transform.inverse(t_.spectrum, late);
      forces_[i].assign(late.begin() + static_cast<std::ptrdiff_t>(t_.key.delay), late.end());
    }
  }

  /// The mean of the chosen stations' forces by their noise.
  void weigh(const std::vector<bool>& chosen, std::vector<double>& force) {
    const bool noiseless =
        std::any_of(noise_strain_.begin(), noise_strain_.end(), [](double n) { return n <= 0.0; });
    weights_.assign(stations_.size(), 0.0);
    double sum = 0.0;
    for (std::size_t i = 0; i < stations_.size(); ++i) {
      weights_[i] = !chosen[i] ? 0.0 : noiseless ? 1.0 : std::pow(noise_strain_[i], -2);
      sum += weights_[i];
    }
    force.assign(shot_.samples(), 0.0);
    clean_ = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < stations_.size(); ++i) {
      weights_[i] /= sum;
      if (weights_[i] > 0.0) {
        clean_ = std::min(clean_, clean_samples(stations_[i]));
        for (std::size_t n = 0; n < force.size(); ++n) {
          force[n] += weights_[i] * forces_[i][n];
        }
      }
    }
  }

  /// t = 0: the foot of the force at the face. @return whether there is a push
  bool locate_touch(const std::vector<double>& force) {
    const double smear = BandLimit::smear_s(reduction_.band_limit_Hz) * rate_Hz_;
    const double there = foot_ - travel_samples(stations_[0].gauge_to_specimen_m);
    const auto begin = static_cast<std::size_t>(std::max(0.0, there - smear));
    const double last = std::min(there + clean_ - smear, static_cast<double>(known_samples()));
    if (last < static_cast<double>(begin) + 8.0) {
      return false;
    }
    const auto end = static_cast<std::size_t>(last);
    const std::span<const double> push(force.data(), end);
    const std::size_t peak = begin + index_of_largest(push.subspan(begin));
    const double deepest =
        *std::min_element(push.begin() + static_cast<std::ptrdiff_t>(begin), push.end());
    if (force[peak] <= 0.0 || -deepest > force[peak]) {
      return false;
    }
    std::size_t half = peak;
    while (half > 0 && force[half] > force[peak] / 2.0) {
      --half;
    }
    const std::size_t quiet_from = std::min(begin, static_cast<std::size_t>(std::max(0.0, smear)));
    const std::size_t quiet_to =
        static_cast<std::size_t>(std::max(static_cast<double>(quiet_from), there - 2.0 * smear));
    quiet_force_ = std::span<const double>(force).subspan(quiet_from, quiet_to - quiet_from);
    noise_N_ = rms(quiet_force_);
    const Foot foot = foot_of(push, half, force[peak], noise_N_);
    touch_ = foot.index;
    reduction_.arrival_s = touch_ * period_s_;
    reduction_.arrival_sigma_s = foot.sigma * period_s_;
    return true;
  }

  /// The face's force is known up to a front's travel before the record's end.
  std::size_t known_samples() const {
    double longest = 0.0;
    for (std::size_t i = 0; i < stations_.size(); ++i) {
      if (weights_[i] > 0.0) {
        longest = std::max(longest, travel_samples(stations_[i].gauge_to_specimen_m));
      }
    }
    const double known = static_cast<double>(shot_.samples()) - longest -
                         BandLimit::smear_s(reduction_.band_limit_Hz) * rate_Hz_;
    return static_cast<std::size_t>(std::max(0.0, known));
  }

  /// Stations whose window ends before the ball has left would cut the others' short.
  void choose_stations() {
    double longest = 0.0;
    for (const Station& station : stations_) {
      longest = std::max(longest, clean_samples(station));
    }
    std::vector<bool> chosen(stations_.size());
    for (std::size_t i = 0; i < stations_.size(); ++i) {
      chosen[i] = clean_samples(stations_[i]) >= longest;
    }
    weigh(chosen, force_);
    if (locate_touch(force_)) {
      const std::span<const double> known = known_force();
      const std::size_t peak = index_of_largest(known);
      const Stay stay = stay_above(known, peak, threshold_for(known[peak]) * known[peak]);
      const double needed = stay.end - touch_ + (kAfterContact_s + 20e-6) * rate_Hz_;
      for (std::size_t i = 0; i < stations_.size(); ++i) {
        chosen[i] = chosen[i] || clean_samples(stations_[i]) >= needed;
      }
    }
    weigh(chosen, force_);
  }

  /// From the record's first sample to the end of what is known of the combined force.
  std::span<const double> known_force() const {
    const double smear = BandLimit::smear_s(reduction_.band_limit_Hz) * rate_Hz_;
    const double last = std::min(touch_ + clean_ - smear, static_cast<double>(known_samples()));
    return std::span<const double>(force_).first(
        static_cast<std::size_t>(std::clamp(last, 0.0, static_cast<double>(force_.size()))));
  }

  double threshold_for(double peak_N) const {
    const double allowed = kThresholdOverNoise * noise_N_ / peak_N;
    return std::max(kLeastThreshold, std::ceil(100.0 * allowed - 1e-9) / 100.0);
  }

  void fill_history() {
    BallImpact& ball = reduction_.ball.emplace();
    const std::span<const double> known = known_force();
    const auto first = static_cast<std::size_t>(std::ceil(touch_));
    auto count = known.size() > first ? known.size() - first : 0;
    if (options_.duration_s) {
      count = std::min(count, static_cast<std::size_t>(*options_.duration_s * rate_Hz_) + 1);
    }
    for (std::size_t n = first; n < first + count; ++n) {
      ball.time_s.push_back((static_cast<double>(n) - touch_) * period_s_);
      ball.force_N.push_back(known[n]);
    }
    ball.low_pass_Hz = reduction_.band_limit_Hz;
    ball.force_noise_N = noise_N_;
    ball.clean_from_s = travel_samples(stations_[0].gauge_to_specimen_m) * period_s_;
    ball.clean_until_s = clean_ * period_s_;
  }

  SampleRange contact_span(const Stay& stay, std::size_t known) const {
    const double margin = 2.0 * BandLimit::smear_s(reduction_.band_limit_Hz) * rate_Hz_;
    const double end = stay.end + margin + 20e-6 * rate_Hz_;
    return {static_cast<std::size_t>(std::max(0.0, touch_ - margin)),
            std::min(known, static_cast<std::size_t>(end))};
  }

  void measure() {
    BallImpact& ball = *reduction_.ball;
    const std::span<const double> known = known_force();
    const std::size_t peak = index_of_largest(known);
    ball.contact_threshold = threshold_for(known[peak]);
    const Stay stay = stay_above(known, peak, ball.contact_threshold * known[peak]);
    const SampleRange span = contact_span(stay, known.size());
    ball.contact_over = stay.over;
    ball.peak_force_N.value = known[peak];
    ball.peak_time_s = (static_cast<double>(peak) - touch_) * period_s_;
    ball.contact_time_s.value = (stay.end - stay.begin) * period_s_;
    ball.impulse_N_s.value = impulse(known, span);
    contact_end_s_ = (stay.end - touch_) * period_s_;
    find_deviations(known, stay, span);
    list_stations(span);
    look_after_contact(known, stay);
  }

  double impulse(std::span<const double> force, const SampleRange& span) const {
    return std::accumulate(force.begin() + static_cast<std::ptrdiff_t>(span.begin),
                           force.begin() + static_cast<std::ptrdiff_t>(span.end), 0.0) *
           period_s_;
  }

  /// Rms of the combined force's noise before the low-pass, taken as white.
  double raw_noise_N() const {
    const double N_per_strain = bar_.area_m2() * *bar_.youngs_modulus_Pa;
    double variance = 0.0;
    for (std::size_t i = 0; i < stations_.size(); ++i) {
      variance += std::pow(weights_[i] * noise_strain_[i] * N_per_strain, 2);
    }
    return std::sqrt(variance);
  }

  /// Relative deviation of every force alike: modulus, section, gauges.
  double scale_sd() const {
    double variance = std::pow(relative_sd(*bar_.youngs_modulus_Pa), 2) +
                      std::pow(2.0 * relative_sd(bar_.diameter_m), 2);
    for (std::size_t i = 0; i < stations_.size(); ++i) {
      for (const std::size_t channel : stations_[i].channels) {
        const double share = weights_[i] / static_cast<double>(stations_[i].channels.size());
        variance += std::pow(share * gain_sd(shot_.bench.gauges[channel], peak_strain_), 2);
      }
    }
    return std::sqrt(variance);
  }

  /// Noise and baseline: by adding stretches of the quiet before the impact to the force, each with
  /// a baseline of its own, and by the formulas for white noise; whichever is more.
  void find_deviations(std::span<const double> known, const Stay& stay, const SampleRange& span) {
    BallImpact& ball = *reduction_.ball;
    const auto length = static_cast<double>(span.end - span.begin);
    const double baseline_N = raw_noise_N() / std::sqrt(static_cast<double>(baseline_samples_));
    double peak_sd = std::hypot(noise_N_, baseline_N);
    double impulse_sd =
        period_s_ * std::hypot(raw_noise_N() * std::sqrt(length), baseline_N * length);
    double contact_sd = 0.0;
    for (const double slope : stay.slopes) {
      contact_sd = std::hypot(contact_sd, slope > 0.0 ? noise_N_ * period_s_ / slope : 0.0);
    }
    const std::size_t needed = baseline_samples_ + (span.end - span.begin);
    if (quiet_force_.size() > needed + kFewestDraws) {
      const ForceDeviations drawn = drawn_deviations(
          known, {quiet_force_, baseline_samples_, period_s_}, ball.contact_threshold, span);
      peak_sd = std::max(peak_sd, drawn.peak_sd);
      impulse_sd = std::max(impulse_sd, drawn.impulse_sd);
      contact_sd = std::max(contact_sd, drawn.contact_sd);
    }
    const double scale = scale_sd();
    ball.peak_force_N.sd = std::hypot(peak_sd, scale * ball.peak_force_N);
    ball.impulse_N_s.sd = std::hypot(impulse_sd, scale * ball.impulse_N_s);
    ball.contact_time_s.sd = contact_sd;
  }

  void list_stations(const SampleRange& span) {
    const double N_per_strain = bar_.area_m2() * *bar_.youngs_modulus_Pa;
    for (std::size_t i = 0; i < stations_.size(); ++i) {
      ForceStation station;
      station.gauges = names_of(stations_[i], shot_.bench);
      station.position_m = stations_[i].gauge_to_specimen_m;
      station.weight = weights_[i];
      station.clean_from_s = travel_samples(stations_[i].gauge_to_specimen_m) * period_s_;
      station.clean_until_s = station.clean_from_s + clean_samples(stations_[i]) * period_s_;
      station.noise_N = noise_strain_[i] * N_per_strain;
      station.impulse_N_s = impulse(forces_[i], span);
      reduction_.ball->stations.push_back(std::move(station));
    }
  }

  void look_after_contact(std::span<const double> known, const Stay& stay) {
    const auto from = static_cast<std::size_t>(stay.end + kAfterContact_s * rate_Hz_);
    if (from >= known.size()) {
      return;
    }
    const auto after = known.subspan(from);
    after_contact_N_ = mean_of(after);
    const auto count = static_cast<double>(after.size());
    after_contact_sd_N_ =
        raw_noise_N() * std::sqrt(1.0 / count + 1.0 / static_cast<double>(baseline_samples_));
  }

  void judge_quality() {
    reduction_.bar_model = "elastic bar, modulus from the bench";
    judge({.peak_over_noise = peak_over_noise_,
           .contact_end_s = contact_end_s_,
           .after_contact_N = after_contact_N_,
           .after_contact_sd_N = after_contact_sd_N_,
           .band_loss = band_loss_,
           .speed_problem = speed_problem_},
          reduction_);
  }

  const Shot& shot_;
  const Bar& bar_;
  const std::vector<Station>& stations_;
  const ReductionOptions& options_;
  BallPlans& t_;
  BallKernels& kernels_;
  double rate_Hz_;
  double period_s_;
  double front_speed_m_per_s_;
  double foot_ = 0.0;   ///< of the wave at the first station, in samples
  double touch_ = 0.0;  ///< first touch, in samples
  double clean_ = 0.0;  ///< samples from it that are known of the combined force
  std::size_t bins_ = 0;
  std::size_t baseline_samples_ = 1;
  std::vector<std::vector<double>> strains_;
  std::vector<double> noise_strain_;
  std::vector<std::vector<double>> forces_;
  std::vector<double> weights_;
  std::vector<double> best_;
  std::vector<double> force_;
  std::span<const double> quiet_force_;
  double noise_N_ = 0.0;
  double band_loss_ = 0.0;
  double peak_strain_ = 0.0;
  double peak_over_noise_ = 0.0;
  double contact_end_s_ = 0.0;
  double after_contact_N_ = 0.0;
  double after_contact_sd_N_ = 0.0;
  std::string speed_problem_;
  Reduction reduction_;
};

/// Rounded up, so that benches that differ a little share their plans.
std::size_t rounded_up(double samples) {
  constexpr std::size_t kStep = 32;
  return (static_cast<std::size_t>(std::ceil(samples)) + kStep) / kStep * kStep;
}

}  // namespace

struct BallReducer::State {
  std::unique_ptr<BallPlans> plans;
  std::unique_ptr<BallKernels> kernels;
};

BallReducer::BallReducer() : state_(std::make_unique<State>()) {}
BallReducer::~BallReducer() = default;

Reduction BallReducer::reduce(const Shot& shot, const ReductionOptions& options) {
  require_bench(shot);
  const std::string unusable = unusable_because(shot);
  if (!unusable.empty()) {
    return not_reducible(unusable);
  }
  const std::vector<Station> stations = stations_by_position(shot.bench);
  const Bar& bar = shot.bench.input;
  const double samples_per_m = shot.rate.Hz() / Pass::front_speed(bar);
  const BallPlanKey key{
      shot.samples(), shot.rate, rounded_up(stations.back().gauge_to_specimen_m * samples_per_m),
      std::min(shot.samples(),
               rounded_up(2.0 * stations.front().gauge_to_far_end_m * samples_per_m))};
  if (!state_->plans || !(state_->plans->key == key)) {
    state_->plans = std::make_unique<BallPlans>(key);
  }
  std::vector<double> numbers = ball_kernel_numbers(bar, options.theory, stations);
  if (!state_->kernels || state_->kernels->numbers != numbers || !(state_->kernels->key == key)) {
    state_->kernels = std::make_unique<BallKernels>(BallKernels{std::move(numbers), key, {}});
  }
  return Pass(shot, stations, options, *state_->plans, *state_->kernels).run();
}

}  // namespace kolsky
