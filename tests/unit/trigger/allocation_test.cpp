#include <gtest/gtest.h>

#include <vector>

#include "processing/trigger/incident_trigger.hpp"
#include "tests/unit/trigger/counted_allocations.hpp"
#include "tests/unit/trigger/signals.hpp"

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

  const long before = counted_allocations();
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
  EXPECT_EQ(counted_allocations(), before);
  EXPECT_EQ(fired, 10);
}

TEST(IncidentTrigger, AllocatesDuringConstruction) {
  const long before = counted_allocations();
  const IncidentTrigger trigger{TriggerOptions{}};
  EXPECT_GT(counted_allocations(), before) << "the counter counts nothing";
}

}  // namespace
}  // namespace kolsky
