#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>
#include <vector>

#include "processing/trigger/incident_trigger.hpp"
#include "tests/unit/trigger/signals.hpp"

namespace {
std::atomic<long> allocations{0};  // NOLINT: what the replaced operator counts with
}

void* operator new(std::size_t size) {
  allocations.fetch_add(1);
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace kolsky {
namespace {

TEST(IncidentTrigger, AllocatesNothingAfterConstruction) {
  signals::Source source({.noise_codes = 20.0,
                          .hum_codes = 300.0,
                          .spikes = 1e-3,
                          .spike_codes = 5000.0,
                          .spike_samples = 4},
                         11);
  const signals::Pulse pulse{4000.0, 30.0, 170.0};
  constexpr std::size_t kBlock = 5000;
  std::vector<std::int16_t> narrow(20 * kBlock);
  for (std::size_t i = 0; i < narrow.size(); ++i) {
    const double since = static_cast<double>(i % (4 * kBlock)) - 9000.3;
    narrow[i] = signals::quantised(source.next() + pulse.at(since));
  }
  const std::vector<std::int32_t> wide(narrow.begin(), narrow.end());
  TriggerOptions options;
  options.hold_off_samples = 2000;
  IncidentTrigger trigger(options);

  const long before = allocations.load();
  int fired = 0;
  const auto play = [&](const auto& codes) {
    const std::span all(codes);
    for (std::size_t at = 0; at < all.size(); at += kBlock) {
      const auto block = all.subspan(at, kBlock);
      fired += trigger.feed(static_cast<Tick>(at), block, run_statistics(block)) ? 1 : 0;
    }
    trigger.reset_run();
    trigger.reset();
  };
  play(narrow);
  play(wide);
  EXPECT_EQ(allocations.load(), before);
  EXPECT_EQ(fired, 10);
}

TEST(IncidentTrigger, AllocatesDuringConstruction) {
  const long before = allocations.load();
  const IncidentTrigger trigger{TriggerOptions{}};
  EXPECT_GT(allocations.load(), before) << "the counter counts nothing";
}

}  // namespace
}  // namespace kolsky
