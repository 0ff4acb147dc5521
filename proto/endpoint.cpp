#include "proto/endpoint.hpp"

#include <charconv>
#include <cstdint>
#include <string_view>

#include "processing/base/error.hpp"

namespace kolsky::wire {

void check_port(const std::string& place, const std::string& endpoint) {
  constexpr std::string_view kScheme = "tcp://";
  const std::size_t colon = endpoint.rfind(':');
  if (!endpoint.starts_with(kScheme) || colon < kScheme.size()) {
    return;
  }
  const std::string_view port = std::string_view(endpoint).substr(colon + 1);
  std::uint16_t number = 0;
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), number);
  const bool whole = error == std::errc() && end == port.data() + port.size();
  if (!whole && port != "*") {
    throw InputError(place, "\"" + std::string(port) + "\" is no port",
                     "give a number from 1 to 65535");
  }
}

}  // namespace kolsky::wire
