// Shots compared with a model as they come in, and diagnosed on request: a real daemon on a
// simulated digitiser, asked by the real program.
#include <gtest/gtest.h>

#include <fstream>
#include <thread>

#include "daemon/daemon.hpp"
#include "tests/end_to_end/cli/kolsky.hpp"
#include "tests/end_to_end/process.hpp"

namespace kolsky {
namespace {

using nlohmann::json;
using scene::Answer;
using scene::eventually;
using scene::json_of;
using scene::kolsky;
using scene::refused;

scene::LabOptions bar() {
  scene::LabOptions options;
  options.scenario = "bar";
  return options;
}

class LiveModel : public ::testing::Test {
 protected:
  LiveModel() : lab_(bar()), setup_(lab_.uri(), lab_.bench()) {
    setup_.folder().write("bar.toml", lab_.bench());
    model_ = setup_.folder() / "m.toml";
    EXPECT_EQ(kolsky({"model", "new", "--kind", "bar", "--bench", setup_.folder() / "bar.toml",
                      "-o", model_})
                  .code,
              0);
    daemon_ = std::make_unique<Daemon>(setup_.read());
    daemon_->start();
  }

  [[nodiscard]] Answer ask(const std::vector<std::string>& words) const {
    return kolsky(words, {"KOLSKY_ENDPOINT=" + daemon_->endpoints().control});
  }
  void arm() const {
    Answer answer;
    EXPECT_TRUE(eventually([&] {
      answer = ask({"arm"});
      return answer.code == 0;
    })) << answer.err;
  }
  /// Takes a shot. @return its capture
  [[nodiscard]] std::string shoot() const {
    arm();
    const std::string id = json_of(ask({"fire", "--wait", "10", "--json"}))["shot"];
    std::string capture;
    EXPECT_TRUE(eventually([&] {
      const json list = json_of(ask({"shots", "--json"}));
      for (const json& shot : list["shots"]) {
        if (shot["id"] == id) {
          capture = shot["capture"];
        }
      }
      return !capture.empty() && std::filesystem::exists(capture);
    }));
    return capture;
  }
  /// Fits the model to some shots and makes it the active one.
  void activate() {
    std::vector<std::string> fit{"fit", "--model", model_, "-o", model_};
    for (int n = 0; n < 3; ++n) {
      fit.push_back(shoot());
    }
    const Answer fitted = kolsky(fit);
    ASSERT_EQ(fitted.code, 0) << fitted.err;
    setup_.set("model", "file = \"m.toml\"");
    (void)setup_.write();
    ASSERT_EQ(ask({"disarm"}).code, 0);
    const Answer reloaded = ask({"reload"});
    ASSERT_EQ(reloaded.code, 0) << reloaded.err;
  }
  /// The last diagnosis once it is done. At the lowest priority it may have to wait long for a busy
  /// machine; asking without pause would keep it busy.
  [[nodiscard]] json ended_diagnosis() const {
    json live;
    EXPECT_TRUE(eventually(
        [&] {
          std::this_thread::sleep_for(std::chrono::milliseconds(500));
          live = json_of(ask({"diagnose-live", "--last", "--json"}));
          return live["state"] != "running";
        },
        std::chrono::minutes(4)));
    return live;
  }
  [[nodiscard]] json comparison_of(const std::string& id) const {
    json comparison;
    EXPECT_TRUE(eventually([&] {
      comparison = json_of(ask({"status", "--json"}))["comparison"];
      return comparison["shot"] == id;
    })) << comparison;
    return comparison;
  }

  scene::Lab lab_;
  scene::Installation setup_;
  std::string model_;
  std::unique_ptr<Daemon> daemon_;
};

std::string id_of(const std::string& capture) {
  return std::filesystem::path(capture).stem().string();
}

TEST_F(LiveModel, SaysOfAShotWhatCompareSaysOfItsCaptureToTheBit) {
  ASSERT_NO_FATAL_FAILURE(activate());
  std::vector<double> trend;
  for (int n = 0; n < 2; ++n) {
    const std::string capture = shoot();
    const json live = comparison_of(id_of(capture));
    const json file = json_of(kolsky({"compare", capture, "--model", model_, "--json"}));
    ASSERT_EQ(live["comparable"], true) << live;
    for (const char* number : {"chi2_reduced", "repeatable_share", "noise_floor_share"}) {
      EXPECT_EQ(live["misfit"][number].get<double>(), file["misfit"][number].get<double>())
          << number;
    }
    EXPECT_EQ(live["model"], model_);
    trend.push_back(live["misfit"]["chi2_reduced"]);
    EXPECT_EQ(live["trend"].get<std::vector<double>>(), trend);
    // The rule, worked out anew.
    const double chi2 = live["misfit"]["chi2_reduced"];
    const double excess = live["misfit"]["repeatable_share"];
    EXPECT_EQ(live["light"], chi2 <= 1.5 ? "green" : excess <= 1e-3 ? "amber" : "red");
    EXPECT_GT(live["duration_s"], 0.0);
  }
  EXPECT_NE(ask({"status"}).out.find("model: "), std::string::npos);
}

TEST_F(LiveModel, WatchHearsComparisonsOfTheirOwn) {
  ASSERT_NO_FATAL_FAILURE(activate());
  arm();
  scene::Listener listener(daemon_->endpoints());
  ASSERT_EQ(ask({"fire"}).code, 0);  // by who holds the lease
  const auto result = listener.next_message<v1::Result>("result");
  ASSERT_TRUE(result);
  const auto comparison = listener.next_message<v1::Comparison>("comparison");
  ASSERT_TRUE(comparison);
  EXPECT_EQ(comparison->shot_id(), result->shot_id());
  EXPECT_FALSE(comparison->rule().empty());
  EXPECT_EQ(listener.lost(), 0U);
}

TEST_F(LiveModel, DiagnosesTheLastShotsOnRequestAndFilesTheOutcome) {
  ASSERT_NO_FATAL_FAILURE(activate());
  (void)json_of(ask({"diagnose-live", "--shots", "3", "--no-wait", "--json"}));
  const json live = ended_diagnosis();
  ASSERT_EQ(live["state"], "done") << live;
  EXPECT_EQ(live["shots"].size(), 3U);
  // The same shots in the same order.
  std::vector<std::string> words{"diagnose", "--model", model_, "--json"};
  for (const json& id : live["shots"]) {
    words.push_back((setup_.store() / "shots" / (id.get<std::string>() + ".h5")).string());
  }
  const json file = json_of(kolsky(words));
  EXPECT_EQ(live["verdict"], file["verdict"]);
  EXPECT_EQ(live["effects"], file["effects"]);
  EXPECT_EQ(live["misfit"]["after"]["chi2_reduced"], file["misfit"]["after"]["chi2_reduced"]);
  EXPECT_EQ(live["candidates"].size(), file["candidates"].size());
  const std::string stored = live["stored_as"];
  std::ifstream text(stored);
  const json kept = json::parse(text);
  EXPECT_EQ(kept["summary"]["id"], live["id"]);
  EXPECT_EQ(kept["summary"]["state"], "DONE");
  EXPECT_EQ(json_of(ask({"diagnose-live", "--last", "--json"}))["id"], live["id"]);
  // As `kolsky diagnose` prints it.
  const std::string printed = ask({"diagnose-live", "--last"}).out;
  EXPECT_NE(printed.find("verdict: " + live["verdict"].get<std::string>()), std::string::npos);
  EXPECT_NE(printed.find("held-out misfit"), std::string::npos) << printed;
  // What is not there begins nothing, and the last one stays the last.
  EXPECT_TRUE(refused(ask({"diagnose-live", "20000101T000000000Z-0000-0001"}),
                      {"20000101T000000000Z-0000-0001", "is not in the store"}));
  EXPECT_EQ(json_of(ask({"diagnose-live", "--last", "--json"}))["id"], live["id"]);
}

/// A diagnosis has threads of its own, at the lowest priority: what is fired meanwhile is stored
/// whole, reduced and compared as ever, and the diagnosis goes on.
TEST_F(LiveModel, ShotsGoOnWhileADiagnosisRuns) {
  ASSERT_NO_FATAL_FAILURE(activate());
  const json begun = json_of(ask({"diagnose-live", "--shots", "3", "--no-wait", "--json"}));
  ASSERT_EQ(begun["state"], "running") << begun;
  for (int n = 0; n < 2; ++n) {
    const std::string capture = shoot();
    EXPECT_EQ(comparison_of(id_of(capture))["comparable"], true);
  }
  EXPECT_EQ(json_of(ask({"status", "--json"}))["samples_missing"], 0);
  const json live = ended_diagnosis();
  EXPECT_EQ(live["id"], begun["id"]);
  EXPECT_EQ(live["state"], "done") << live;
  EXPECT_EQ(live["shots"].size(), 3U) << "those that were there when it began";
}

TEST_F(LiveModel, DiagnosisIsOneAtATimeAndEndsWhenCancelled) {
  ASSERT_NO_FATAL_FAILURE(activate());
  const json begun = json_of(ask({"diagnose-live", "--no-wait", "--json"}));
  EXPECT_EQ(begun["state"], "running");
  EXPECT_TRUE(refused(ask({"diagnose-live"}), {"under way", begun["id"].get<std::string>()}));
  const json ended = json_of(ask({"diagnose-live", "--cancel", "--json"}));
  EXPECT_EQ(ended["state"], "cancelled");
  EXPECT_TRUE(ended["step"].get<std::string>().starts_with("while ")) << ended;
  EXPECT_FALSE(std::filesystem::exists(setup_.store() / "diagnoses" /
                                       (begun["id"].get<std::string>() + ".json")));
  EXPECT_TRUE(refused(ask({"diagnose-live", "--cancel"}), {"no diagnosis is under way"}));
}

TEST_F(LiveModel, RefusesWhatCannotBeDone) {
  EXPECT_TRUE(refused(ask({"diagnose-live"}), {"no model is active", "[model] file"}));
  EXPECT_TRUE(refused(ask({"diagnose-live", "--last"}), {"none was asked for"}));
  EXPECT_TRUE(refused(ask({"diagnose-live", "a", "--shots", "3"}), {"--shots"}));
  // A model that was never fitted does not become the active one.
  setup_.set("model", "file = \"m.toml\"");
  (void)setup_.write();
  EXPECT_TRUE(refused(ask({"reload"}), {"m.toml", "never fitted", "kolsky fit"}));
}

}  // namespace
}  // namespace kolsky
