#include "daemon/config.hpp"

#include <gtest/gtest.h>

#include <unistd.h>

#include "daemon/check_report.hpp"
#include "processing/base/error.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/unit/daemon/strain_bench.hpp"

namespace kolsky {
namespace {

constexpr const char* kLeast = R"(bench = "bench.toml"
[digitiser]
uri = "ip:127.0.0.1:30431"
[trigger]
channel = "g1"
[store]
folder = "store"
)";

class ConfigTest : public ::testing::Test {
 protected:
  void SetUp() override { write("bench.toml", kStrainBench); }

  void write(const std::string& name, const std::string& text) const { folder_.write(name, text); }
  [[nodiscard]] DaemonConfig read(const std::string& text) const {
    write("kolskyd.toml", text);
    return read_config(folder_ / "kolskyd.toml");
  }
  /// The error's line; empty where there is none.
  [[nodiscard]] std::string error_of(const std::string& text) const {
    try {
      DaemonConfig config = read(text);
      static_cast<void>(read_apparatus(config));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  testing::ScratchFolder folder_;
};

::testing::AssertionResult holds(const std::string& text,
                                 std::initializer_list<const char*> parts) {
  for (const char* part : parts) {
    if (text.find(part) == std::string::npos) {
      return ::testing::AssertionFailure() << "no '" << part << "' in: " << text;
    }
  }
  return text.find('\n') == std::string::npos
             ? ::testing::AssertionSuccess()
             : ::testing::AssertionFailure() << "more than one line: " << text;
}

TEST_F(ConfigTest, TakesTheModelThatShotsAreComparedWith) {
  const std::string least = kLeast;
  EXPECT_FALSE(read(least).model);
  const DaemonConfig config = read(least + "[model]\nfile = \"m.toml\"\ngreen_chi2 = 2\n");
  EXPECT_EQ(config.model, folder_ / "m.toml");
  EXPECT_EQ(config.light.green_chi2, 2.0);
  EXPECT_EQ(config.light.amber_share, 1e-3);
  EXPECT_TRUE(holds(error_of(least + "[model]\n"), {"model.file"}));
  EXPECT_TRUE(
      holds(error_of(least + "[model]\nfile = \"m\"\ngreen_chi2 = 0.5\n"), {"model.green_chi2"}));
  EXPECT_TRUE(holds(error_of(least + "[model]\nfile = \"m\"\nlight = 1\n"), {"model.light"}));
}

TEST_F(ConfigTest, TakesHowShotsAreToBeReduced) {
  const std::string least = kLeast;
  EXPECT_FALSE(read(least).reduction.asks());
  EXPECT_FALSE(read(least + "[reduction]\n").reduction.asks());
  const std::string all =
      "[reduction]\ndispersion = \"exact\"\nseparate = \"never\"\nstress = \"one-wave\"\n"
      "inertia = \"none\"\nfriction = 0.1\nband_limit_Hz = 20e3\nduration_s = 4e-4\ntrue = true\n";
  const ReductionRequest asked = {.dispersion = "exact",
                                  .separate = "never",
                                  .stress = "one-wave",
                                  .inertia = "none",
                                  .friction = 0.1,
                                  .band_limit_Hz = 20e3,
                                  .duration_s = 4e-4,
                                  .with_true = true};
  EXPECT_EQ(read(least + all).reduction, asked);
  EXPECT_EQ(error_of(least + all), "");
}

TEST_F(ConfigTest, RefusesAReductionByKeyAndLine) {
  const auto refused = [&](const std::string& line, std::initializer_list<const char*> parts) {
    return holds(error_of(std::string(kLeast) + "[reduction]\n" + line + "\n"), parts);
  };
  EXPECT_TRUE(refused("dispersion = \"Rayleigh\"",
                      {"kolskyd.toml:9: reduction.dispersion", "elementary, love or exact"}));
  EXPECT_TRUE(refused("separate = \"hope\"", {"kolskyd.toml:9: reduction.separate",
                                              "auto, never, gauges or equilibrium"}));
  EXPECT_TRUE(refused("stress = \"four-wave\"",
                      {"kolskyd.toml:9: reduction.stress", "three-wave, one-wave or two-wave"}));
  EXPECT_TRUE(
      refused("inertia = \"all\"", {"kolskyd.toml:9: reduction.inertia", "axial, radial or both"}));
  EXPECT_TRUE(refused("friction = 2", {"kolskyd.toml:9: reduction.friction", "0 to 1"}));
  EXPECT_TRUE(refused("band_limit_Hz = 0", {"reduction.band_limit_Hz", "above 0 Hz"}));
  EXPECT_TRUE(refused("duration_s = -1", {"reduction.duration_s", "above 0 s"}));
  EXPECT_TRUE(refused("band_limit = 20e3", {"reduction.band_limit", "band_limit_Hz"}));
  EXPECT_TRUE(refused("true = 1", {"reduction.true"}));
  EXPECT_TRUE(refused("arrival_s = 4e-4", {"reduction.arrival_s", "one capture"}));
  EXPECT_TRUE(refused("uncertainty = true", {"reduction.uncertainty", "`kolsky reduce`"}));
}

TEST_F(ConfigTest, RefusesAReductionThatNoShotOfTheBenchCanHave) {
  const auto refused = [&](const std::string& line, std::initializer_list<const char*> parts) {
    return holds(error_of(std::string(kLeast) + "[reduction]\n" + line + "\n"), parts);
  };
  EXPECT_TRUE(refused("separate = \"gauges\"", {"reduction.separate", "one place", "equilibrium"}));
  EXPECT_TRUE(refused("inertia = \"axial\"", {"reduction.inertia", "specimen.density_kg_m3"}));
  EXPECT_TRUE(refused("band_limit_Hz = 600e3", {"reduction.band_limit_Hz", "half"}));
  EXPECT_TRUE(refused("dispersion = \"exact\"\nband_limit_Hz = 400e3",
                      {"reduction.band_limit_Hz", "mean strain"}));
  EXPECT_TRUE(refused("duration_s = 5e-3", {"reduction.duration_s", "window", "post_samples"}));

  write("bench.toml", R"(kind = "bar"
sampling_frequency_Hz = 1e6
[bars.input]
length_m = 2.0
diameter_m = 0.02
density_kg_m3 = 1180.0
poisson_ratio = 0.36
[[gauges]]
name = "g1"
bar = "input"
position_m = 0.5
unit = "strain"
)");
  EXPECT_TRUE(refused("dispersion = \"exact\"", {"kolskyd.toml: reduction", "\"bar\""}));
  EXPECT_EQ(error_of(std::string(kLeast) + "[reduction]\n"), "");

  write("bench.toml", R"(kind = "impact"
sampling_frequency_Hz = 1e6
[bars.input]
length_m = 3.0
diameter_m = 0.02
density_kg_m3 = 4500.0
poisson_ratio = 0.33
youngs_modulus_Pa = 113e9
[[gauges]]
name = "g1"
bar = "input"
position_m = 0.5
unit = "strain"
[ball]
outer_diameter_m = 0.0427
core_diameter_m = 0.038
)");
  EXPECT_TRUE(refused("stress = \"one-wave\"", {"reduction.stress", "a ball on an elastic bar"}));
  EXPECT_EQ(error_of(std::string(kLeast) + "[reduction]\ndispersion = \"exact\"\n"), "");
}

TEST_F(ConfigTest, RefusesABandThatTheBarModelDoesNotReach) {
  write("pmma.toml",
        "density_kg_m3 = 1180\npoisson_ratio = 0.36\nE1_Pa = 5.66e9\nE2_Pa = 37e9\n"
        "eta2_Pa_s = 1.81e6\n[identified]\nband_limit_Hz = 15e3\n");
  const std::string with_model = "bar_model = \"pmma.toml\"\n" + std::string(kLeast);
  EXPECT_TRUE(holds(error_of(with_model + "[reduction]\nband_limit_Hz = 20e3\n"),
                    {"reduction.band_limit_Hz", "15000 Hz"}));
  EXPECT_EQ(error_of(with_model + "[reduction]\nband_limit_Hz = 14e3\n"), "");
}

TEST_F(ConfigTest, TakesTheDefaultsWhereTheFileIsSilent) {
  const DaemonConfig config = read(kLeast);
  EXPECT_EQ(config.bench, folder_ / "bench.toml");
  EXPECT_EQ(config.store, folder_ / "store");
  EXPECT_EQ(config.endpoints.results, "tcp://127.0.0.1:5600");
  EXPECT_EQ(config.endpoints.preview, "tcp://127.0.0.1:5601");
  EXPECT_EQ(config.endpoints.control, "tcp://127.0.0.1:5602");
  EXPECT_EQ(config.journal_limit_bytes, 16 << 20);
  EXPECT_FALSE(config.auto_arm);
  EXPECT_FALSE(config.bar_model);
}

TEST_F(ConfigTest, TakesABarModelWithWhereItHoldsAndRefusesItElsewhere) {
  const std::string moduli =
      "poisson_ratio = 0.36\nE1_Pa = 5.0e9\nE2_Pa = 37e9\neta2_Pa_s = 1.8e6\n"
      "covariance = [4e10, 1e10, 0, 1e10, 9e16, 0, 0, 0, 1e8]\n[identified]\n"
      "band_limit_Hz = 6000\n";
  const std::string with_model = "bar_model = \"pmma.toml\"\n" + std::string(kLeast);
  write("bench.toml", "temperature_K = 293.0\n" + std::string(kStrainBench));
  write("pmma.toml", "density_kg_m3 = 1180\n" + moduli + "temperature_K = 294.0\n");
  DaemonConfig config = read(with_model);
  const Apparatus apparatus = read_apparatus(config);
  ASSERT_TRUE(apparatus.bar_model && apparatus.bar_model->covariance);
  EXPECT_EQ((*apparatus.bar_model->covariance)[1], 1e10);
  EXPECT_EQ(apparatus.bar_model->identified, (Material::Identified{6000.0, 294.0}));
  write("pmma.toml", "density_kg_m3 = 1180\n" + moduli + "temperature_K = 250.0\n");
  EXPECT_TRUE(holds(error_of(with_model), {"pmma.toml", "250.0 K", "293.0 K"}));
  write("pmma.toml", "density_kg_m3 = 2700\n" + moduli);
  EXPECT_TRUE(holds(error_of(with_model), {"pmma.toml", "2700 kg/m3"}));
}

TEST_F(ConfigTest, TakesEveryKey) {
  write("pmma.toml",
        "density_kg_m3 = 1180\npoisson_ratio = 0.36\nE1_Pa = 5.0e9\nE2_Pa = 37e9\n"
        "eta2_Pa_s = 1.8e6\n");
  DaemonConfig config = read(R"(bench = "bench.toml"
bar_model = "pmma.toml"
auto_arm = true
[digitiser]
uri = "replay:old"
channels = ["voltage0", "voltage3"]
device = "ad7606"
block_samples = 512
speed = 2
[trigger]
channel = "g2"
level_sigma = 9.5
hysteresis_share = 0.4
pre_samples = 100
post_samples = 900
hold_off_samples = 5000
learn_samples = 64
minimum_width_s = 6e-6
maximum_rise_s = 50e-6
[store]
folder = "/var/tmp/somewhere"
journal_limit_bytes = 1000000
[endpoints]
results = "ipc:///tmp/results"
[ring]
seconds = 0.5
[meta]
operator = "A. Person"
striker_speed_m_per_s = 12.5
)");
  const Apparatus apparatus = read_apparatus(config);
  EXPECT_EQ(config.digitiser.uri, "replay:" + (folder_ / "old").string());
  EXPECT_EQ(config.store, "/var/tmp/somewhere");
  EXPECT_EQ(config.journal_limit_bytes, 1'000'000);
  EXPECT_EQ(config.endpoints.results, "ipc:///tmp/results");
  EXPECT_EQ(config.meta.at("operator"), "A. Person");
  EXPECT_EQ(config.meta.at("striker_speed_m_per_s"), "12.5");
  EXPECT_EQ(apparatus.trigger_channel, 1U);
  ASSERT_TRUE(apparatus.bar_model);
  EXPECT_EQ(apparatus.bar_model->E1_Pa().value, 5.0e9);

  const TriggerOptions trigger = trigger_options(config.trigger, 2e6);
  EXPECT_EQ(trigger.level_sigma, 9.5);
  EXPECT_EQ(trigger.hysteresis_share, 0.4);
  EXPECT_EQ(trigger.minimum_width_samples, 12U);
  EXPECT_EQ(trigger.maximum_rise_samples, 100U);
  EXPECT_EQ(trigger.hold_off_samples, 5000U);
  EXPECT_EQ(trigger.learn_samples, 64U);

  const DigitiserOptions digitiser = digitiser_options(config, apparatus.bench);
  EXPECT_EQ(digitiser.channels, (std::vector<std::string>{"voltage0", "voltage3"}));
  EXPECT_EQ(digitiser.block_samples, 512U);
  EXPECT_EQ(digitiser.sampling_frequency_Hz, 1e6);
  EXPECT_EQ(digitiser.replay_speed, 2.0);
  EXPECT_EQ(ring_samples(config, 1e6, 512), 500'000U);
}

TEST_F(ConfigTest, KeepsEchoesInTheWindowOfTheirShot) {
  TriggerConfig trigger;
  trigger.post_samples = 10'000'000;
  EXPECT_GE(trigger_options(trigger, 1e6).hold_off_samples, 10'000'000U);
  trigger.hold_off_samples = 7;
  EXPECT_EQ(trigger_options(trigger, 1e6).hold_off_samples, 7U);
}

TEST_F(ConfigTest, BoundsTheRingOfAFastScope) {
  const DaemonConfig config = read(kLeast);
  EXPECT_EQ(ring_samples(config, 1e6, 1024), 2'000'000U);
  EXPECT_EQ(ring_samples(config, 1e6, 1024, 5'000'000), 5'002'048U);
  EXPECT_LE(ring_samples(config, 1e9, 1024), std::size_t{1} << 22);
}

TEST_F(ConfigTest, NamesTheNearestKeyForAnUnknownOne) {
  const std::string text = std::string(kLeast) + "[triger]\nchannel = \"g1\"\n";
  EXPECT_TRUE(holds(error_of(text), {"kolskyd.toml", "triger", "trigger"}));
  std::string misspelt = kLeast;
  misspelt.replace(misspelt.find("channel"), 7, "chanel");
  EXPECT_TRUE(holds(error_of(misspelt), {"kolskyd.toml:5", "chanel", "channel"}));
}

TEST_F(ConfigTest, RefusesWhatIsMissing) {
  EXPECT_TRUE(holds(error_of("[digitiser]\nuri = \"local:\"\n"), {"kolskyd.toml", "bench"}));
  std::string no_bench_file = kLeast;
  no_bench_file.replace(no_bench_file.find("bench.toml"), 10, "bank.toml\"");
  no_bench_file.replace(no_bench_file.find("bank.toml\"\""), 11, "bank.toml\"");
  EXPECT_TRUE(holds(error_of(no_bench_file), {"bank.toml"}));
}

TEST_F(ConfigTest, RefusesATriggerChannelThatIsNoGauge) {
  std::string text = kLeast;
  text.replace(text.find("g1"), 2, "g7");
  EXPECT_TRUE(holds(error_of(text), {"trigger.channel", "g7", "g1, g2"}));
}

TEST_F(ConfigTest, RefusesANumberOfChannelsThatIsNotThatOfGauges) {
  std::string text = kLeast;
  text.insert(text.find("[trigger]"), "channels = [\"voltage0\"]\n");
  EXPECT_TRUE(holds(error_of(text), {"digitiser.channels", "1 channels", "2 gauges"}));
}

struct BadValue {
  const char* where;
  const char* line;
  const char* named;
};

class BadValueTest : public ConfigTest, public ::testing::WithParamInterface<BadValue> {};

TEST_P(BadValueTest, IsRefusedWithItsPlace) {
  std::string text = kLeast;
  const std::string section = GetParam().where;
  const std::size_t at = text.find(section);
  if (at == std::string::npos) {
    text += section + "\n" + GetParam().line + "\n";
  } else {
    text.insert(at + section.size() + 1, std::string(GetParam().line) + "\n");
  }
  EXPECT_TRUE(holds(error_of(text), {"kolskyd.toml", GetParam().named}));
}

INSTANTIATE_TEST_SUITE_P(
    All, BadValueTest,
    ::testing::Values(
        BadValue{"[trigger]", "level_sigma = 0.5", "level_sigma"},
        BadValue{"[trigger]", "pre_samples = -1", "pre_samples"},
        BadValue{"[trigger]", "post_samples = 0", "post_samples"},
        BadValue{"[trigger]", "post_samples = 3.5", "post_samples"},
        BadValue{"[trigger]", "minimum_width_s = 3", "minimum_width_s"},
        BadValue{"[trigger]", "minimum_width_s = 1e-6\nmaximum_rise_s = nan", "maximum_rise_s"},
        BadValue{"[digitiser]", "block_samples = 1", "block_samples"},
        BadValue{"[digitiser]", "speed = -1", "speed"},
        BadValue{"[digitiser]", "channels = \"voltage0\"", "channels"},
        BadValue{"[ring]", "seconds = 0", "seconds"},
        BadValue{"[store]", "journal_limit_bytes = 100", "journal_limit_bytes"},
        BadValue{"[digitiser]", "channels = [\"voltage0\", \"voltage0\"]", "channels"},
        BadValue{"[endpoints]", "results = \"localhost:5600\"", "results"},
        BadValue{"[endpoints]", "results = \"tcp://127.0.0.1:99999\"", "results"},
        BadValue{"[endpoints]", "results = \"tcp://127.0.0.1\"", "results"},
        BadValue{"[endpoints]", "preview = \"tcp://127.0.0.1:5602\"", "control"},
        BadValue{"[meta]", "list = [1]", "list"},
        BadValue{"[meta]", "temperature_K = \"abc\"", "temperature_K"},
        BadValue{"[meta]", "temperature_K = 20", "temperature_K"},
        BadValue{"[meta]", "striker_speed_m_per_s = 1e6", "striker_speed_m_per_s"},
        BadValue{"[digitiser]", "speed = 2", "digitiser.speed"},
        BadValue{"[trigger]", "post_samples = 5000000", "post_samples"},
        BadValue{"[trigger]", "pre_samples = 2000000\npost_samples = 2000000", "post_samples"}));

TEST_F(ConfigTest, RefusesAFolderWithoutAName) {
  std::string text = kLeast;
  text.replace(text.find("\"store\""), 7, "\"\"");
  EXPECT_TRUE(holds(error_of(text), {"store.folder", "empty"}));
}

TEST_F(ConfigTest, RefusesAFolderThatIsAFile) {
  std::string text = kLeast;
  text.replace(text.find("\"store\""), 7, "\"/dev/null\"");
  EXPECT_TRUE(holds(error_of(text), {"store.folder", "/dev/null", "is a file"}));
}

TEST_F(ConfigTest, RefusesUrisThatNameNoDigitiser) {
  for (const std::string uri : {"ip:", "xml:foo.xml", "serial:", "http://lab"}) {
    std::string text = kLeast;
    text.replace(text.find("ip:127.0.0.1:30431"), 18, uri);
    EXPECT_TRUE(holds(error_of(text), {"digitiser.uri", uri.c_str(), "give"}));
  }
}

TEST_F(ConfigTest, RefusesAUriWithoutAScheme) {
  std::string text = kLeast;
  text.replace(text.find("ip:127.0.0.1:30431"), 18, "captures");
  EXPECT_TRUE(holds(error_of(text), {"digitiser.uri", "captures", "replay:"}));
}

// As long at any rate: a record at 12.5 MS/s is not cut to a third of a millisecond.
TEST_F(ConfigTest, AWindowThatIsNotGivenLastsAsLongAtAnyRate) {
  const auto window_at = [&](const std::string& rate, const std::string& given) {
    std::string bench = kStrainBench;
    const std::string key = "sampling_frequency_Hz = ";
    const std::size_t at = bench.find(key) + key.size();
    bench.replace(at, bench.find('\n', at) - at, rate);
    write("bench.toml", bench);
    std::string text = kLeast;
    text.insert(text.find("[trigger]") + 10, given);
    DaemonConfig config = read(text);
    static_cast<void>(read_apparatus(config));
    return std::pair(config.trigger.pre_samples, config.trigger.post_samples);
  };
  EXPECT_EQ(window_at("1e6", ""), std::pair(400L, 3600L));
  EXPECT_EQ(window_at("12.5e6", ""), std::pair(5000L, 45000L));
  EXPECT_EQ(window_at("125e6", ""), std::pair(50000L, 100000L));
  EXPECT_EQ(window_at("12.5e6", "pre_samples = 0\n"), std::pair(0L, 45000L));
}

TEST_F(ConfigTest, SaysWhatItWouldDo) {
  DaemonConfig config = read(kLeast);
  const Apparatus apparatus = read_apparatus(config);
  const std::string report = check_report(config, apparatus);
  for (const char* part : {"bench.toml", "g1", "g2", "ip:127.0.0.1:30431", "400 + 3600 samples",
                           "(0.4 + 3.6 ms)", "tcp://127.0.0.1:5602"}) {
    EXPECT_NE(report.find(part), std::string::npos) << part << " in\n" << report;
  }
}

}  // namespace
}  // namespace kolsky
