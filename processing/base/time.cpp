#include "processing/base/time.hpp"

#include <cmath>
#include <numeric>

namespace kolsky {

SampleRate SampleRate::from_Hz(double rate_Hz) noexcept {
  constexpr std::int64_t kResolution = 1'000'000;
  if (!std::isfinite(rate_Hz) || rate_Hz <= 0.0 || rate_Hz > 9e12) {
    return {0, 1};
  }
  const auto scaled = static_cast<std::int64_t>(std::llround(rate_Hz * kResolution));
  const std::int64_t common = std::gcd(scaled, kResolution);
  return {scaled / common, kResolution / common};
}

}  // namespace kolsky
