#include <chrono>
#include <thread>

#include "tests/conformance/rig.hpp"
#include "tests/conformance/simulated_device.hpp"

namespace kolsky {
namespace {

class IioRig final : public Rig {
 public:
  std::unique_ptr<Digitiser> open(double speed, Tick /*samples*/) override {
    AdcSettings settings = SimulatedDevice::pattern_settings();
    settings.speed = speed;
    device_ = std::make_unique<SimulatedDevice>(settings);
    return open_digitiser(device_->uri(), pattern_options());
  }

  std::unique_ptr<Digitiser> open_with_hole() override { return open(1.0, kSamples); }

  /// Longer than the kernel buffers last (131 ms).
  void make_hole() override { std::this_thread::sleep_for(std::chrono::milliseconds(300)); }
  [[nodiscard]] bool announces_holes() const override { return true; }

  std::unique_ptr<Digitiser> open_to_break() override { return open(1.0, kSamples); }
  void break_off() override { device_->switch_off(); }
  void mend() override { device_->switch_on(); }

  [[nodiscard]] bool simulated() const override { return true; }

 private:
  std::unique_ptr<SimulatedDevice> device_;
};

}  // namespace

std::unique_ptr<Rig> make_iio_rig() {
  return std::make_unique<IioRig>();
}

}  // namespace kolsky
