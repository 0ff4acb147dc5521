#include <cmath>
#include <string>

#include "processing/base/error.hpp"
#include "processing/trigger/incident_trigger.hpp"

namespace kolsky {
namespace {

constexpr double kWidth_s = 5e-6;
constexpr double kRise_s = 40e-6;
constexpr double kHoldOff_s = 0.1;
constexpr double kLearn_s = 25e-6;
constexpr double kBaselineMemory_s = 256e-6;
constexpr double kNoiseMemory_s = 20e-3;
constexpr double kHighestRate_Hz = 1e10;

std::size_t samples(double time_s, double rate_Hz, std::size_t least) {
  return std::max(least, static_cast<std::size_t>(std::llround(time_s * rate_Hz)));
}

void require(bool good, const char* setting, const std::string& value, const char* mend) {
  if (!good) throw InputError(setting, value + " cannot work", mend);
}

}  // namespace

TriggerOptions TriggerOptions::for_rate(double sampling_frequency_Hz) {
  if (!(sampling_frequency_Hz > 0.0) || sampling_frequency_Hz > kHighestRate_Hz) {
    throw InputError("sampling_frequency_Hz",
                     std::to_string(sampling_frequency_Hz) + " is not a sampling rate",
                     "give samples per second, at most 1e10");
  }
  TriggerOptions options;
  options.minimum_width_samples = samples(kWidth_s, sampling_frequency_Hz, 4);
  options.maximum_rise_samples = samples(kRise_s, sampling_frequency_Hz, 16);
  options.hold_off_samples = samples(kHoldOff_s, sampling_frequency_Hz, 0);
  options.learn_samples = samples(kLearn_s, sampling_frequency_Hz, 256);
  options.baseline_memory_samples = samples(kBaselineMemory_s, sampling_frequency_Hz, 256);
  options.noise_memory_samples = samples(kNoiseMemory_s, sampling_frequency_Hz, 2048);
  return options;
}

void check(const TriggerOptions& options) {
  const auto number = [](double value) { return std::to_string(value); };
  const auto count = [](std::size_t value) { return std::to_string(value); };
  constexpr std::size_t kMost = std::size_t{1} << 24;
  require(options.level_sigma >= 3.0 && options.level_sigma <= 1e6, "level_sigma",
          number(options.level_sigma), "give at least 3 standard deviations; 8 is usual");
  require(options.hysteresis_share >= 0.1 && options.hysteresis_share <= 0.9, "hysteresis_share",
          number(options.hysteresis_share), "give a share of the level between 0.1 and 0.9");
  require(options.minimum_width_samples >= 1 && options.minimum_width_samples <= kMost,
          "minimum_width_samples", count(options.minimum_width_samples),
          "give the time for which a pulse certainly lasts, in samples");
  require(options.maximum_rise_samples >= options.minimum_width_samples &&
              options.maximum_rise_samples <= kMost,
          "maximum_rise_samples", count(options.maximum_rise_samples),
          "give at least minimum_width_samples");
  require(options.learn_samples >= 64 && options.learn_samples <= kMost &&
              options.learn_samples >= 2 * options.minimum_width_samples,
          "learn_samples", count(options.learn_samples),
          "give at least 64 and twice minimum_width_samples");
  require(options.minimum_noise_codes > 0.0 && std::isfinite(options.minimum_noise_codes),
          "minimum_noise_codes", number(options.minimum_noise_codes),
          "give a positive number of codes; half a code is usual");
  require(options.baseline_memory_samples >= 1 && options.baseline_memory_samples <= kMost,
          "baseline_memory_samples", count(options.baseline_memory_samples),
          "give the samples that the baseline may follow within");
  require(options.noise_memory_samples >= 1, "noise_memory_samples",
          count(options.noise_memory_samples), "give the samples of one period of the mains");
}

}  // namespace kolsky
