#include "processing/reduction/reducer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "processing/base/error.hpp"
#include "processing/reduction/ball_reducer.hpp"
#include "processing/reduction/band_limit.hpp"
#include "processing/reduction/carrying.hpp"
#include "processing/reduction/pulse.hpp"
#include "processing/reduction/quality.hpp"
#include "processing/reduction/stations.hpp"

namespace kolsky {

namespace {

/// A run above the level shorter than this is a spike, not a pulse.
constexpr double kShortestPulse_s = 5e-6;
/// The quiet part ends this many filter widths and this much time before the foot.
constexpr double kFootClearance_s = 10e-6;

/// One bar with how waves travel in it.
struct BarModel {
  std::unique_ptr<const Compliance> compliance;
  double front_speed_m_per_s;
  BarWaves waves;

  BarModel(const Bar& bar, const Station& station, const Material& viscoelastic)
      : compliance(compliance_of(bar, viscoelastic)),
        front_speed_m_per_s(kolsky::front_speed_m_per_s(bar, *compliance)),
        waves{bar.area_m2(),
              bar.density_kg_m3,
              station.gauge_to_specimen_m,
              station.gauge_to_far_end_m,
              bar.far_end,
              front_speed_m_per_s,
              {}} {}
};

std::string describe(const Bench& bench, const Material& viscoelastic, bool assumed) {
  const bool elastic_input = bench.input.youngs_modulus_Pa.has_value();
  const bool elastic_output = bench.output->youngs_modulus_Pa.has_value();
  if (elastic_input && elastic_output) {
    return "elastic bars, moduli from the bench";
  }
  std::string text = viscoelastic.source.empty() ? "the bar model given" : viscoelastic.source;
  if (assumed) {
    text += ", assumed because no bar model was given";
  }
  return text;
}

/// What decides the kernels: two shots that agree in it are reduced with the same ones.
std::vector<double> numbers_of(const Bench& b, const Material& m, WaveTheory theory,
                               const Station& in, const Station& out) {
  return {static_cast<double>(theory),
          m.E1_Pa,
          m.E2_Pa,
          m.eta2_Pa_s,
          b.input.area_m2(),
          b.input.density_kg_m3,
          b.input.youngs_modulus_Pa.value_or(Measured{}),
          b.input.poisson_ratio,
          b.input.dispersion_radius_m(),
          b.output->poisson_ratio,
          b.output->dispersion_radius_m(),
          b.output->area_m2(),
          b.output->density_kg_m3,
          b.output->youngs_modulus_Pa.value_or(Measured{}),
          in.gauge_to_specimen_m,
          in.gauge_to_far_end_m,
          out.gauge_to_specimen_m,
          out.gauge_to_far_end_m,
          static_cast<double>(b.output->far_end),
          b.specimen->length_m};
}

/// Seconds a front needs over a distance.
double front_time_s(const BarModel& bar, double distance_m) {
  return distance_m / bar.front_speed_m_per_s;
}

/// Samples from just before the incident pulse to the specimen's answer at the gauge.
std::size_t longest_pulse(const Shot& shot, const BarModel& bar) {
  const double round_trip_s = 2.0 * front_time_s(bar, bar.waves.gauge_to_specimen_m);
  return static_cast<std::size_t>((round_trip_s + kFootClearance_s) * shot.rate.Hz()) + 2;
}

/// Samples that a front needs from a gauge to the specimen, on the bar where it needs more.
std::size_t longest_travel(const Shot& shot, const BarModel& input, const BarModel& output) {
  const double travel_s = std::max(front_time_s(input, input.waves.gauge_to_specimen_m),
                                   front_time_s(output, output.waves.gauge_to_specimen_m));
  return static_cast<std::size_t>(std::ceil(travel_s * shot.rate.Hz()));
}

/// Rounded up, so that benches that differ a little share their plans.
std::size_t rounded_up(std::size_t samples) {
  constexpr std::size_t kStep = 32;
  return (samples + kStep - 1) / kStep * kStep;
}

/// What decides the plans.
struct PlanKey {
  std::size_t samples;
  SampleRate rate;
  std::size_t delay;  ///< samples by which histories come out late, so that nothing looks ahead
  std::size_t longest_pulse;
  bool operator==(const PlanKey&) const = default;
};

/// Plans and work space for shots of one length.
struct Plans {
  PlanKey key;
  DampedTransform transform;
  BandLimit band;
  std::vector<Complex> path;
  std::vector<double> input_strain, output_strain, incident_strain, history, scratch;
  std::vector<Complex> incident, rest, output_spectrum, work;

  explicit Plans(const PlanKey& k)
      : key(k),
        transform(k.samples + k.delay, k.rate.period_s()),
        band(transform, k.longest_pulse),
        path(transform.bins()),
        input_strain(k.samples),
        output_strain(k.samples),
        incident_strain(k.samples),
        history(k.samples + k.delay),
        scratch(k.samples + k.delay),
        incident(transform.bins()),
        rest(transform.bins()),
        output_spectrum(transform.bins()),
        work(transform.bins()) {
    for (std::size_t n = 0; n < path.size(); ++n) {
      path[n] = transform.s(n);
    }
  }

  /// Bins in which a filter with this limit leaves more than 1e-18.
  [[nodiscard]] std::size_t bins_within(double limit_Hz) const {
    constexpr double kNothingFrom = 2.8;
    const auto bins =
        static_cast<std::size_t>(kNothingFrom * limit_Hz / transform.bin_width_Hz()) + 2;
    return std::min(bins, path.size());
  }
};

/// The bars of one bench, with what carries their waves as far up in frequency as was asked for.
struct Tables {
  std::vector<double> numbers;
  PlanKey plan;
  WaveTheory theory;
  Bar input_bar;
  Bar output_bar;
  double specimen_length_m;
  BarModel input;
  BarModel output;
  CarryingKernels kernels;

  Tables(std::vector<double> n, const PlanKey& p, WaveTheory t, const Bench& bench,
         const Material& m, const Station& in, const Station& out)
      : numbers(std::move(n)),
        plan(p),
        theory(t),
        input_bar(bench.input),
        output_bar(*bench.output),
        specimen_length_m(bench.specimen->length_m),
        input(bench.input, in, m),
        output(*bench.output, out, m) {}

  void reach(const Plans& plans, std::size_t bins) {
    if (kernels.bins() >= bins) {
      return;
    }
    const std::vector<Complex> path(plans.path.begin(),
                                    plans.path.begin() + static_cast<std::ptrdiff_t>(bins));
    input.waves.modes = bar_modes(theory, input_bar, *input.compliance, path);
    output.waves.modes = bar_modes(theory, output_bar, *output.compliance, path);
    const double delay_s = static_cast<double>(plan.delay) * plan.rate.period_s();
    kernels = CarryingKernels(path, input.waves, output.waves, specimen_length_m, delay_s);
  }

  /// Where surface gauges go blind, if within so many bins.
  [[nodiscard]] double highest_Hz(const Plans& plans, std::size_t bins) const {
    const auto path = std::span(plans.path).first(bins);
    return std::min(blind_from_Hz(std::span(input.waves.modes).first(bins), path),
                    blind_from_Hz(std::span(output.waves.modes).first(bins), path));
  }
};

Reduction not_reducible(std::string reason) {
  Reduction reduction;
  reduction.quality.reason = std::move(reason);
  return reduction;
}

void require_reducible_bench(const Shot& shot) {
  if (shot.bench.kind != BenchKind::shpb || !shot.bench.output || !shot.bench.specimen) {
    throw InputError("kind", "is not \"shpb\", so there is no specimen to reduce",
                     "use a bench file of kind \"shpb\" with bars.output and specimen, or "
                     "\"impact\" with a ball");
  }
  if (shot.channels.size() != shot.bench.gauges.size()) {
    throw InputError("gauges",
                     std::to_string(shot.bench.gauges.size()) + " are filed but the shot has " +
                         std::to_string(shot.channels.size()) + " channels",
                     "file one gauge per channel, in their order");
  }
}

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
  Pass(const Shot& shot, const Station& in, const Station& out, const ReductionOptions& options,
       Plans& plans, Tables& tables)
      : shot_(shot),
        in_(in),
        out_(out),
        options_(options),
        t_(plans),
        bars_(tables),
        rate_Hz_(shot.rate.Hz()),
        period_s_(shot.rate.period_s()) {}

  Reduction run() {
    if (!find_incident()) {
      return not_reducible("no incident pulse stands out of the noise on " +
                           shot_.channels[in_.channels.front()].gauge);
    }
    if (split_ >= shot_.samples()) {
      return not_reducible("the record ends before the specimen's answer reaches " +
                           shot_.channels[in_.channels.front()].gauge);
    }
    transform_records();
    locate_arrival();
    if (!choose_window()) {
      return not_reducible("the record ends before the pulse has loaded the specimen");
    }
    fill_histories();
    judge_quality();
    set_stress(options_.stress, options_.corrections, *shot_.bench.specimen, reduction_);
    return std::move(reduction_);
  }

 private:
  bool find_incident() {
    const auto width = static_cast<std::size_t>(std::ceil(kShortestPulse_s * rate_Hz_));
    const double round_trip_s = 2.0 * front_time_s(bars_.input, in_.gauge_to_specimen_m);
    const auto reach = static_cast<std::size_t>(round_trip_s * rate_Hz_);
    read_raw_station(shot_, in_, t_.input_strain);
    const auto rise = find_first_pulse(t_.input_strain, std::max<std::size_t>(width, 3), reach);
    if (!rise) {
      return false;
    }
    double foot = rough_foot(*rise, reach);
    if (options_.arrival_s) {
      foot = *options_.arrival_s * rate_Hz_;
    }
    const auto clearance = kFootClearance_s * rate_Hz_;
    quiet_ = static_cast<std::size_t>(std::max(0.0, foot - clearance));
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
    std::copy_n(t_.input_strain.begin(), split_, t_.incident_strain.begin());
    std::fill(t_.incident_strain.begin() + static_cast<std::ptrdiff_t>(split_),
              t_.incident_strain.end(), 0.0);
    t_.transform.forward(t_.incident_strain, t_.incident);
    const auto pulse = std::span<const double>(t_.incident_strain).subspan(quiet_, split_ - quiet_);
    choose_band(pulse);
    t_.transform.forward(t_.input_strain, t_.rest);
    t_.transform.forward(t_.output_strain, t_.output_spectrum);
    for (auto* spectrum : {&t_.rest, &t_.output_spectrum}) {
      t_.band.apply_half(reduction_.band_limit_Hz, in_band(*spectrum));
      t_.band.apply_half(reduction_.band_limit_Hz, in_band(*spectrum));
    }
    complete_incident();
    for (std::size_t k = 0; k < bins_; ++k) {
      t_.rest[k] -= t_.incident[k];
    }
  }

  void choose_band(std::span<const double> pulse) {
    double limit_Hz = options_.band_limit_Hz.value_or(0.0);
    if (!options_.band_limit_Hz) {
      limit_Hz = std::min(t_.band.from_noise(pulse, input_noise_),
                          options_.most_band_Hz.value_or(limit_Hz_of_rate()));
    }
    bins_ = t_.bins_within(limit_Hz);
    bars_.reach(t_, bins_);
    if (!options_.band_limit_Hz) {
      limit_Hz = std::min(limit_Hz, bars_.highest_Hz(t_, bins_));
    }
    reduction_.band_limit_Hz = limit_Hz;
    band_loss_ = t_.band.loss(pulse, input_noise_, limit_Hz);
  }

  /// All of a spectrum that the kernels go on to read.
  [[nodiscard]] std::span<Complex> in_band(std::vector<Complex>& spectrum) const {
    return std::span(spectrum).first(bins_);
  }

  double limit_Hz_of_rate() const { return rate_Hz_ / 2.0; }

  /// Gives the incident pulse the tail that the specimen's answer hides: at the impacted end it is
  /// the striker's push, which is over before the hidden part would have started there.
  void complete_incident() {
    t_.band.apply_half(reduction_.band_limit_Hz, in_band(t_.incident));
    bars_.kernels.push_from_incident(t_.incident, bins_);
    t_.transform.inverse(t_.incident, t_.history);
    const double known =
        static_cast<double>(split_) - BandLimit::smear_s(reduction_.band_limit_Hz) * rate_Hz_;
    const auto end = static_cast<std::size_t>(std::max(0.0, known));
    judge_push(end);
    std::fill(t_.history.begin() + static_cast<std::ptrdiff_t>(end), t_.history.end(), 0.0);
    t_.transform.forward(t_.history, t_.incident);
    bars_.kernels.incident_from_push(t_.incident, bins_);
    t_.band.apply_half(reduction_.band_limit_Hz, in_band(t_.incident));
  }

  /// How much of the push is left at the end of what is known of it, averaged over a few samples so
  /// that it is the push that is judged and not the noise.
  void judge_push(std::size_t end) {
    const auto few = std::min(end, static_cast<std::size_t>(10e-6 * rate_Hz_) + 1);
    double left = 0.0;
    for (std::size_t n = end - few; n < end; ++n) {
      left += t_.history[n] / static_cast<double>(few);
    }
    const double peak = largest(std::span<const double>(t_.history).first(end));
    push_left_share_ = peak > 0.0 ? std::abs(left) / peak : 1.0;
  }

  /// t = 0: the foot of the incident pulse after it has been carried to interface A.
  void locate_arrival() {
    bars_.kernels.right_going_front(inputs(), t_.work);
    t_.transform.inverse(t_.work, t_.history);
    const double travel = front_time_s(bars_.input, in_.gauge_to_specimen_m) * rate_Hz_;
    const double late = travel + static_cast<double>(t_.key.delay);
    const auto begin = static_cast<std::size_t>(gauge_foot_ + late);
    const auto end = std::min(t_.history.size(), split_ + static_cast<std::size_t>(late));
    for (std::size_t n = 0; n < end; ++n) {
      t_.scratch[n] = sense_ * t_.history[n];
    }
    const std::span<const double> pulse(t_.scratch.data(), end);
    const auto peak =
        std::max_element(pulse.begin() + static_cast<std::ptrdiff_t>(begin), pulse.end());
    auto half = static_cast<std::size_t>(peak - pulse.begin());
    while (half > 0 && pulse[half] > *peak / 2.0) {
      --half;
    }
    const double noise = input_noise_ * t_.band.noise_share(reduction_.band_limit_Hz);
    Foot foot = foot_of(pulse, half, *peak, noise);
    foot.index -= static_cast<double>(t_.key.delay);
    if (options_.arrival_s) {
      foot.index = gauge_foot_ + travel;
      foot.sigma = 0.0;
    }
    reduction_.arrival_s = foot.index * period_s_;
    reduction_.arrival_sigma_s = foot.sigma * period_s_;
  }

  /// From the arrival until the first wave is back from a far end, as far as the record allows: the
  /// waves at the specimen are known up to a front's travel before the record's end.
  bool choose_window() {
    const Bench& bench = shot_.bench;
    const double arrival = reduction_.arrival_s * rate_Hz_;
    first_ = static_cast<std::size_t>(std::ceil(arrival));
    const double first_return_s = 2.0 * std::min(front_time_s(bars_.input, bench.input.length_m),
                                                 far_end_time_s(bench.output->length_m));
    const double duration_s = options_.duration_s.value_or(first_return_s);
    const double smear = BandLimit::smear_s(reduction_.band_limit_Hz) * rate_Hz_;
    const double last = std::min(
        arrival + duration_s * rate_Hz_,
        static_cast<double>(shot_.samples() - longest_travel(shot_, bars_.input, bars_.output)) -
            smear);
    constexpr double kFewestSamples = 8.0;
    if (last < arrival + kFewestSamples) {
      return false;
    }
    count_ = static_cast<std::size_t>(last) - first_;
    return true;
  }

  /// Seconds a front needs over a stretch of the output bar that ends at its far end, if anything
  /// comes back from there.
  double far_end_time_s(double distance_m) const {
    return bars_.output.waves.far_end == FarEnd::free ? front_time_s(bars_.output, distance_m)
                                                      : std::numeric_limits<double>::infinity();
  }

  CarryingKernels::Inputs inputs() const {
    return {t_.incident, t_.rest, t_.output_spectrum, bins_};
  }

  using Kernel = void (CarryingKernels::*)(const CarryingKernels::Inputs&,
                                           std::vector<Complex>&) const;

  /// The history behind a kernel, cut to the window.
  std::vector<double> history(Kernel kernel) {
    (bars_.kernels.*kernel)(inputs(), t_.work);
    t_.transform.inverse(t_.work, t_.history);
    return window();
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
    reduction_.strain_rate_per_s = history(&CarryingKernels::strain_rate);

    reduction_.time_s.resize(count_);
    reduction_.stress_Pa.resize(count_);
    reduction_.strain.resize(count_);
    double strain = strain_before_window();
    for (std::size_t n = 0; n < count_; ++n) {
      reduction_.time_s[n] = static_cast<double>(first_ + n) * period_s_ - reduction_.arrival_s;
      reduction_.strain[n] = strain;
      if (n + 1 < count_) {
        strain += period_s_ *
                  (reduction_.strain_rate_per_s[n] + reduction_.strain_rate_per_s[n + 1]) / 2.0;
      }
    }
  }

  /// The rate integrated over what the low-pass has smeared before the arrival; t_.history still
  /// holds it.
  double strain_before_window() {
    const double lead = 2.0 * BandLimit::smear_s(reduction_.band_limit_Hz) * rate_Hz_;
    const auto begin = static_cast<std::size_t>(std::max(0.0, static_cast<double>(first_) - lead));
    double strain = 0.0;
    for (std::size_t n = begin + t_.key.delay; n < first_ + t_.key.delay; ++n) {
      strain += period_s_ * (t_.history[n] + t_.history[n + 1]) / 2.0;
    }
    return strain;
  }

  void judge_quality() {
    QualityInputs q;
    const auto incident = std::span<const double>(t_.incident_strain).first(split_);
    q.input_peak = largest(incident);
    q.input_noise_rms = input_noise_;
    const auto travel =
        static_cast<std::size_t>((front_time_s(bars_.input, in_.gauge_to_specimen_m) +
                                  front_time_s(bars_.output, out_.gauge_to_specimen_m)) *
                                 rate_Hz_);
    const std::size_t begin =
        std::min(static_cast<std::size_t>(gauge_foot_) + travel, shot_.samples());
    const std::size_t end = std::min(begin + count_, shot_.samples());
    q.output_peak = largest(std::span<const double>(t_.output_strain).subspan(begin, end - begin));
    q.output_noise_rms = output_noise_;
    q.push_left_share = push_left_share_;
    q.returns_from_s = 2.0 * std::min(front_time_s(bars_.input, in_.gauge_to_far_end_m),
                                      far_end_time_s(out_.gauge_to_far_end_m));
    q.may_shorten = !options_.duration_s;
    q.quiet_samples = quiet_;
    const Specimen& specimen = *shot_.bench.specimen;
    q.front_rate_per_s = front_rate_per_s_;
    q.specimen_length_m = specimen.length_m;
    if (specimen.density_kg_m3) {
      q.specimen_mass_kg = *specimen.density_kg_m3 * specimen.area_m2() * specimen.length_m;
    }
    q.band_loss = band_loss_;
    reduction_.quality.reducible = true;
    judge(q, reduction_);
  }

  const Shot& shot_;
  const Station& in_;
  const Station& out_;
  const ReductionOptions& options_;
  Plans& t_;
  Tables& bars_;
  std::size_t bins_ = 0;  ///< within the band
  double rate_Hz_;
  double period_s_;
  double sense_ = 1.0;
  double gauge_foot_ = 0.0;
  double push_left_share_ = 0.0;
  double band_loss_ = 0.0;
  std::vector<double> front_rate_per_s_;
  double input_noise_ = 0.0;
  double output_noise_ = 0.0;
  std::size_t quiet_ = 0;
  std::size_t split_ = 0;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  Reduction reduction_;
};

}  // namespace

struct Reducer::State {
  ReductionOptions options;
  std::unique_ptr<Plans> plans;
  std::unique_ptr<Tables> tables;
  BallReducer ball{};
};

Reducer::Reducer(ReductionOptions options) : state_(std::make_unique<State>()) {
  state_->options = std::move(options);
}
Reducer::~Reducer() = default;
Reducer::Reducer(Reducer&&) noexcept = default;
Reducer& Reducer::operator=(Reducer&&) noexcept = default;

void Reducer::set_bar_model(const Material& material) {
  state_->options.bar_model = material;
}

Reduction Reducer::reduce(const Shot& shot) {
  if (shot.bench.kind == BenchKind::impact) {
    return state_->ball.reduce(shot, state_->options);
  }
  require_reducible_bench(shot);
  const std::string unusable = unusable_because(shot);
  if (!unusable.empty()) {
    return not_reducible(unusable);
  }
  const ReductionOptions& options = state_->options;
  const bool assumed = !options.bar_model && !shot.bar_model;
  const Material material = options.bar_model ? *options.bar_model
                            : shot.bar_model  ? *shot.bar_model
                                              : paper_pmma();
  const Station in = station_on(shot.bench, "input");
  const Station out = station_on(shot.bench, "output");
  std::vector<double> numbers = numbers_of(shot.bench, material, options.theory, in, out);
  const BarModel input(shot.bench.input, in, material);
  const BarModel output(*shot.bench.output, out, material);
  const PlanKey plan{shot.samples(), shot.rate, rounded_up(longest_travel(shot, input, output)),
                     rounded_up(longest_pulse(shot, input))};
  if (!state_->plans || !(state_->plans->key == plan)) {
    state_->plans = std::make_unique<Plans>(plan);
  }
  if (!state_->tables || state_->tables->numbers != numbers || !(state_->tables->plan == plan)) {
    state_->tables = std::make_unique<Tables>(std::move(numbers), plan, options.theory, shot.bench,
                                              material, in, out);
  }
  Reduction reduction = Pass(shot, in, out, options, *state_->plans, *state_->tables).run();
  reduction.bar_model = describe(shot.bench, material, assumed);
  return reduction;
}

}  // namespace kolsky
