#include "drivers/iio/sample_counter.hpp"

namespace kolsky {

std::uint64_t SampleCounter::steps(std::uint64_t from, std::uint64_t to) const noexcept {
  const std::uint64_t difference = to - from;
  return format_.bits >= 64 ? difference : difference & ((std::uint64_t{1} << format_.bits) - 1);
}

std::optional<Tick> SampleCounter::missing_before(const std::byte* value,
                                                  Tick possible) const noexcept {
  if (!last_) {
    return 0;
  }
  const std::uint64_t missing = steps(*last_ + 1, read_unsigned(format_, value));
  const auto most = static_cast<std::uint64_t>(possible < 0 ? 0 : possible);
  const bool may_have_gone_round = format_.bits < 64 && most >> format_.bits != 0;
  if (missing > most || may_have_gone_round) {
    return std::nullopt;
  }
  return static_cast<Tick>(missing);
}

std::size_t SampleCounter::run_length(const std::byte* first, std::ptrdiff_t stride,
                                      std::size_t samples) const noexcept {
  const std::uint64_t start = read_unsigned(format_, first);
  const auto follows = [&](std::size_t i) {
    const std::byte* value = first + stride * static_cast<std::ptrdiff_t>(i);
    return steps(start, read_unsigned(format_, value)) == i;
  };
  // Once a sample is off, all after it are: bisect.
  std::size_t good = 0;
  std::size_t end = samples;
  if (follows(samples - 1)) {
    return samples;
  }
  while (end - good > 1) {
    const std::size_t middle = good + (end - good) / 2;
    (follows(middle) ? good : end) = middle;
  }
  return end;
}

}  // namespace kolsky
