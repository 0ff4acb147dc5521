// `kolsky dispersion`: how waves travel in a bench's bar, as a table, a plot and JSON.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "tests/end_to_end/cli/kolsky.hpp"
#include "tests/scratch_folder.hpp"

namespace kolsky {
namespace {

using nlohmann::json;

const std::string kBenches = std::string(KOLSKY_SOURCE_DIR) + "/docs/benches/";

json table_of(const std::vector<std::string>& more) {
  std::vector<std::string> words{"dispersion", "--bench", kBenches + "paper-bar.toml",
                                 "--to",       "40e3",    "--points",
                                 "40",         "--json"};
  words.insert(words.end(), more.begin(), more.end());
  return scene::json_of(scene::kolsky(words));
}

struct Checked {
  std::string theory;
  std::size_t kHz;
  double alpha_per_m, speed_m_per_s;
};

/// The paper's PMMA, 20 mm: values checked in high precision outside the project (physics.md).
class Dispersion : public ::testing::TestWithParam<Checked> {};

TEST_P(Dispersion, TabulatesWavesToTheDigitsThatAreKnown) {
  const Checked& checked = GetParam();
  const json table = table_of({"--dispersion", checked.theory});
  const std::size_t row = checked.kHz - 1;
  EXPECT_NEAR(table["frequency_Hz"][row].get<double>(), 1e3 * static_cast<double>(checked.kHz),
              1e-6);
  EXPECT_NEAR(table["alpha_per_m"][row].get<double>(), checked.alpha_per_m, 5e-6);
  EXPECT_NEAR(table["phase_speed_m_per_s"][row].get<double>(), checked.speed_m_per_s, 5e-3);
}

INSTANTIATE_TEST_SUITE_P(Pmma, Dispersion,
                         ::testing::Values(Checked{"elementary", 20, 0.69408, 2185.65},
                                           Checked{"love", 40, 0.81044, 2093.41},
                                           Checked{"exact", 20, 0.71924, 2160.79},
                                           Checked{"exact", 40, 0.86723, 2066.61}));

TEST(DispersionFiles, HoldTheWholeTableAndThePlots) {
  const testing::ScratchFolder folder;
  const scene::Answer text =
      scene::kolsky({"dispersion", "--bench", kBenches + "paper-shpb.toml", "--bar", "output",
                     "--csv", folder / "waves.csv", "--svg", folder / "waves.svg"});
  ASSERT_EQ(text.code, 0) << text.err;
  EXPECT_NE(text.out.find("phase speed"), std::string::npos);
  EXPECT_NE(text.out.find("assumed because no bar model was given"), std::string::npos);
  std::ifstream file(folder / "waves.csv");
  std::string line;
  std::getline(file, line);
  EXPECT_TRUE(line.starts_with("frequency_Hz,phase_speed_m_per_s,alpha_per_m,")) << line;
  std::size_t rows = 0;
  while (std::getline(file, line)) {
    ++rows;
  }
  EXPECT_EQ(rows, 120U);
  EXPECT_TRUE(std::filesystem::exists(folder / "waves.svg"));
}

TEST(DispersionFiles, RefuseWhatCannotBeTabulated) {
  const std::string bench = kBenches + "paper-bar.toml";
  using scene::kolsky;
  using scene::refused;
  EXPECT_TRUE(refused(kolsky({"dispersion", "--bench", bench, "--bar", "output"}),
                      {"--bar", "give input: there is no other"}));
  EXPECT_TRUE(refused(kolsky({"dispersion", "--bench", bench, "--to", "-1"}), {"--to", "0 Hz"}));
  EXPECT_TRUE(
      refused(kolsky({"dispersion", "--bench", bench, "--points", "2"}), {"--points", "or more"}));
  EXPECT_TRUE(refused(kolsky({"dispersion"}), {"--bench is missing"}));
}

// Beyond the band in which a bar was identified nobody knows how its waves go.
TEST(DispersionFiles, EndWhereTheBarModelDoes) {
  const testing::ScratchFolder folder;
  folder.write("pmma.toml",
               "density_kg_m3 = 1180.0\npoisson_ratio = 0.36\nE1_Pa = 5.66e9\nE2_Pa = 37.0e9\n"
               "eta2_Pa_s = 1.81e6\n[identified]\nband_limit_Hz = 8e3\n");
  const std::vector<std::string> words{"dispersion", "--bench", kBenches + "paper-bar.toml",
                                       "--bar-model", folder / "pmma.toml"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), words.begin(), words.end());
    return scene::kolsky(more);
  };
  EXPECT_NEAR(scene::json_of(with({"--json"}))["frequency_Hz"].back().get<double>(), 8e3, 1e-6);
  EXPECT_EQ(with({"--to", "7e3"}).code, 0);
  EXPECT_TRUE(scene::refused(with({"--to", "9e3"}), {"identified up to 8000 Hz", "no more"}));
}

}  // namespace
}  // namespace kolsky
