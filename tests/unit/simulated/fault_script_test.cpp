#include "drivers/simulated/fault_script.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "processing/base/error.hpp"

namespace kolsky {
namespace {

std::vector<Fault> parse(const std::string& text) {
  std::istringstream script(text);
  return parse_fault_script(script, "faults.txt");
}

TEST(FaultScript, ReadsEveryKind) {
  const std::vector<Fault> faults = parse(
      "# what goes wrong\n"
      "\n"
      "shot 3 at 120 lose 250\n"
      "time 2.5s drop 1s   # and comes back\n"
      "shot 1 at 0 short 10\r\n"
      "shot 1 at 5 late 20ms\n"
      "shot 1 at 5 timeout\n"
      "time 300us hang\n"
      "time 1s hang 2s\n"
      "shot 2 at 1 extra-channel\n"
      "shot 2 at 1 overflow\n"
      "shot 2 at 7 clip 40");
  ASSERT_EQ(faults.size(), 10U);
  EXPECT_EQ(faults[0].kind, FaultKind::lose);
  EXPECT_EQ(faults[0].shot, 3);
  EXPECT_EQ(faults[0].at_sample, 120);
  EXPECT_EQ(faults[0].samples, 250);
  EXPECT_EQ(faults[1].kind, FaultKind::drop);
  EXPECT_EQ(faults[1].shot, 0);
  EXPECT_DOUBLE_EQ(faults[1].time_s, 2.5);
  EXPECT_DOUBLE_EQ(faults[1].duration_s, 1.0);
  EXPECT_EQ(faults[2].kind, FaultKind::short_block);
  EXPECT_EQ(faults[3].kind, FaultKind::late_block);
  EXPECT_DOUBLE_EQ(faults[3].duration_s, 0.02);
  EXPECT_EQ(faults[4].kind, FaultKind::timeout);
  EXPECT_EQ(faults[5].kind, FaultKind::hang);
  EXPECT_DOUBLE_EQ(faults[5].time_s, 3e-4);
  EXPECT_DOUBLE_EQ(faults[5].duration_s, 0.0);
  EXPECT_DOUBLE_EQ(faults[6].duration_s, 2.0);
  EXPECT_EQ(faults[7].kind, FaultKind::extra_channel);
  EXPECT_EQ(faults[8].kind, FaultKind::overflow);
  EXPECT_EQ(faults[9].kind, FaultKind::clip);
}

TEST(FaultScript, RefusesWrongLinesWithTheirNumber) {
  for (const char* line : {"lose 250",
                           "shot 3 120 lose 250",
                           "shot 0 at 1 lose 2",
                           "shot x at 1 lose 2",
                           "shot 1 at -1 lose 2",
                           "shot 1 at 1",
                           "shot 1 at 1 explode",
                           "shot 1 at 1 lose",
                           "shot 1 at 1 lose 0",
                           "shot 1 at 1 lose 2.5",
                           "shot 1 at 1 lose 9999999999",
                           "shot 1 at 1 lose 5 now",
                           "shot 1 at 1 late 20",
                           "shot 1 at 1 late 20 ms",
                           "shot 1 at 1 late -2s",
                           "shot 1 at 1 late nans",
                           "shot 1 at 1 late 1e9s",
                           "time 2 drop 1s",
                           "time 2s drop",
                           "time s drop 1s",
                           "shot 1 at 1 timeout 5"}) {
    try {
      parse(std::string("shot 1 at 1 overflow\n\n") + line + "\n");
      ADD_FAILURE() << "taken: " << line;
    } catch (const InputError& error) {
      EXPECT_EQ(error.place(), "faults.txt:3") << line;
      EXPECT_FALSE(error.mend().empty());
    }
  }
}

TEST(FaultQueue, GivesFaultsInTheOrderOfTheirTicks) {
  FaultQueue queue(parse("shot 2 at 10 lose 5\ntime 1ms overflow\nshot 2 at 0 timeout\n"),
                   {1'000'000, 1});
  queue.shot_fired(1, 100);
  EXPECT_FALSE(queue.take_before(1000));
  EXPECT_EQ(queue.take_before(1001)->fault.kind, FaultKind::overflow);
  queue.shot_fired(2, 5000);
  EXPECT_FALSE(queue.take_before(5000));
  EXPECT_EQ(queue.take_before(6000)->tick, 5000);
  EXPECT_EQ(queue.take_before(6000)->tick, 5010);
  EXPECT_FALSE(queue.take_before(1'000'000));
  queue.shot_fired(2, 9000);
  EXPECT_FALSE(queue.take_before(1'000'000));
}

}  // namespace
}  // namespace kolsky
