#include "drivers/simulated/digitiser_setup.hpp"

namespace kolsky {

AdcSettings adc_settings(const Scenario& scenario) {
  const FrontEndSettings& front_end = scenario.front_end;
  AdcSettings settings;
  settings.bits = front_end.bits;
  for (const Gauge& gauge : scenario.bench.gauges) {
    settings.channels.push_back({gauge.name, front_end.volts_per_code() * 1e3,
                                 static_cast<double>(front_end.offset_codes),
                                 front_end.strain_per_code()});
  }
  for (const PhotoSensor& sensor : scenario.bench.photo_sensors) {
    settings.channels.push_back({sensor.name, front_end.volts_per_code() * 1e3,
                                 static_cast<double>(front_end.offset_codes), std::nullopt});
  }
  settings.rates.clear();
  for (const double rate_Hz : kSampleRates_Hz) {
    settings.rates.push_back(SampleRate::from_Hz(rate_Hz));
  }
  settings.rate = SampleRate::from_Hz(scenario.bench.sampling_frequency_Hz);
  settings.scenario = scenario.name;
  settings.seed = front_end.seed;
  return settings;
}

}  // namespace kolsky
