#include "processing/models/pulse_probe.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kolsky {

namespace {

constexpr std::size_t kSamples = 4096;
constexpr std::size_t kPulse = 24;

}  // namespace

PulseProbe::PulseProbe(double period_s)
    : period_s_(period_s),
      transform_(kSamples, period_s),
      start_(transform_.length() / 2),
      pulse_(transform_.bins()),
      record_(transform_.length(), 0.0) {
  for (std::size_t n = 0; n < kPulse; ++n) {
    const double share = static_cast<double>(n) / kPulse;
    record_[start_ + n] = std::pow(std::sin(std::numbers::pi * share), 4);
  }
  transform_.forward(record_, pulse_);
  for (std::size_t k = 0; k < transform_.bins(); ++k) {
    path_.push_back(transform_.s(k));
  }
}

PulseProbe::Answer PulseProbe::answer(std::span<const Complex> spectrum, double lead_s) {
  transform_.inverse(spectrum, record_);
  const auto lead = static_cast<std::size_t>(std::ceil(lead_s / period_s_)) + 1;
  Answer answer;
  for (std::size_t n = 0; n < record_.size(); ++n) {
    const double size = std::abs(record_[n]);
    answer.anywhere = std::max(answer.anywhere, size);
    if (n + lead < start_) {
      answer.before_pulse = std::max(answer.before_pulse, size);
    }
  }
  return answer;
}

}  // namespace kolsky
