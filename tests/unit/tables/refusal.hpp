#pragma once

#include <gtest/gtest.h>

#include <string>

#include "processing/base/error.hpp"

namespace kolsky::testing {

/// The whole line of the InputError that `run` throws; fails the test if it throws none.
template <typename Run>
std::string refusal_of(Run run) {
  try {
    run();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "is not one line";
    EXPECT_FALSE(error.mend().empty()) << "says no mend";
    return error.what();
  }
  ADD_FAILURE() << "nothing was refused";
  return "";
}

}  // namespace kolsky::testing
