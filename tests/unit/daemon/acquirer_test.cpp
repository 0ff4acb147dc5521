#include "daemon/acquisition/acquirer.hpp"

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "tests/unit/daemon/scripted_digitiser.hpp"
#include "tests/unit/daemon/thread_conduct.hpp"

namespace kolsky {
namespace {

using Kind = AcquisitionEvent::Kind;
using std::chrono::milliseconds;

constexpr std::size_t kRing = 1 << 14;

class AcquirerTest : public testing::Test {
 protected:
  AcquirerTest() {
    plan_.trigger = TriggerOptions::for_rate(1e6);
    plan_.trigger.hold_off_samples = 1000;
    plan_.pre_samples = 400;
    plan_.post_samples = 1600;
  }

  void begin(bool armed = true, std::size_t ring = kRing) {
    ring_ = std::make_unique<SampleRing>(SampleFormat::int16, ScriptedDigitiser::kChannels, ring);
    acquirer_ = std::make_unique<Acquirer>(digitiser_, *ring_, events_, plan_);
    acquirer_->arm(armed);
    acquirer_->start();
  }

  /// Runs the script to its end and stops. @return what was told, without `triggered`
  std::vector<AcquisitionEvent> run(bool armed = true) {
    begin(armed);
    wait_for_script();
    return finish();
  }
  void wait_for_script() {
    const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (!digitiser_.script_done() && std::chrono::steady_clock::now() < patience) {
      std::this_thread::sleep_for(milliseconds(1));
    }
    ASSERT_TRUE(digitiser_.script_done());
  }
  std::vector<AcquisitionEvent> finish() {
    acquirer_->stop();
    events_.close();
    std::vector<AcquisitionEvent> told;
    AcquisitionEvent event;
    while (events_.pop(event)) {
      if (event.kind != Kind::triggered) {
        told.push_back(event);
      }
    }
    return told;
  }
  static std::vector<Kind> kinds(const std::vector<AcquisitionEvent>& events) {
    std::vector<Kind> kinds;
    kinds.reserve(events.size());
    for (const AcquisitionEvent& event : events) {
      kinds.push_back(event.kind);
    }
    return kinds;
  }

  ScriptedDigitiser digitiser_;
  AcquisitionPlan plan_;
  AcquisitionQueue events_;
  std::unique_ptr<SampleRing> ring_;
  std::unique_ptr<Acquirer> acquirer_;
};

TEST_F(AcquirerTest, CutsAWindowAboutAPulse) {
  digitiser_.add_pulse(5000);
  digitiser_.deliver(8192);
  const auto told = run();
  ASSERT_EQ(kinds(told), std::vector{Kind::window});
  const Window& window = told[0].window;
  EXPECT_EQ(window.trigger.kind, TriggerKind::incident);
  EXPECT_NEAR(static_cast<double>(window.trigger.tick), 5000.0, 2.0);
  EXPECT_EQ(window.first_tick, window.trigger.tick - 400);
  EXPECT_EQ(window.end_tick, window.trigger.tick + 1600);
  EXPECT_EQ(window.end, WindowEnd::full);
  // Each block carries its first tick in microseconds as its time.
  EXPECT_NEAR(static_cast<double>(window.complete_monotonic_ns), 1000.0 * 6600, 1000.0 * 256);

  std::vector<std::int32_t> codes(2000);
  for (std::size_t channel = 0; channel < 2; ++channel) {
    ASSERT_EQ(ring_->copy(channel, window.first_tick, codes), SampleRing::CopyStatus::copied);
    for (std::size_t k = 0; k < codes.size(); ++k) {
      ASSERT_EQ(codes[k], digitiser_.code(channel, window.first_tick + static_cast<Tick>(k)));
    }
  }
  EXPECT_EQ(acquirer_->counters().samples_read, 8192U);
  EXPECT_EQ(acquirer_->counters().triggers, 1U);
  EXPECT_EQ(acquirer_->counters().samples_missing, 0U);
}

TEST_F(AcquirerTest, KnowsBaselineAndNoiseOfEveryChannel) {
  digitiser_.deliver(40'960);
  begin();
  wait_for_script();
  for (std::size_t channel = 0; channel < 2; ++channel) {
    const SignalLevel level = acquirer_->level(channel);
    EXPECT_TRUE(level.learned);
    EXPECT_NEAR(level.baseline_codes, 99.5, 1.0);  // codes are truncated
    EXPECT_NEAR(level.noise_codes, 4.0, 0.3);
    EXPECT_EQ(level.constant_samples, 0);
  }
  EXPECT_NEAR(acquirer_->level(0).level_codes, 32.0, 3.0);
  EXPECT_EQ(acquirer_->level(1).level_codes, 0.0);
  EXPECT_TRUE(finish().empty());
}

TEST_F(AcquirerTest, SeesNothingWhileDisarmed) {
  digitiser_.add_pulse(5000);
  digitiser_.deliver(8192);
  EXPECT_TRUE(run(false).empty());
  EXPECT_EQ(acquirer_->counters().triggers, 0U);
}

TEST_F(AcquirerTest, CutsTheWindowWhereTheStreamBegins) {
  digitiser_.add_pulse(350);
  digitiser_.deliver(4096);
  const auto told = run();
  ASSERT_EQ(kinds(told), std::vector{Kind::window});
  EXPECT_EQ(told[0].window.first_tick, 0);
  EXPECT_EQ(told[0].window.end, WindowEnd::full);
}

TEST_F(AcquirerTest, CutsTheWindowWhereTheCaptureEnds) {
  digitiser_.add_pulse(3500);
  digitiser_.deliver(4100);
  digitiser_.end_after_script();
  const auto told = run();
  ASSERT_EQ(kinds(told), (std::vector{Kind::window, Kind::end_of_capture}));
  EXPECT_EQ(told[0].window.end_tick, 4100);
  EXPECT_EQ(told[0].window.end, WindowEnd::capture_end);
  EXPECT_TRUE(acquirer_->ended());
}

TEST_F(AcquirerTest, TellsAKnownGapBeforeTheWindowThatHoldsIt) {
  digitiser_.add_pulse(5000);
  digitiser_.deliver(5376);
  digitiser_.add({.samples = 256, .missing = {Missing::Kind::known, 137}});
  digitiser_.deliver(4096);
  const auto told = run();
  ASSERT_EQ(kinds(told), (std::vector{Kind::gap, Kind::window}));
  EXPECT_EQ(told[0].gap, (Gap{.first_tick = 5376, .samples = 137, .known = true}));
  EXPECT_EQ(acquirer_->counters().samples_missing, 137U);
  EXPECT_EQ(acquirer_->counters().gaps_of_unknown_length, 0U);
  // Ticks are time: what came after the hole stands at its own ticks.
  std::vector<std::int32_t> codes(1);
  ASSERT_EQ(ring_->copy(0, 5376 + 137, codes), SampleRing::CopyStatus::copied);
  EXPECT_EQ(codes[0], digitiser_.code(0, 5376 + 137));
  ASSERT_EQ(ring_->copy(0, 5376 + 100, codes), SampleRing::CopyStatus::copied);
  EXPECT_EQ(codes[0], digitiser_.code(0, 5375));
}

TEST_F(AcquirerTest, BelievesTheBlockAfterAnOverflow) {
  digitiser_.deliver(1024);
  digitiser_.add({.status = ReadStatus::overflow});
  digitiser_.deliver(1024);  // a device that counts: nothing was lost after all
  digitiser_.add({.status = ReadStatus::overflow});
  digitiser_.add({.samples = 256, .missing = {Missing::Kind::unknown, 0}});
  const auto told = run();
  ASSERT_EQ(kinds(told), (std::vector{Kind::overflow, Kind::overflow, Kind::gap}));
  EXPECT_EQ(told[2].gap, (Gap{.first_tick = 2048, .samples = 0, .known = false}));
  EXPECT_EQ(acquirer_->counters().overflows, 2U);
  EXPECT_EQ(acquirer_->counters().gaps_of_unknown_length, 1U);
}

TEST_F(AcquirerTest, TakesAnOverflowAtTheEndForAHoleThere) {
  digitiser_.add_pulse(3500);
  digitiser_.deliver(4100);
  digitiser_.add({.status = ReadStatus::overflow});
  digitiser_.end_after_script();
  const auto told = run();
  ASSERT_EQ(kinds(told), (std::vector{Kind::overflow, Kind::window, Kind::end_of_capture}));
  EXPECT_EQ(told[1].window.end, WindowEnd::interrupted);
}

TEST_F(AcquirerTest, ClosesTheWindowWhenTheDeviceGoesAndReachesItAgain) {
  digitiser_.add_pulse(5000);
  digitiser_.deliver(5632);
  digitiser_.add({.status = ReadStatus::disconnected});
  digitiser_.add({.samples = 256, .missing = {Missing::Kind::unknown, 0}});
  digitiser_.add_pulse(5932);
  digitiser_.deliver(4096);
  digitiser_.refuse_reconnections(1);
  const auto told = run();
  ASSERT_EQ(kinds(told), (std::vector{Kind::window, Kind::disconnected, Kind::reconnected,
                                      Kind::gap, Kind::window}));
  EXPECT_EQ(told[0].window.end, WindowEnd::interrupted);
  EXPECT_EQ(told[0].window.end_tick, 5632);
  // The next window does not reach back over the hole.
  EXPECT_NEAR(static_cast<double>(told[4].window.trigger.tick), 5932.0, 2.0);
  EXPECT_EQ(told[4].window.first_tick, 5632);
  EXPECT_EQ(told[4].window.end, WindowEnd::full);
  EXPECT_EQ(acquirer_->counters().reconnects, 1U);
  EXPECT_TRUE(acquirer_->connected());
}

TEST_F(AcquirerTest, LeavesACaptureWholeWhoseSuccessorHasGone) {
  digitiser_.add_pulse(5000);
  digitiser_.deliver(5632);
  digitiser_.add({.status = ReadStatus::disconnected});
  digitiser_.end_after_script();
  const auto told = run();
  ASSERT_EQ(kinds(told), (std::vector{Kind::window, Kind::disconnected, Kind::reconnected,
                                      Kind::end_of_capture}));
  EXPECT_EQ(told[0].window.end, WindowEnd::capture_end);
}

TEST_F(AcquirerTest, DoesNotTakeADeviceThatCameBackWithAnotherScale) {
  digitiser_.deliver(1024);
  digitiser_.add({.status = ReadStatus::disconnected});
  digitiser_.deliver(1024);
  digitiser_.change_scale_on_reconnect();
  begin();
  std::this_thread::sleep_for(milliseconds(500));
  EXPECT_FALSE(acquirer_->connected());
  EXPECT_EQ(kinds(finish()), (std::vector{Kind::disconnected, Kind::changed}));
  EXPECT_EQ(acquirer_->counters().samples_read, 1024U);
}

TEST_F(AcquirerTest, InterruptsTheWindowWhenStopped) {
  digitiser_.add_pulse(5000);
  digitiser_.deliver(5632);
  const auto told = run();
  ASSERT_EQ(kinds(told), std::vector{Kind::window});
  EXPECT_EQ(told[0].window.end, WindowEnd::interrupted);
  EXPECT_EQ(told[0].window.end_tick, 5632);
}

TEST_F(AcquirerTest, BringsAMarkedCaptureBackWhole) {
  const TriggerEvent mark{
      .tick = 3100, .fraction = 0.25, .sigma_samples = 0.05, .kind = TriggerKind::marked};
  digitiser_.add_pulse(4000);  // which the software would have taken
  digitiser_.deliver(5000);
  digitiser_.end_after_script();
  digitiser_.mark_block(3100 / 256, mark);
  const auto told = run();
  ASSERT_EQ(kinds(told), (std::vector{Kind::window, Kind::end_of_capture}));
  EXPECT_EQ(told[0].window.trigger, mark);
  EXPECT_EQ(told[0].window.first_tick, 0);
  EXPECT_EQ(told[0].window.end_tick, 5000);
  EXPECT_EQ(told[0].window.end, WindowEnd::full);
  EXPECT_EQ(acquirer_->counters().triggers, 1U);
}

TEST_F(AcquirerTest, CutsAMarkedCaptureThatDoesNotFitTheRing) {
  const TriggerEvent mark{.tick = 3100, .kind = TriggerKind::marked};
  digitiser_.deliver(3 * kRing);
  digitiser_.mark_block(3100 / 256, mark);
  digitiser_.end_after_script();
  begin();
  AcquisitionEvent event;
  std::vector<AcquisitionEvent> windows;
  while (events_.pop_wait(event) && event.kind != Kind::end_of_capture) {
    if (event.kind == Kind::window) {
      windows.push_back(event);
      std::vector<std::int32_t> codes(2000);
      EXPECT_EQ(ring_->copy(0, event.window.first_tick, codes), SampleRing::CopyStatus::copied);
      acquirer_->release_window();
    }
  }
  ASSERT_EQ(windows.size(), 1U);
  EXPECT_EQ(windows[0].window.first_tick, 2700);
  EXPECT_EQ(windows[0].window.end_tick, 4700);
  finish();
}

TEST_F(AcquirerTest, CutsTheUsualWindowAboutAHardwareMark) {
  const TriggerEvent mark{.tick = 3100, .kind = TriggerKind::marked};
  digitiser_.deliver(8192);
  digitiser_.mark_block(3100 / 256, mark);
  const auto told = run();
  ASSERT_EQ(kinds(told), std::vector{Kind::window});
  EXPECT_EQ(told[0].window.trigger, mark);
  EXPECT_EQ(told[0].window.first_tick, 2700);
  EXPECT_EQ(told[0].window.end_tick, 4700);
}

TEST_F(AcquirerTest, LosesNoWindowOfAReplayToASlowRecorder) {
  constexpr int kCaptures = 40;
  digitiser_.end_after_script();
  for (int i = 0; i < kCaptures; ++i) {
    digitiser_.add({.samples = 256,
                    .missing = {i == 0 ? Missing::Kind::none : Missing::Kind::unknown, 0},
                    .starts_capture = true});
    digitiser_.add_pulse(4096 * i + 1000);
    digitiser_.deliver(4096 - 256);
  }
  begin(true, kRing);
  AcquisitionEvent event;
  int windows = 0;
  while (events_.pop_wait(event) && event.kind != Kind::end_of_capture) {
    EXPECT_NE(event.kind, Kind::gap);
    if (event.kind != Kind::window) {
      continue;
    }
    std::this_thread::sleep_for(milliseconds(3));
    const Tick first = event.window.first_tick;
    EXPECT_NEAR(static_cast<double>(event.window.trigger.tick), 4096.0 * windows + 1000.0, 2.0);
    std::vector<std::int32_t> codes(2000);
    ASSERT_EQ(ring_->copy(1, first, codes), SampleRing::CopyStatus::copied);
    EXPECT_EQ(codes.front(), digitiser_.code(1, first));
    EXPECT_EQ(codes.back(), digitiser_.code(1, first + 1999));
    acquirer_->release_window();
    ++windows;
  }
  EXPECT_EQ(windows, kCaptures);
  EXPECT_EQ(acquirer_->counters().gaps_of_unknown_length, 0U);
  finish();
}

TEST_F(AcquirerTest, ForcesAWindowArmedOrNot) {
  digitiser_.deliver(1024);
  begin(false);
  wait_for_script();
  acquirer_->force();
  digitiser_.append_live(4096);
  std::this_thread::sleep_for(milliseconds(50));
  const auto told = finish();
  ASSERT_EQ(kinds(told), std::vector{Kind::window});
  EXPECT_EQ(told[0].window.trigger.kind, TriggerKind::forced);
  EXPECT_EQ(told[0].window.trigger.tick, 1024);
  EXPECT_EQ(told[0].window.first_tick, 624);
}

TEST_F(AcquirerTest, SaysWhichTriggersFoundTooManyWindowsOpen) {
  plan_.trigger.hold_off_samples = 200;
  for (Tick tick = 1000; tick < 1000 + 20 * 600; tick += 600) {
    digitiser_.add_pulse(tick);
  }
  plan_.post_samples = 13'000;
  digitiser_.deliver(26'112);
  const auto told = run();
  std::size_t windows = 0;
  std::size_t refused = 0;
  for (const AcquisitionEvent& event : told) {
    windows += event.kind == Kind::window ? 1 : 0;
    refused += event.kind == Kind::window_refused ? 1 : 0;
  }
  EXPECT_EQ(windows + refused, acquirer_->counters().triggers);
  EXPECT_EQ(acquirer_->counters().triggers, 20U);
  EXPECT_EQ(windows, 16U);
  EXPECT_EQ(acquirer_->counters().windows_refused, refused);
}

TEST_F(AcquirerTest, NeverLetsAWindowLookWholeBecauseTheQueueWasFull) {
  constexpr std::int64_t kGaps = 400;
  for (std::int64_t i = 0; i < kGaps; ++i) {
    digitiser_.add({.samples = 16, .missing = {Missing::Kind::known, 3}});
  }
  begin();
  wait_for_script();
  std::int64_t missing = 0;
  AcquisitionEvent event;
  Gap last;
  while (events_.pop(event)) {
    last = event.gap;
    missing += last.samples;
  }
  EXPECT_TRUE(last.known);
  acquirer_->force();
  digitiser_.append_live(4096);
  std::this_thread::sleep_for(milliseconds(100));
  const auto told = finish();
  ASSERT_GE(told.size(), 2U);
  EXPECT_EQ(told[0].kind, Kind::gap);
  EXPECT_FALSE(told[0].gap.known);
  EXPECT_EQ(missing + told[0].gap.samples, 3 * kGaps);
  EXPECT_EQ(told[1].kind, Kind::window);
}

TEST_F(AcquirerTest, TakesAnotherPlanWhileItRuns) {
  digitiser_.deliver(1024);
  begin();
  wait_for_script();
  plan_.pre_samples = 10;
  plan_.post_samples = 20;
  acquirer_->change_plan(plan_);
  acquirer_->change_plan(plan_);
  acquirer_->force();
  digitiser_.append_live(512);
  std::this_thread::sleep_for(milliseconds(50));
  const auto told = finish();
  ASSERT_EQ(kinds(told), std::vector{Kind::window});
  EXPECT_EQ(told[0].window.end_tick - told[0].window.first_tick, 30);
}

TEST_F(AcquirerTest, LearnsAnewForAnotherTriggerChannel) {
  digitiser_.deliver(8192);
  begin();
  wait_for_script();
  std::this_thread::sleep_for(milliseconds(20));
  EXPECT_TRUE(acquirer_->level(0).learned);
  EXPECT_TRUE(acquirer_->level(1).learned);
  plan_.trigger_channel = 1;
  acquirer_->change_plan(plan_);
  digitiser_.append_live(64);
  std::this_thread::sleep_for(milliseconds(50));
  EXPECT_FALSE(acquirer_->level(0).learned);
  EXPECT_FALSE(acquirer_->level(1).learned);
  finish();
}

TEST_F(AcquirerTest, GivesUpItsPriorityToAStreamThatLeavesNoRest) {
  digitiser_.append_live(std::size_t{1} << 40);
  begin();
  std::this_thread::sleep_for(milliseconds(200));
  if (!acquirer_->real_time()) {
    GTEST_SKIP() << "real-time scheduling is not permitted here";
  }
  std::this_thread::sleep_for(milliseconds(2000));
  EXPECT_FALSE(acquirer_->real_time());
  finish();
}

TEST_F(AcquirerTest, NeitherAllocatesNorLocksNorWritesOnItsThread) {
  if (!kWatchesConduct) {
    GTEST_SKIP() << "a sanitizer has these functions";
  }
  const ThreadConduct before = watched_conduct();
  digitiser_.add_pulse(5000);
  digitiser_.deliver(8192);
  digitiser_.add({.status = ReadStatus::overflow});
  digitiser_.add({.status = ReadStatus::timeout});
  digitiser_.add({.samples = 256, .missing = {Missing::Kind::known, 5}});
  digitiser_.add({.status = ReadStatus::disconnected});
  digitiser_.deliver(1024);
  EXPECT_FALSE(run().empty());
  const ThreadConduct after = watched_conduct();
  EXPECT_EQ(after.allocations, before.allocations);
  EXPECT_EQ(after.locks, before.locks);
  EXPECT_EQ(after.writes, before.writes);
}

/// What the test above counts it would see.
TEST(ThreadConduct, CountsWhatAThreadThatAcquiresMustNotDo) {
  if (!kWatchesConduct) {
    GTEST_SKIP() << "a sanitizer has these functions";
  }
  std::mutex lock;
  const ThreadConduct before = watched_conduct();
  watch_conduct(true);
  {
    const std::scoped_lock held(lock);
    spdlog::warn("a line that is formatted and written");
  }
  watch_conduct(false);
  const ThreadConduct after = watched_conduct();
  EXPECT_GT(after.locks, before.locks + 1) << "the logger has one of its own";
  EXPECT_GT(after.writes, before.writes);
  watch_conduct(true);
  const auto memory = std::make_unique<std::string>(100, 'x');
  watch_conduct(false);
  EXPECT_GT(watched_conduct().allocations, after.allocations);
}

}  // namespace
}  // namespace kolsky
