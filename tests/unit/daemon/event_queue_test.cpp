#include "daemon/acquisition/event_queue.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace kolsky {
namespace {

TEST(EventQueue, KeepsOrderAndRefusesWhenFull) {
  EventQueue<int, 4> queue;
  for (int i = 0; i < 4; ++i) {
    EXPECT_TRUE(queue.push(i));
  }
  EXPECT_FALSE(queue.push(4));
  EXPECT_EQ(queue.size(), 4U);
  int item = -1;
  ASSERT_TRUE(queue.pop(item));
  EXPECT_EQ(item, 0);
  EXPECT_TRUE(queue.push(5));
  for (const int expected : {1, 2, 3, 5}) {
    ASSERT_TRUE(queue.pop(item));
    EXPECT_EQ(item, expected);
  }
  EXPECT_FALSE(queue.pop(item));
}

TEST(EventQueue, EndsOnceClosedAndEmpty) {
  EventQueue<int, 4> queue;
  queue.push(7);
  queue.close();
  int item = 0;
  EXPECT_TRUE(queue.pop_wait(item));
  EXPECT_EQ(item, 7);
  EXPECT_FALSE(queue.pop_wait(item));
}

TEST(EventQueue, WakesAWaitingConsumer) {
  EventQueue<int, 4> queue;
  int got = 0;
  bool more = true;
  std::thread consumer([&] {
    static_cast<void>(queue.pop_wait(got));
    int item = 0;
    more = queue.pop_wait(item);
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  queue.push(3);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  queue.close();
  consumer.join();
  EXPECT_EQ(got, 3);
  EXPECT_FALSE(more);
}

TEST(EventQueue, LosesAndRepeatsNothingBetweenTwoThreads) {
  constexpr int kItems = 200'000;
  EventQueue<int, 64> queue;
  std::int64_t sum = 0;
  bool in_order = true;
  std::thread consumer([&] {
    int last = 0;
    int item = 0;
    while (queue.pop_wait(item)) {
      in_order = in_order && item == last + 1;
      last = item;
      sum += item;
    }
  });
  for (int i = 1; i <= kItems; ++i) {
    while (!queue.push(i)) {
      std::this_thread::yield();
    }
  }
  queue.close();
  consumer.join();
  EXPECT_TRUE(in_order);
  EXPECT_EQ(sum, std::int64_t{kItems} * (kItems + 1) / 2);
}

}  // namespace
}  // namespace kolsky
