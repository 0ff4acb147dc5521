#include "drivers/simulated/front_end.hpp"

#include <algorithm>
#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "drivers/simulated/number_text.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

/// Steele, Lea and Flood's SplitMix64: cheap to seed, so that every chunk of noise has its own.
class SplitMix {
 public:
  using result_type = std::uint64_t;
  explicit SplitMix(std::uint64_t state) : state_(state) {}
  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return std::numeric_limits<result_type>::max(); }
  result_type operator()() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15U);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31);
  }

 private:
  std::uint64_t state_;
};

double uniform(std::uint64_t seed, std::uint64_t channel) {
  SplitMix engine(seed * 0x2545f4914f6cdd1dU + channel);
  engine();
  return static_cast<double>(engine() >> 11) * 0x1p-53;
}

/// Adds a sine by turning a pointer from sample to sample, exact at the first.
void add_sine(double amplitude, double frequency_Hz, double phase, Tick first_tick, SampleRate rate,
              std::span<double> values) {
  if (amplitude == 0.0) {
    return;
  }
  const double turns = frequency_Hz * static_cast<double>(first_tick) * rate.period_s() + phase;
  const double angle = 2.0 * std::numbers::pi * (turns - std::floor(turns));
  const double step = 2.0 * std::numbers::pi * frequency_Hz * rate.period_s();
  const double turn_cos = std::cos(step);
  const double turn_sin = std::sin(step);
  double x = amplitude * std::cos(angle);
  double y = amplitude * std::sin(angle);
  for (double& value : values) {
    value += y;
    const double next = x * turn_cos - y * turn_sin;
    y = x * turn_sin + y * turn_cos;
    x = next;
  }
}

// Beyond it doubles are whole numbers: adding and taking it away rounds to the nearest, and unlike
// a call of the library it is done for several numbers at once.
constexpr double kRounding = 0x1.8p52;

void check_not_negative(const char* setting, double value) {
  constexpr double kMost_microstrain = 1e6;
  if (!(value >= 0.0) || !(value <= kMost_microstrain)) {
    throw InputError(setting, number_text(value) + " microstrain", "give a number from 0 to 1e6");
  }
}

}  // namespace

double FrontEndSettings::strain_per_code() const {
  return std::ldexp(range_microstrain * 1e-6, 1 - bits);
}

double FrontEndSettings::volts_per_code() const {
  return std::ldexp(full_scale_V, 1 - bits);
}

double FrontEndSettings::strain_per_V() const {
  return range_microstrain * 1e-6 / full_scale_V;
}

void check(const FrontEndSettings& settings) {
  if (settings.bits < 12 || settings.bits > 24) {
    throw InputError("bits", std::to_string(settings.bits) + " is not a simulated resolution",
                     "give 12 to 24");
  }
  if (!(settings.range_microstrain > 0.0) || !(settings.range_microstrain <= 1e6)) {
    throw InputError("range", number_text(settings.range_microstrain) + " microstrain",
                     "give a number above 0, at most 1e6");
  }
  check_not_negative("noise", settings.noise_microstrain);
  check_not_negative("hum", settings.hum_microstrain);
  check_not_negative("drift", settings.drift_microstrain);
  if (!(std::abs(settings.offset_microstrain) <= 1e6)) {
    throw InputError("offset", number_text(settings.offset_microstrain) + " microstrain",
                     "give a number from -1e6 to 1e6");
  }
  if (!(settings.drift_period_s > 0.0)) {
    throw InputError("drift period", number_text(settings.drift_period_s) + " s",
                     "give a number above 0");
  }
  if (std::abs(static_cast<double>(settings.offset_codes)) >= std::ldexp(1.0, settings.bits - 1)) {
    throw InputError("offset codes", std::to_string(settings.offset_codes) + " is out of range",
                     "give fewer than the converter has");
  }
}

void NoiseStream::draw(Tick chunk) {
  SplitMix mix(seed_ ^ (channel_ << 56));
  SplitMix engine(mix() ^ static_cast<std::uint64_t>(chunk) * 0xd1342543de82ef95U);
  boost::random::normal_distribution<float> normal;
  std::generate(numbers_.begin(), numbers_.end(), [&] { return normal(engine); });
  drawn_ = chunk;
}

void NoiseStream::add(Tick first_tick, double factor, std::span<double> values) {
  if (factor == 0.0) {
    return;
  }
  while (!values.empty()) {
    const Tick chunk = first_tick / kChunk;
    if (chunk != drawn_) {
      draw(chunk);
    }
    const auto from = static_cast<std::size_t>(first_tick - chunk * kChunk);
    const std::size_t count = std::min(values.size(), numbers_.size() - from);
    for (std::size_t i = 0; i < count; ++i) {
      values[i] += factor * static_cast<double>(numbers_[from + i]);
    }
    values = values.subspan(count);
    first_tick += static_cast<Tick>(count);
  }
}

FrontEnd::FrontEnd(const FrontEndSettings& settings, std::size_t channel)
    : settings_(settings),
      offset_strain_(settings.offset_microstrain * (channel % 2 == 0 ? 1e-6 : -1e-6)),
      hum_phase_(uniform(settings.seed, 2 * channel)),
      drift_phase_(uniform(settings.seed, 2 * channel + 1)),
      noise_(settings.seed, channel) {}

void FrontEnd::convert(Tick first_tick, SampleRate rate, std::span<double> strain,
                       std::span<std::int32_t> codes) {
  noise_.add(first_tick, settings_.noise_microstrain * 1e-6, strain);
  add_sine(settings_.hum_microstrain * 1e-6, settings_.hum_Hz, hum_phase_, first_tick, rate,
           strain);
  add_sine(settings_.drift_microstrain * 1e-6, 1.0 / settings_.drift_period_s, drift_phase_,
           first_tick, rate, strain);
  const double codes_per_strain = 1.0 / settings_.strain_per_code();
  const double zero = offset_strain_ * codes_per_strain - settings_.offset_codes;
  const double most = std::ldexp(1.0, settings_.bits - 1);
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const double code = std::clamp(strain[i] * codes_per_strain + zero, -most, most - 1.0);
    codes[i] = static_cast<std::int32_t>((code + kRounding) - kRounding);
  }
}

}  // namespace kolsky
