#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "processing/base/error.hpp"
#include "processing/base/shot.hpp"

namespace kolsky::testing {

/// A bar bench with gauges g1, g2, ..., as text.
[[nodiscard]] std::string bench_text(std::size_t gauges);

struct ShotShape {
  std::size_t channels = 2;
  std::size_t samples = 500;
  int bits = 16;
};

/// A shot with every field set, all of it following from the seed.
[[nodiscard]] Shot make_shot(std::uint32_t seed, const ShotShape& shape = {});

/// A bar of two Kelvin branches, identified, with a covariance.
[[nodiscard]] Material two_kelvin_bar();

/// A shot that asks for every kind of reduction.
[[nodiscard]] Shot asked_shot();

/// A shot in golden/, with numbers written out and not drawn, and what its files are called there.
struct GoldenShot {
  std::string name;
  std::uint32_t version;  ///< that it is encoded in
  Shot shot;
};
inline void PrintTo(const GoldenShot& golden, std::ostream* out) {
  *out << golden.name;
}
/// One of each version: as usual, with an identified bar model, with a reduction asked for, with a
/// bar of another family than three elements.
[[nodiscard]] std::vector<GoldenShot> make_golden_shots();

/// Every field but the parsed bench, bit for bit.
void expect_same(const Shot& actual, const Shot& expected);

[[nodiscard]] std::vector<std::byte> bytes_of(const std::filesystem::path& path);
void write_bytes(const std::filesystem::path& path, const std::vector<std::byte>& bytes);

/// Expects an InputError whose message holds all the parts. @return the message
template <typename Action>
std::string expect_refused(const Action& action, const std::vector<std::string>& parts = {}) {
  try {
    action();
  } catch (const InputError& error) {
    std::string message = error.what();
    for (const std::string& part : parts) {
      EXPECT_NE(message.find(part), std::string::npos) << message << "\nlacks: " << part;
    }
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message;
  }
  ADD_FAILURE() << "nothing was refused";
  return {};
}

}  // namespace kolsky::testing
