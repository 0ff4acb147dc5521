#include "drivers/digitiser/open.hpp"

#include <string_view>

#include "drivers/iio/iio_digitiser.hpp"
#include "drivers/replay/replay_digitiser.hpp"

namespace kolsky {

std::unique_ptr<Digitiser> open_digitiser(const std::string& uri, const DigitiserOptions& options) {
  constexpr std::string_view kReplay = "replay:";
  if (uri.starts_with(kReplay)) {
    return std::make_unique<ReplayDigitiser>(uri, uri.substr(kReplay.size()), options);
  }
  return std::make_unique<IioDigitiser>(uri, options);
}

}  // namespace kolsky
