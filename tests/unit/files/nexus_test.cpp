#include <array>
#include <cstdio>
#include <map>
#include <numeric>
#include <sstream>

#include "drivers/files/captures/capture.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/unit/files/stored_shots.hpp"

namespace kolsky {
namespace {

using testing::make_shot;
using testing::ScratchFolder;

constexpr const char* kPython = "/usr/bin/python3";

struct Outcome {
  int status = 0;
  std::string output;
};

Outcome run(const std::string& command) {
  Outcome outcome;
  FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  std::array<char, 4096> chunk{};
  for (std::size_t count = 0; (count = std::fread(chunk.data(), 1, chunk.size(), pipe)) > 0;) {
    outcome.output.append(chunk.data(), count);
  }
  outcome.status = ::pclose(pipe);
  return outcome;
}

std::map<std::string, std::string> facts_of(const std::string& output) {
  std::map<std::string, std::string> facts;
  std::istringstream lines(output);
  for (std::string line; std::getline(lines, line);) {
    const auto sign = line.find('=');
    facts[line.substr(0, sign)] = line.substr(sign + 1);
  }
  return facts;
}

std::string sum_of(const std::vector<std::int32_t>& codes) {
  return std::to_string(std::accumulate(codes.begin(), codes.end(), std::int64_t{0}));
}

class Nexus : public ::testing::TestWithParam<int> {};

// Another program, another language, another HDF5 binding: what the format's description says is
// enough.
TEST_P(Nexus, AnotherReaderFindsEverythingWhereItIsSaidToBe) {
  if (run(std::string(kPython) + " -c 'import h5py, tomllib'").status != 0) {
    GTEST_SKIP() << "no h5py under " << kPython;
  }
  const ScratchFolder folder;
  const Shot shot = make_shot(1, {3, 401, GetParam()});
  write_capture(shot, folder / "a.h5");
  const auto outcome =
      run(std::string(kPython) + " " KOLSKY_SOURCE_DIR "/tests/unit/files/read_capture.py " +
          (folder / "a.h5").string());
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  auto facts = facts_of(outcome.output);
  EXPECT_EQ(facts["root.NX_class"], "NXroot");
  EXPECT_EQ(facts["entry.NX_class"], "NXentry");
  EXPECT_EQ(facts["plot.NX_class"], "NXdata");
  EXPECT_EQ(facts["raw.NX_class"], "NXcollection");
  EXPECT_EQ(facts["shot.NX_class"], "NXcollection");
  EXPECT_EQ(facts["creator"], "Kolsky 0.1.0 (β)");
  EXPECT_EQ(facts["title"], "shot-1");
  // `date -u -d @1709210096`: 29 February 2024
  EXPECT_EQ(facts["start_time"], "2024-02-29T12:34:56.123456790Z");
  EXPECT_EQ(facts["signal"], "g1");
  EXPECT_EQ(facts["auxiliary_signals"], "g2,g3");
  EXPECT_EQ(facts["axes"], "time");
  EXPECT_EQ(facts["time.units"], "s");
  // Rate 1e6/3 per second, trigger 40.1 samples after sample 0.
  EXPECT_NEAR(std::strtod(facts["time.first"].c_str(), nullptr), -40.1 * 3e-6, 1e-18);
  EXPECT_NEAR(std::strtod(facts["time.last"].c_str(), nullptr), (400 - 40.1) * 3e-6, 1e-17);
  for (const ChannelRecord& channel : shot.channels) {
    EXPECT_EQ(facts[channel.gauge + ".dtype"], GetParam() <= 16 ? "<i2" : "<i4");
    EXPECT_EQ(facts[channel.gauge + ".units"], "strain");
    EXPECT_EQ(facts[channel.gauge + ".long_name"], "gauge " + channel.gauge);
    EXPECT_EQ(facts[channel.gauge + ".codes_sum"], sum_of(channel.codes));
    EXPECT_EQ(facts[channel.gauge + ".digest_right"], "True");
    EXPECT_EQ(facts[channel.gauge + ".values_right"], "True");
  }
  EXPECT_EQ(facts["metadata_digest_right"], "True");
  EXPECT_EQ(facts["seal_right"], "True");
}

INSTANTIATE_TEST_SUITE_P(Bits, Nexus, ::testing::Values(16, 24));

// What the page says of an encoded shot holds for each of its versions.
TEST(NexusTools, AnotherReaderKnowsEveryVersion) {
  if (run(std::string(kPython) + " -c 'import h5py, tomllib'").status != 0) {
    GTEST_SKIP() << "no h5py under " << kPython;
  }
  for (const testing::GoldenShot& golden : testing::make_golden_shots()) {
    const auto outcome =
        run(std::string(kPython) + " " KOLSKY_SOURCE_DIR "/tests/unit/files/read_capture.py " +
            KOLSKY_SOURCE_DIR "/tests/unit/files/golden/" + golden.name + ".h5");
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    auto facts = facts_of(outcome.output);
    EXPECT_EQ(facts["title"], golden.shot.id);
    EXPECT_EQ(facts["metadata_digest_right"], "True") << golden.name;
    EXPECT_EQ(facts["seal_right"], "True") << golden.name;
  }
}

TEST(NexusTools, H5dumpReadsACapture) {
  if (run("command -v h5dump").status != 0) {
    GTEST_SKIP() << "no h5dump";
  }
  const ScratchFolder folder;
  write_capture(make_shot(2, {2, 5}), folder / "a.h5");
  const auto outcome = run("h5dump -d /entry/gauges/g1 " + (folder / "a.h5").string());
  EXPECT_EQ(outcome.status, 0);
  EXPECT_NE(outcome.output.find("H5T_IEEE_F64LE"), std::string::npos) << outcome.output;
  EXPECT_NE(outcome.output.find("( 5 )"), std::string::npos) << outcome.output;
}

}  // namespace
}  // namespace kolsky
