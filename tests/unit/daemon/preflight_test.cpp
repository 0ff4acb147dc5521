#include "daemon/live/preflight.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "drivers/files/settings/bench_file.hpp"
#include "tests/unit/daemon/strain_bench.hpp"

namespace kolsky {
namespace {

/// All is well: 1 mV and 0.1 microstrain per code.
struct Case {
  PreflightFacts facts;
  Shot blank;

  Case() {
    blank.bench = parse_bench(kStrainBench, "bench.toml");
    blank.bench.gauges[0].unit = "V";
    blank.bench.gauges[0].strain_per_V = Measured{4e-4};
    blank.channels.resize(2);
    blank.channels[0].gauge = "g1";
    blank.channels[0].unit = "V";
    blank.channels[0].scale = 1e-3;
    blank.channels[1].gauge = "g2";
    blank.channels[1].unit = "strain";
    blank.channels[1].scale = 1e-7;
    facts.connected = true;
    facts.streaming = true;
    facts.disk_free_bytes = std::uint64_t{10} << 30;
    facts.window_samples = 4000;
    facts.shot_bytes = 16'000;
    facts.block_samples = 1024;
    facts.ring_samples = 100'000;
    facts.channels.assign(2, {.baseline_codes = 100.0, .noise_codes = 20.0, .learned = true});
  }
  [[nodiscard]] std::vector<PreflightItem> run() const { return preflight(facts, blank); }
};

TEST(Preflight, PassesWhereAllIsWell) {
  const std::vector<PreflightItem> items = Case().run();
  EXPECT_TRUE(passed(items)) << failures(items);
  EXPECT_EQ(failures(items), "");
  EXPECT_EQ(items.size(), 3U + 2U * 3U);
}

TEST(Preflight, AsksTheSignalsOnlyWhereThereAreAny) {
  Case replay;
  replay.facts.streaming = false;
  replay.facts.channels.assign(2, {});
  EXPECT_TRUE(passed(replay.run())) << failures(replay.run());
}

struct Fault {
  const char* item;
  const char* said;
  std::function<void(Case&)> make;
};

class PreflightFault : public testing::TestWithParam<Fault> {};

TEST_P(PreflightFault, IsFoundByItsOwnItemAlone) {
  Case faulty;
  GetParam().make(faulty);
  const std::vector<PreflightItem> items = faulty.run();
  for (const PreflightItem& item : items) {
    EXPECT_EQ(item.ok, item.name != GetParam().item) << item.name << ": " << item.text;
  }
  EXPECT_FALSE(passed(items));
  EXPECT_NE(failures(items).find(GetParam().said), std::string::npos) << failures(items);
}

INSTANTIATE_TEST_SUITE_P(
    All, PreflightFault,
    testing::Values(
        Fault{"connection", "disconnected", [](Case& c) { c.facts.connected = false; }},
        Fault{"connection", "replay is over", [](Case& c) { c.facts.ended = true; }},
        Fault{"disk", "1 MiB free", [](Case& c) { c.facts.disk_free_bytes = 1 << 20; }},
        Fault{"ring", "ring.seconds", [](Case& c) { c.facts.ring_samples = 10'000; }},
        Fault{"bridge-balance g1", "balance the bridge",
              [](Case& c) { c.facts.channels[0].baseline_codes = 30'000.0; }},
        Fault{"bridge-balance g2", "balance the bridge",
              [](Case& c) { c.facts.channels[1].baseline_codes = -20'000.0; }},
        Fault{"noise g1", "not known yet", [](Case& c) { c.facts.channels[0].learned = false; }},
        Fault{"noise g2", "the input is dead",
              [](Case& c) { c.facts.channels[1].constant_samples = 1'000'000; }},
        Fault{"noise g2", "too loud", [](Case& c) { c.facts.channels[1].noise_codes = 10'000.0; }},
        Fault{"calibration g1", "check gauge factor",
              [](Case& c) { c.blank.channels[0].scale = 1e-9; }},
        Fault{"calibration g2", "check gauge factor",
              [](Case& c) { c.blank.channels[1].scale = 0.1; }}));

}  // namespace
}  // namespace kolsky
