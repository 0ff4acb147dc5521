#include "drivers/digitiser/open.hpp"

#include <algorithm>
#include <bit>
#include <string_view>

#include "drivers/iio/iio_digitiser.hpp"
#include "drivers/replay/replay_digitiser.hpp"

namespace kolsky {

std::size_t default_block(double arrival_rate_Hz) {
  constexpr double kBlock_s = 1e-3;
  constexpr double kMost = 1 << 20;
  return std::bit_ceil(
      static_cast<std::size_t>(std::clamp(kBlock_s * arrival_rate_Hz, 16.0, kMost)));
}

std::unique_ptr<Digitiser> open_digitiser(const std::string& uri, const DigitiserOptions& options) {
  constexpr std::string_view kReplay = "replay:";
  if (uri.starts_with(kReplay)) {
    return std::make_unique<ReplayDigitiser>(uri, uri.substr(kReplay.size()), options);
  }
  return std::make_unique<IioDigitiser>(uri, options);
}

}  // namespace kolsky
