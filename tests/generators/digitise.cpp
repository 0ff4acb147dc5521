#include "tests/generators/digitise.hpp"

#include <algorithm>
#include <cmath>

#include "processing/base/error.hpp"

namespace kolsky::testing {

Shot digitised(const Bench& bench, const std::vector<std::vector<double>>& readings,
               const std::vector<double>& offset_strain, const Digitiser& digitiser,
               const std::map<std::string, std::string>& meta) {
  Shot shot;
  shot.bench = bench;
  shot.rate = SampleRate::from_Hz(bench.sampling_frequency_Hz);
  shot.meta = meta;
  TriggerEvent trigger;
  trigger.tick = static_cast<Tick>(digitiser.pretrigger);
  trigger.kind = TriggerKind::marked;
  trigger.sigma_samples = 1.0;
  shot.trigger = trigger;
  std::mt19937_64 random(digitiser.seed);
  const double sign = bench.positive == PositiveSense::compression ? 1.0 : -1.0;
  const int bits = digitiser.bits > 0 ? digitiser.bits : 31;
  const double full = std::ldexp(1.0, bits - 1);
  for (std::size_t g = 0; g < readings.size(); ++g) {
    const Gauge& gauge = bench.gauges[g];
    const double per_unit = gauge.strain_per_V ? gauge.strain_per_V->value : 1.0;
    ChannelRecord channel;
    channel.gauge = gauge.name;
    channel.unit = gauge.unit;
    channel.bits = digitiser.bits > 0 ? digitiser.bits : 32;
    channel.scale = digitiser.full_scale_strain / full / per_unit;
    channel.code_min = static_cast<std::int32_t>(-full);
    channel.code_max = static_cast<std::int32_t>(full - 1.0);
    const std::vector<double> jitter =
        noise(digitiser.colour, digitiser.noise_strain, shot.rate.period_s(), readings[g].size(),
              random, digitiser.measured_noise);
    for (std::size_t n = 0; n < readings[g].size(); ++n) {
      if (!std::isfinite(readings[g][n])) {
        throw InputError("campaign", "the calculation of " + gauge.name + " ran away",
                         "take weaker effects or gentler shots");
      }
      const double value = sign * (readings[g][n] + offset_strain[g] + jitter[n]) / per_unit;
      channel.codes.push_back(static_cast<std::int32_t>(
          std::clamp(std::round(value / channel.scale), -full, full - 1.0)));
    }
    shot.channels.push_back(std::move(channel));
  }
  return shot;
}

}  // namespace kolsky::testing
