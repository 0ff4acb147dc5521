// The commands that talk to a daemon, against a real one on a simulated digitiser.
#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <string>
#include <thread>

#include "daemon/daemon.hpp"
#include "drivers/files/captures/capture.hpp"
#include "kolsky/v1/kolsky.pb.h"
#include "proto/codec.hpp"
#include "tests/end_to_end/cli/kolsky.hpp"
#include "tests/end_to_end/process.hpp"
#include "tests/scratch_folder.hpp"

namespace kolsky {
namespace {

using nlohmann::json;
using scene::Answer;
using scene::json_of;
using scene::kolsky;
using scene::refused;

class WithDaemon : public ::testing::Test {
 protected:
  WithDaemon() : setup_(lab_.uri(), lab_.bench()), daemon_(setup_.read()) { daemon_.start(); }

  /// Runs a command with the daemon's endpoint in its environment.
  [[nodiscard]] Answer ask(const std::vector<std::string>& words) const {
    return kolsky(words, {"KOLSKY_ENDPOINT=" + daemon_.endpoints().control});
  }
  /// Arms as soon as the noise is known.
  void arm() const {
    Answer answer;
    EXPECT_TRUE(scene::eventually([&] {
      answer = ask({"arm"});
      return answer.code == 0;
    })) << answer.err;
  }
  /// Takes a shot. @return its id
  [[nodiscard]] std::string shoot() const {
    arm();
    return json_of(ask({"fire", "--wait", "10", "--json"}))["shot"];
  }

  scene::Lab lab_;
  scene::Installation setup_;
  Daemon daemon_;
};

TEST_F(WithDaemon, StatusTellsStateDigitiserAndNoise) {
  const json status = json_of(ask({"status", "--json"}));
  EXPECT_EQ(status["state"], "disarmed");
  EXPECT_EQ(status["digitiser_uri"], lab_.uri());
  EXPECT_EQ(status["simulated"], true);
  EXPECT_EQ(status["sampling_frequency_Hz"], 1e6);
  EXPECT_EQ(status["channels"].size(), 2U);
  EXPECT_EQ(status["channels"][0]["gauge"], "g1");
  EXPECT_EQ(status["results_endpoint"], daemon_.endpoints().results);
  const Answer text = ask({"status"});
  EXPECT_EQ(text.code, 0);
  EXPECT_TRUE(text.out.starts_with("disarmed  " + lab_.uri() + " (simulated)  1 MHz")) << text.out;
}

TEST_F(WithDaemon, GetIsReduceOfTheCaptureToTheByte) {
  const std::string id = shoot();
  const json shots = json_of(ask({"shots", "--json"}));
  ASSERT_EQ(shots["shots"].size(), 1U);
  const json& shot = shots["shots"][0];
  EXPECT_EQ(shot["id"], id);
  EXPECT_EQ(shot["verdict"], "pass");
  EXPECT_EQ(shot["time"].get<std::string>().size(),
            std::string("2026-02-03T10:20:30.123456Z").size());
  EXPECT_EQ(shot["time"].get<std::string>().back(), 'Z');

  const Answer got = ask({"get", id, "--json"});
  const json result = json_of(got);
  EXPECT_EQ(result["shot"], id);
  EXPECT_EQ(result["bar_model_assumed"], true);
  EXPECT_NE(result["bar_model"].get<std::string>().find("PMMA"), std::string::npos);
  const std::string capture = shot["capture"];
  ASSERT_TRUE(scene::eventually([&] { return std::filesystem::exists(capture); })) << capture;
  EXPECT_EQ(kolsky({"reduce", capture, "--json"}).out, got.out);
  EXPECT_EQ(ask({"get", "last", "--json"}).out, got.out);
  EXPECT_EQ(ask({"get", id, "--json", "--true"}).out,
            kolsky({"reduce", capture, "--json", "--true"}).out);
  EXPECT_EQ(ask({"get", id}).out, kolsky({"reduce", capture}).out);
}

/// Over the wire, in the journal's record and in the capture the shot has the bar it was taken
/// with.
TEST(WithABarOfTwoBranches, GetIsReduceOfTheCaptureToTheByte) {
  scene::Lab lab;
  scene::Installation setup(lab.uri(), lab.bench());
  setup.folder().write("two.toml",
                       "solid = \"two-kelvin\"\nsource = \"two branches\"\n"
                       "density_kg_m3 = 1180\npoisson_ratio = 0.36\nE1_Pa = 5.66e9\n"
                       "E2_Pa = 37e9\neta2_Pa_s = 1.81e6\nE3_Pa = 160e9\neta3_Pa_s = 5e7\n");
  setup.set("", "bar_model = \"two.toml\"");
  Daemon daemon(setup.read());
  daemon.start();
  const auto ask = [&](const std::vector<std::string>& words) {
    return kolsky(words, {"KOLSKY_ENDPOINT=" + daemon.endpoints().control});
  };
  ASSERT_TRUE(scene::eventually([&] { return ask({"arm"}).code == 0; }));
  const std::string id = json_of(ask({"fire", "--wait", "10", "--json"}))["shot"];
  const Answer got = ask({"get", id, "--json"});
  EXPECT_EQ(json_of(got)["bar_model"], "two branches");
  const std::string capture = json_of(ask({"shots", "--json"}))["shots"][0]["capture"];
  ASSERT_TRUE(scene::eventually([&] { return std::filesystem::exists(capture); })) << capture;
  EXPECT_EQ(read_capture(capture).bar_model->solid, SolidKind::two_kelvin);
  EXPECT_EQ(kolsky({"reduce", capture, "--json"}).out, got.out);
  setup.folder().write("three.toml",
                       "density_kg_m3 = 1180\npoisson_ratio = 0.36\nE1_Pa = 5.66e9\n"
                       "E2_Pa = 37e9\neta2_Pa_s = 1.81e6\nsource = \"two branches\"\n");
  const json three =
      json_of(kolsky({"reduce", capture, "--json", "--bar-model", setup.folder() / "three.toml"}));
  EXPECT_NE(three["strain"], json_of(got)["strain"]);
}

TEST_F(WithDaemon, ExportsAShotByItsId) {
  const std::string id = shoot();
  const testing::ScratchFolder folder;
  const std::string by_id = folder / "id.csv";
  const json told = json_of(ask({"export", id, "--format", "csv", "-o", by_id, "--json"}));
  EXPECT_EQ(told["shot"], id);
  const std::string capture = told["capture"];
  ASSERT_TRUE(scene::eventually([&] { return std::filesystem::exists(capture); }));
  const std::string by_file = folder / "file.csv";
  EXPECT_EQ(kolsky({"export", capture, "--format", "csv", "-o", by_file}).code, 0);
  std::ifstream one(by_id);
  std::ifstream other(by_file);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(one), {}),
            std::string(std::istreambuf_iterator<char>(other), {}));
}

TEST_F(WithDaemon, ArmTellsItsPreflightAndDisarmUndoesIt) {
  arm();
  const json armed = json_of(ask({"arm", "--json"}));
  EXPECT_EQ(armed["armed"], true);
  EXPECT_GE(armed["checks"].size(), 4U);
  for (const json& check : armed["checks"]) {
    EXPECT_EQ(check["ok"], true) << check;
  }
  EXPECT_EQ(json_of(ask({"status", "--json"}))["state"], "armed");
  EXPECT_EQ(json_of(ask({"disarm", "--json"}))["done"], "disarmed");
  EXPECT_EQ(json_of(ask({"status", "--json"}))["state"], "disarmed");
  EXPECT_EQ(ask({"release"}).code, 0);
  EXPECT_EQ(json_of(ask({"status", "--json"}))["operator"], "");
}

TEST_F(WithDaemon, AForcedWindowIsStoredAndSaidNotToBeReducible) {
  arm();
  const std::string id = json_of(ask({"force-trigger", "--wait", "10", "--json"}))["shot"];
  const json result = json_of(ask({"get", id, "--json"}));
  EXPECT_EQ(result["quality"]["reducible"], false);
  EXPECT_FALSE(result["quality"]["reason"].get<std::string>().empty());
  EXPECT_EQ(result["stress_Pa"], json::array());
  EXPECT_TRUE(result["arrival_s"].is_null()) << result["arrival_s"];
  EXPECT_TRUE(result["band_limit_Hz"].is_null());
  const json listed = json_of(ask({"shots", "--json"}))["shots"][0];
  for (const char* number : {"peak_stress_Pa", "peak_strain", "peak_force_N", "restitution"}) {
    EXPECT_TRUE(listed[number].is_null()) << number << " of " << listed;
  }
  const Answer text = ask({"get", id});
  EXPECT_EQ(text.code, 0);
  EXPECT_NE(text.out.find("not reducible: "), std::string::npos) << text.out;
}

TEST_F(WithDaemon, WatchHearsAShotAndItsResult) {
  arm();
  const testing::ScratchFolder folder;
  scene::Process watching({KOLSKY, "watch", "--json", "--count", "1", "--for", "20"},
                          folder / "heard", {"KOLSKY_ENDPOINT=" + daemon_.endpoints().control});
  // It has joined when the daemon has answered it; firing before that would only be in its
  // snapshot.
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  const std::string id = json_of(ask({"fire", "--wait", "10", "--json"}))["shot"];
  ASSERT_EQ(watching.wait(std::chrono::seconds(20)), 0) << watching.output();
  const json heard = json::parse(watching.output());
  EXPECT_EQ(heard["complete"], true);
  EXPECT_EQ(heard["results"], 1);
  EXPECT_EQ(heard["lost_messages"], 0);
  std::vector<std::string> kinds;
  for (const json& event : heard["events"]) {
    if (event["event"] == "shot" || event["event"] == "result") {
      kinds.push_back(event["event"]);
      EXPECT_EQ(event["shot"], id);
    }
  }
  EXPECT_EQ(kinds, (std::vector<std::string>{"shot", "result"}));
}

TEST_F(WithDaemon, WatchShowsTracesShotsAndTheLoopOnce) {
  const std::string id = shoot();
  const Answer page = ask({"watch", "--once"});
  EXPECT_EQ(page.code, 0) << page.err;
  for (const std::string& wanted :
       {std::string("armed"), std::string("g1"), std::string("g2"), std::string("noise"), id,
        std::string("pass"), std::string("stress [MPa]"), std::string("strain [%]")}) {
    EXPECT_NE(page.out.find(wanted), std::string::npos) << wanted << "\n" << page.out;
  }
  // Traces are dropped where a busy machine falls behind; shots and results never.
  EXPECT_TRUE(
      page.out.find("messages lost on the way here: 0") != std::string::npos ||
      std::regex_search(page.out,
                        std::regex(R"(messages lost on the way here: (\d+) \(\1 of preview\))")))
      << page.out;
}

TEST_F(WithDaemon, WatchEndsInTimeWithoutAResult) {
  const Answer answer = ask({"watch", "--count", "1", "--for", "0.5", "--json"});
  EXPECT_EQ(answer.code, 1);
  EXPECT_EQ(json::parse(answer.out)["complete"], false);
}

TEST_F(WithDaemon, WhatTheDaemonRefusesIsOneLine) {
  EXPECT_TRUE(refused(ask({"get", "no-such-shot"}), {"no-such-shot"}));
  EXPECT_TRUE(refused(ask({"get", "last"}), {"no shot yet"}));
  EXPECT_TRUE(refused(ask({"export", "no-such-shot", "--format", "csv", "-o", "/tmp/never.csv"}),
                      {"no-such-shot"}));
}

TEST_F(WithDaemon, ReloadAndStopAreCarriedOut) {
  EXPECT_EQ(json_of(ask({"reload", "--json"}))["done"], "reloaded");
  EXPECT_EQ(json_of(ask({"stop", "--json"}))["done"], "stopping");
  EXPECT_TRUE(scene::eventually([&] { return daemon_.stop_requested(); }));
}

TEST_F(WithDaemon, VerifyFindsTheStoreSoundUntilAByteChanges) {
  const std::string id = shoot();
  const std::filesystem::path capture = setup_.store() / "shots" / (id + ".h5");
  ASSERT_TRUE(scene::eventually([&] { return std::filesystem::exists(capture); }));
  daemon_.stop();
  const json sound = json_of(kolsky({"verify", setup_.store().string(), "--json"}));
  EXPECT_EQ(sound["sound"], true);
  EXPECT_EQ(sound["catalogue_checked"], true);
  EXPECT_EQ(sound["captures"], 1);
  EXPECT_EQ(sound["journaled_shots"], 1);

  std::filesystem::permissions(capture, std::filesystem::perms::owner_all);
  std::fstream file(capture, std::ios::in | std::ios::out | std::ios::binary);
  file.seekg(5000);
  const char flipped = static_cast<char>(file.get() ^ 1);
  file.seekp(5000);
  file.put(flipped);
  file.close();
  const Answer damaged = kolsky({"verify", setup_.store().string(), "--json"});
  EXPECT_EQ(damaged.code, 2);
  EXPECT_EQ(json::parse(damaged.out)["sound"], false);
  ASSERT_EQ(json::parse(damaged.out)["problems"].size(), 1U);
  EXPECT_EQ(json::parse(damaged.out)["problems"][0]["kind"], "in-journal");
  EXPECT_NE(damaged.err.find(id), std::string::npos) << damaged.err;
  EXPECT_NE(damaged.err.find("nothing is lost: start kolskyd"), std::string::npos) << damaged.err;

  // Without the journal it has to come from a backup, and without the capture too.
  std::filesystem::remove_all(setup_.store() / "journal");
  std::filesystem::create_directory(setup_.store() / "journal");
  const Answer lost = kolsky({"verify", setup_.store().string(), "--json"});
  EXPECT_EQ(json::parse(lost.out)["problems"][0]["kind"], "damaged");
  std::filesystem::remove(capture);
  const Answer missing = kolsky({"verify", setup_.store().string(), "--json"});
  EXPECT_EQ(missing.code, 2);
  EXPECT_EQ(json::parse(missing.out)["problems"][0]["kind"], "missing");
  EXPECT_NE(missing.err.find("backup"), std::string::npos) << missing.err;
}

TEST(AnotherRun, KnowsTheLastShotOfTheOneBefore) {
  scene::Lab lab;
  const scene::Installation setup(lab.uri(), lab.bench());
  std::string id;
  for (const bool first : {true, false}) {
    Daemon daemon(setup.read());
    daemon.start();
    const auto ask = [&](const std::vector<std::string>& words, const std::string& name) {
      return kolsky(words,
                    {"KOLSKY_ENDPOINT=" + daemon.endpoints().control, "KOLSKY_OPERATOR=" + name});
    };
    if (first) {
      ASSERT_TRUE(scene::eventually([&] { return ask({"arm"}, "anna").code == 0; }));
      EXPECT_TRUE(refused(ask({"disarm"}, "ben"), {"anna"}));
      id = json_of(ask({"fire", "--wait", "10", "--json"}, "anna"))["shot"];
    } else {
      EXPECT_EQ(json_of(ask({"get", "last", "--json"}, "anna"))["shot"], id);
    }
  }
}

// What is published, what `get` gives and what `reduce` makes of the capture are the same bits,
// with the daemon's table and after another took its place.
TEST(ReducedAsAsked, LiveStoredAndReplayedAgree) {
  scene::Lab lab;
  scene::Installation setup(lab.uri(), lab.bench());
  setup.set("reduction", "dispersion = \"exact\"")
      .set("reduction", "separate = \"never\"")
      .set("reduction", "stress = \"one-wave\"")
      .set("reduction", "inertia = \"both\"")
      .set("reduction", "friction = 0.1")
      .set("reduction", "band_limit_Hz = 25e3")
      .set("reduction", "duration_s = 3e-4")
      .set("reduction", "true = true");
  const std::vector<std::string> options = {"--dispersion", "exact",    "--separate",   "never",
                                            "--stress",     "one-wave", "--inertia",    "both",
                                            "--friction",   "0.1",      "--band-limit", "25e3",
                                            "--duration",   "3e-4",     "--true"};
  std::string id;
  std::string capture;
  std::string result;
  {
    Daemon daemon(setup.read());
    daemon.start();
    scene::Listener listener(daemon.endpoints());
    listener.arm();
    listener.control().fire();
    const auto shot = listener.next_message<v1::Shot>("shot");
    const auto published = listener.next_message<v1::Result>("result");
    ASSERT_TRUE(shot && published);
    id = published->shot_id();
    capture = shot->capture();
    EXPECT_EQ(shot->reduction().dispersion(), "exact");
    EXPECT_EQ(published->dispersion(), v1::Result::EXACT);
    EXPECT_EQ(published->stress_from(), v1::Result::ONE_WAVE);
    EXPECT_EQ(published->corrections().friction(), 0.1);
    ASSERT_TRUE(scene::eventually([&] { return std::filesystem::exists(capture); }));
    std::vector<std::string> words = {"reduce", capture, "--json", "--defaults"};
    words.insert(words.end(), options.begin(), options.end());
    result = kolsky(words).out;
    const json reduced = json::parse(result);
    EXPECT_EQ(reduced["asked"]["inertia"], "both");
    EXPECT_EQ(reduced["corrections"], (json{"axial inertia", "radial inertia", "friction"}));
    const Reduction live = wire::decode(*published);
    EXPECT_EQ(reduced["stress_Pa"].get<std::vector<double>>(), live.stress_Pa);
    EXPECT_EQ(reduced["strain"].get<std::vector<double>>(), live.strain);
    EXPECT_EQ(reduced["force_front_N"].get<std::vector<double>>(), live.force_front_N);
    EXPECT_EQ(reduced["strain_true"].get<std::vector<double>>(), live.strain_true);
    EXPECT_EQ(reduced["stress_true_Pa"].get<std::vector<double>>(), live.stress_true_Pa);
    EXPECT_EQ(kolsky({"get", id, "--json", "--endpoint", daemon.endpoints().control}).out, result);
    EXPECT_EQ(kolsky({"reduce", capture, "--json"}).out, result);
  }
  const std::string plain = kolsky({"reduce", capture, "--json", "--defaults"}).out;
  EXPECT_EQ(json::parse(plain)["stress_from"], "three-wave");
  EXPECT_FALSE(json::parse(plain).contains("asked"));
  const std::filesystem::path settings = setup.write();
  std::ifstream before(settings);
  std::string text(std::istreambuf_iterator<char>(before), {});
  text.replace(text.find("one-wave"), 3, "two");
  std::ofstream(settings) << text;
  Daemon daemon(read_config(settings));
  daemon.start();
  EXPECT_EQ(kolsky({"get", id, "--json", "--endpoint", daemon.endpoints().control}).out, result);
  EXPECT_EQ(kolsky({"get", id, "--endpoint", daemon.endpoints().control}).out,
            kolsky({"reduce", capture}).out);
}

TEST(OnReplay, FireIsRefused) {
  const scene::Bench bench;
  const std::string capture = bench.capture();
  std::ifstream text(bench.file("bench.toml"));
  scene::Installation setup("replay:" + capture,
                            std::string(std::istreambuf_iterator<char>(text), {}));
  Daemon daemon(setup.read());
  daemon.start();
  EXPECT_TRUE(refused(kolsky({"fire", "--endpoint", daemon.endpoints().control}), {"simulated"}));
}

}  // namespace
}  // namespace kolsky
