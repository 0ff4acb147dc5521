#include "daemon/thread.hpp"

#include <gtest/gtest.h>
#include <pthread.h>

#include <cstdlib>
#include <stdexcept>
#include <string>

#include "daemon/log.hpp"

namespace kolsky {
namespace {

TEST(Thread, WorksUnderItsName) {
  std::string name(16, '\0');
  Thread thread("kolsky-abcdefgh", [&] {
    ASSERT_EQ(pthread_getname_np(pthread_self(), name.data(), name.size()), 0);
  });
  thread.join();
  EXPECT_STREQ(name.c_str(), "kolsky-abcdefgh");
}

TEST(Thread, IsWaitedForOnceAndNoneIsNoError) {
  int done = 0;
  Thread thread;
  thread.join();
  thread = Thread("kolsky-once", [&] { ++done; });
  thread.join();
  thread.join();
  EXPECT_EQ(done, 1);
}

TEST(ThreadDeathTest, WhatEscapesIsSaidUnderItsNameAndEndsTheProcess) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(
      {
        log::start(log::Level::quiet);
        Thread thread("kolsky-falls", [] { throw std::runtime_error("out of ideas"); });
        thread.join();
        std::_Exit(0);
      },
      testing::ExitedWithCode(EXIT_FAILURE), "kolsky-falls: out of ideas; ending");
}

}  // namespace
}  // namespace kolsky
