// A misfiled bench, from tables to the corrected file, as a person mends it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <iterator>

#include "drivers/files/settings/bench_file.hpp"
#include "tests/end_to_end/cli/kolsky.hpp"
#include "tests/generators/bar_shots.hpp"
#include "tests/scratch_folder.hpp"

namespace kolsky {
namespace {

using nlohmann::json;
using scene::json_of;
using scene::refused;

/// Four gauges, of which g3 is filed 5 mm from where it is and g2 with 3 % less gain than it has.
class Calibrate : public ::testing::Test {
 protected:
  Calibrate() {
    std::string bench =
        "kind = \"bar\"\nsampling_frequency_Hz = 1e6\npositive = \"compression\"\n"
        "# measured with a tape\n[bars.input]\nlength_m = 2.0\ndiameter_m = 0.02\n"
        "density_kg_m3 = 1180.0\npoisson_ratio = 0.36\n";
    for (int j = 0; j < 4; ++j) {
      const double off_m = j == 2 ? -0.005 : 0.0;
      const double gain = j == 1 ? 1.03 : 1.0;
      bench += fmt::format(
          "[[gauges]]\nname = \"g{}\"\nbar = \"input\"\nposition_m = {}\nposition_m_sd = 0.0002\n"
          "unit = \"V\"\nstrain_per_V = {}\nstrain_per_V_sd = 0.000002\n",
          j + 1, 0.1 + 0.2 * j + off_m, 0.001 * gain);
    }
    folder_.write("bench.toml", bench);
    std::mt19937_64 random(3);
    int number = 0;
    testing::BarShots::Setup setup;
    setup.material = RodMaterial{1180.0, 5.66e9, 37.0e9, 1.81e6};
    for (const Shot& shot : testing::BarShots(setup).draw(3, {}, random)) {
      std::string table = "time_s,g1,g2,g3,g4\n";
      for (std::size_t n = 0; n < shot.samples(); ++n) {
        table += fmt::format("{:.7f}", static_cast<double>(n) * 1e-6);
        for (const ChannelRecord& channel : shot.channels) {
          table += fmt::format(",{:.7e}", channel.value(channel.codes[n]));
        }
        table += "\n";
      }
      const std::string name = fmt::format("shot{}", ++number);
      folder_.write(name + ".csv", table);
      captures_.push_back((folder_ / (name + ".h5")).string());
      (void)json_of(scene::kolsky({"import", "csv", (folder_ / (name + ".csv")).string(), "--bench",
                                   folder_ / "bench.toml", "-o", captures_.back(), "--json"}));
    }
  }

  [[nodiscard]] std::vector<std::string> words(const std::vector<std::string>& more) const {
    std::vector<std::string> list = {"calibrate"};
    list.insert(list.end(), captures_.begin(), captures_.end());
    list.insert(list.end(), more.begin(), more.end());
    return list;
  }

  testing::ScratchFolder folder_;
  std::vector<std::string> captures_;
};

TEST_F(Calibrate, NamesWhatDiffersAndMendsTheBenchFile) {
  const std::string mended = (folder_ / "mended.toml").string();
  const json found = json_of(scene::kolsky(words({"--bench-out", mended, "--json"})));
  EXPECT_EQ(found["certificate"], "fail");
  EXPECT_EQ(found["differs"], (json{"gauge-factor:g2", "gauge-position:g3"}));
  const BenchFile file = read_bench(mended);
  EXPECT_NEAR(file.bench.gauges[2].position_m, 0.5, 4.0 * file.bench.gauges[2].position_m.sd);
  EXPECT_NEAR(*file.bench.gauges[1].strain_per_V, 0.001,
              4.0 * file.bench.gauges[1].strain_per_V->sd);
  EXPECT_NE(file.text.find("# measured with a tape"), std::string::npos);
  // Held against the mended file, the same shots pass.
  const json again = json_of(scene::kolsky(words({"--bench", mended, "--json"})));
  EXPECT_EQ(again["certificate"], "pass");
  EXPECT_TRUE(refused(scene::kolsky(words({"--bench-out", mended})), {"mended.toml"}));
}

// Of the simulated bar g3 is recorded late, by what the tour tells afterwards.
TEST(CalibrateLateChannel, FilesTheDelay) {
  testing::ScratchFolder folder;
  ASSERT_EQ(
      scene::kolsky({"tour", "--seed", "3", "--quick", "--shots-only", "--folder", folder / "c"})
          .code,
      0);
  std::vector<std::string> words = {"calibrate"};
  for (const char* shot : {"shot01", "shot02", "shot03", "shot04"}) {
    words.push_back(folder / (std::string(shot) + ".h5"));
    (void)json_of(
        scene::kolsky({"import", "csv", folder / ("c/" + std::string(shot) + ".csv"), "--bench",
                       folder / "c/bench.toml", "-o", words.back(), "--json"}));
  }
  const std::string mended = folder / "mended.toml";
  words.insert(words.end(), {"--bench-out", mended, "--json"});
  EXPECT_EQ(json_of(scene::kolsky(words))["differs"], json{"channel-delay:g3"});
  const json truth =
      json_of(scene::kolsky({"tour", "--seed", "3", "--quick", "--truth-only", "--json"}));
  const Measured delay_s = read_bench(mended).bench.gauges[2].delay_s;
  EXPECT_GT(delay_s.sd, 0.0);
  EXPECT_NEAR(delay_s, truth["truth"]["strength"].get<double>(), 4.0 * delay_s.sd);
}

TEST_F(Calibrate, RefusesInOneLine) {
  EXPECT_TRUE(refused(scene::kolsky(words({"--trust", "g9"})), {" more: gauge g9"}));
  EXPECT_TRUE(refused(scene::kolsky(words({"--bench", "none.toml"})), {"none.toml"}));
  EXPECT_TRUE(refused(scene::kolsky({"calibrate"}), {"CAPTURE"}));
}

}  // namespace
}  // namespace kolsky
