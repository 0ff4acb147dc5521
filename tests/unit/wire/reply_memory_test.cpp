#include "daemon/publish/reply_memory.hpp"

#include <gtest/gtest.h>

namespace kolsky {
namespace {

RequestKey key(int number) {
  return {"ann@lab", std::to_string(number)};
}

void answer(ReplyMemory& memory, int number, const std::string& reply) {
  memory.begin(key(number), "command", {"peer"});
  static_cast<void>(memory.finish(key(number), reply));
}

TEST(ReplyMemory, ForgetsTheOldestFirst) {
  ReplyMemory memory(3, 1'000'000);
  for (int i = 0; i < 5; ++i) {
    answer(memory, i, "reply " + std::to_string(i));
  }
  EXPECT_EQ(memory.find(key(0)), nullptr);
  EXPECT_EQ(memory.find(key(1)), nullptr);
  for (int i = 2; i < 5; ++i) {
    ASSERT_NE(memory.find(key(i)), nullptr) << i;
    EXPECT_EQ(memory.find(key(i))->reply, "reply " + std::to_string(i));
  }
}

TEST(ReplyMemory, NeverForgetsWhatIsUnderWay) {
  ReplyMemory memory(2, 1'000'000);
  memory.begin(key(-1), "slow", {"peer"});
  for (int i = 0; i < 10; ++i) {
    answer(memory, i, "reply");
  }
  ASSERT_NE(memory.find(key(-1)), nullptr);
  EXPECT_FALSE(memory.find(key(-1))->finished);
  memory.find(key(-1))->waiting.push_back({"second peer", ""});
  const std::vector<Route> waiting = memory.finish(key(-1), "done");
  EXPECT_EQ(waiting, (std::vector<Route>{{"peer"}, {"second peer", ""}}));
  EXPECT_TRUE(memory.find(key(-1))->finished);
  EXPECT_TRUE(memory.find(key(-1))->waiting.empty());
}

TEST(ReplyMemory, HoldsNoMoreBytesThanItMay) {
  ReplyMemory memory(1000, 100);
  answer(memory, 1, std::string(60, 'x'));
  answer(memory, 2, std::string(40, 'x'));
  EXPECT_NE(memory.find(key(1)), nullptr);
  answer(memory, 3, "x");
  EXPECT_EQ(memory.find(key(1)), nullptr);
  EXPECT_NE(memory.find(key(2)), nullptr);
  answer(memory, 4, std::string(101, 'x'));  // too big to be remembered at all
  EXPECT_EQ(memory.find(key(4)), nullptr);
  answer(memory, 5, std::string(100, 'x'));
  EXPECT_NE(memory.find(key(5)), nullptr);
}

TEST(ReplyMemory, ClientsIdsAreTheirOwn) {
  ReplyMemory memory(10, 1000);
  answer(memory, 1, "ann's");
  EXPECT_EQ(memory.find({"ben@office", "1"}), nullptr);
}

}  // namespace
}  // namespace kolsky
