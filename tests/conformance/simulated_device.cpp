#include "tests/conformance/simulated_device.hpp"

#include <atomic>
#include <utility>

#include "tests/conformance/pattern.hpp"
#include "tests/conformance/rig.hpp"

namespace kolsky {

class SimulatedDevice::PatternSource final : public CodeSource {
 public:
  void convert(std::size_t channel, Tick first_tick, std::span<std::int32_t> codes) override {
    for (std::int32_t& code : codes) {
      code = pattern_code(channel, first_tick++);
    }
  }
  void fire(Tick) override { ++shots; }
  [[nodiscard]] Tick shot_samples() const override { return 1; }
  void set_rate(SampleRate) override {}

  std::atomic<int> shots{0};
};

SimulatedDevice::SimulatedDevice(AdcSettings settings, const std::string& listen) {
  auto source = std::make_unique<PatternSource>();
  source_ = source.get();
  adc_ = std::make_unique<SimulatedAdc>(std::move(settings), std::move(source));
  server_ = std::make_unique<IiodServer>(listen, *adc_);
  server_->start();
  uri_ = server_->uri();
}

AdcSettings SimulatedDevice::pattern_settings() {
  AdcSettings settings;
  for (std::size_t i = 0; i < Rig::kChannels; ++i) {
    settings.channels.push_back({.label = "g" + std::to_string(i + 1),
                                 .scale_mV = 1000.0 * Rig::kScale_V[i],
                                 .offset_codes = Rig::kOffset[i],
                                 .strain_scale = 1e-7});
  }
  return settings;
}

void SimulatedDevice::switch_off() {
  server_.reset();
}

void SimulatedDevice::switch_on() {
  server_ = std::make_unique<IiodServer>(uri_.substr(3), *adc_);
  server_->start();
}

int SimulatedDevice::shots() const {
  return source_->shots;
}

DigitiserOptions pattern_options() {
  DigitiserOptions options;
  options.channel_count = Rig::kChannels;
  options.sampling_frequency_Hz = Rig::kRate_Hz;
  options.block_samples = Rig::kBlockSamples;
  return options;
}

}  // namespace kolsky
