// A folder of imported tables through the daemon: what a laboratory does with the records it has.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>

#include "daemon/daemon.hpp"
#include "tests/end_to_end/cli/kolsky.hpp"

namespace kolsky {
namespace {

using nlohmann::json;
using scene::json_of;
using scene::kolsky;

constexpr double kShares[] = {1.0, 0.04, 0.002};  // of a pulse of some hundred microstrain

class ImportedFolder : public ::testing::Test {
 protected:
  ImportedFolder() {
    std::filesystem::create_directory(bench_.file("captures"));
    for (std::size_t i = 0; i < std::size(kShares); ++i) {
      const std::string name = "shot" + std::to_string(i + 1);
      bench_.write(name + ".csv", bench_.table(kShares[i], 1e-8, static_cast<unsigned>(i)));
      captures_.push_back(bench_.file("captures/" + name + ".h5"));
      const scene::Answer imported = kolsky({"import", "csv", bench_.file(name + ".csv"), "--bench",
                                             bench_.file("bench.toml"), "-o", captures_.back()});
      EXPECT_EQ(imported.code, 0) << imported.err;
    }
  }

  void prepare() {
    std::ifstream bench(bench_.file("bench.toml"));
    setup_.emplace("replay:" + bench_.file("captures"),
                   std::string(std::istreambuf_iterator<char>(bench), {}));
    // Windows as long as the records: what the daemon stores is then the whole of each.
    const std::size_t samples = bench_.records().input_strain.size();
    for (const char* side : {"pre_samples = ", "post_samples = "}) {
      setup_->set("trigger", side + std::to_string(samples));
    }
  }

  scene::Bench bench_;
  std::vector<std::string> captures_;
  std::optional<scene::Installation> setup_;
};

TEST_F(ImportedFolder, OfVeryDifferentAmplitudesReplaysToTheResultsOfReduce) {
  prepare();
  Daemon daemon(setup_->read());
  daemon.start();
  ASSERT_TRUE(scene::eventually([&] { return daemon.finished(); }));
  const std::vector<std::string> at{"--endpoint", daemon.endpoints().control, "--json"};
  const auto ask = [&](std::vector<std::string> words) {
    words.insert(words.end(), at.begin(), at.end());
    return json_of(kolsky(words));
  };
  json shots = ask({"shots"})["shots"];
  ASSERT_EQ(shots.size(), std::size(kShares));
  std::reverse(shots.begin(), shots.end());  // the latest came first
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const json stored =
        json_of(kolsky({"reduce", shots[i]["capture"].get<std::string>(), "--json"}));
    const json result = ask({"get", shots[i]["id"].get<std::string>()});
    const json imported = json_of(kolsky({"reduce", captures_[i], "--json"}));
    ASSERT_FALSE(imported["stress_Pa"].empty());
    for (const char* history : {"stress_Pa", "strain", "strain_rate_per_s", "force_front_N"}) {
      EXPECT_EQ(result[history], stored[history]) << history << " of shot " << i + 1;
      EXPECT_EQ(result[history], imported[history]) << history << " of shot " << i + 1;
    }
  }
}

}  // namespace
}  // namespace kolsky
