#pragma once

#include <memory>
#include <optional>
#include <string>

#include "drivers/digitiser/open.hpp"
#include "drivers/simulated/iiod_server.hpp"
#include "drivers/simulated/simulated_adc.hpp"

namespace kolsky {

/// The simulated digitiser with the test pattern as its signal, on a free port; it can be switched
/// off and on again, and its converter runs on meanwhile.
class SimulatedDevice {
 public:
  explicit SimulatedDevice(AdcSettings settings = pattern_settings(),
                           const std::string& listen = "127.0.0.1:0");

  /// Two 16-bit channels at 1 MHz that give what a Rig promises.
  [[nodiscard]] static AdcSettings pattern_settings();

  [[nodiscard]] std::string uri() const { return uri_; }
  void switch_off();
  void switch_on();

  /// Shots that were asked for.
  [[nodiscard]] int shots() const;

 private:
  class PatternSource;
  PatternSource* source_ = nullptr;
  std::unique_ptr<SimulatedAdc> adc_;
  std::string uri_;
  std::unique_ptr<IiodServer> server_;
};

/// What a daemon would ask of it.
[[nodiscard]] DigitiserOptions pattern_options();

}  // namespace kolsky
