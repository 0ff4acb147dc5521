#include "daemon/daemon.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <thread>
#include <zmq.hpp>

#include "drivers/files/captures/capture.hpp"
#include "drivers/files/settings/bench_file.hpp"
#include "drivers/files/store/store.hpp"
#include "processing/base/error.hpp"
#include "processing/reduction/reducer.hpp"
#include "proto/codec.hpp"
#include "tests/end_to_end/scene.hpp"

namespace kolsky {
namespace {

using scene::eventually;
using scene::Installation;
using scene::Lab;
using scene::LabOptions;
using scene::Listener;
using std::chrono::milliseconds;

/// A daemon on a simulated digitiser, armed.
struct Running {
  explicit Running(const LabOptions& options = {}, const std::string& trigger_line = "",
                   std::string (*filed)(std::string bench) = nullptr)
      : lab(options), setup(lab.uri(), filed ? filed(lab.bench()) : lab.bench()) {
    setup.set("trigger", trigger_line);
    daemon = std::make_unique<Daemon>(setup.read());
    daemon->start();
    listener = std::make_unique<Listener>(daemon->endpoints());
  }
  [[nodiscard]] v1::Status status() const { return listener->control().status(); }
  /// Arms, fires and waits. @return the result
  v1::Result shoot() {
    listener->arm();
    listener->control().fire();
    std::optional<v1::Result> result = listener->next_message<v1::Result>("result");
    EXPECT_TRUE(result) << "no result came: " << status().ShortDebugString();
    return result.value_or(v1::Result{});
  }
  [[nodiscard]] Shot stored(const std::string& id) const {
    const StoreLayout store{setup.store()};
    EXPECT_TRUE(eventually([&] { return std::filesystem::exists(store.capture_of(id)); })) << id;
    return read_capture(store.capture_of(id));
  }

  Lab lab;
  Installation setup;
  std::unique_ptr<Daemon> daemon;
  std::unique_ptr<Listener> listener;
};

void expect_same(const Reduction& one, const Reduction& other) {
  EXPECT_EQ(one.time_s, other.time_s);
  EXPECT_EQ(one.stress_Pa, other.stress_Pa);
  EXPECT_EQ(one.strain, other.strain);
  EXPECT_EQ(one.strain_rate_per_s, other.strain_rate_per_s);
  EXPECT_EQ(one.force_front_N, other.force_front_N);
  EXPECT_EQ(one.force_back_N, other.force_back_N);
  EXPECT_EQ(one.arrival_s, other.arrival_s);
  EXPECT_EQ(one.bar_model, other.bar_model);
  EXPECT_EQ(one.quality.verdict(), other.quality.verdict());
}

double greatest(const std::vector<double>& values) {
  return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
}

void expect_sound_store(const Installation& setup, std::size_t captures) {
  const StoreReport report = verify_store({setup.store()});
  for (const StoreReport::Problem& problem : report.problems) {
    ADD_FAILURE() << problem.file << ": " << problem.text;
  }
  EXPECT_EQ(report.captures, captures);
  EXPECT_EQ(report.journaled_shots, captures);
}

v1::ShotAndResult only_shot(const Daemon& daemon) {
  Listener listener(daemon.endpoints());
  const v1::ShotList list = listener.control().list_shots();
  EXPECT_EQ(list.shots_size(), 1);
  return listener.control().get_shot(list.shots_size() == 0 ? "" : list.shots(0).id());
}

/// Replays the only shot of a store. Codes, gaps and the verdict come back.
void expect_replay_gives(const Shot& shot, const Running& run) {
  Installation again("replay:" + (run.setup.store() / "shots").string(), run.lab.bench());
  Daemon replay(again.read());
  replay.start();
  ASSERT_TRUE(eventually([&] { return replay.finished(); }));
  const v1::ShotAndResult got = only_shot(replay);
  const Shot replayed = wire::decode(got.shot());
  EXPECT_EQ(replayed.channels, shot.channels);
  ASSERT_EQ(replayed.gaps.size(), shot.gaps.size());
  for (std::size_t i = 0; i < shot.gaps.size(); ++i) {
    EXPECT_EQ(replayed.gaps[i].samples, shot.gaps[i].samples);
    EXPECT_EQ(replayed.gaps[i].known, shot.gaps[i].known);
    EXPECT_EQ(replayed.gaps[i].first_tick - replayed.first_tick,
              shot.gaps[i].first_tick - shot.first_tick);
  }
  expect_same(wire::decode(got.result()), Reducer().reduce(shot));
}

/// A bench whose gauges are read in strain.
std::string in_strain(std::string bench) {
  const std::string volts = "unit = \"V\"\nstrain_per_V";
  for (std::size_t at = bench.find(volts); at != std::string::npos; at = bench.find(volts)) {
    bench.replace(at, bench.find('\n', at + volts.size()) - at, "unit = \"strain\"");
  }
  return bench;
}

TEST(Daemon, ReadsStrainFromADigitiserThatKnowsIt) {
  Running run({}, "", in_strain);
  const v1::Result message = run.shoot();
  const Reduction published = wire::decode(message);
  ASSERT_TRUE(published.quality.reducible) << published.quality.reason;
  const Shot shot = run.stored(message.shot_id());
  for (const ChannelRecord& channel : shot.channels) EXPECT_EQ(channel.unit, "strain");
  EXPECT_NEAR(greatest(published.stress_Pa) / greatest(run.lab.truth().stress_Pa), 1.0, 0.05);
  EXPECT_NEAR(greatest(published.strain) / greatest(run.lab.truth().strain), 1.0, 0.05);
}

TEST(Daemon, PublishesWhatAFiredShotReducesTo) {
  Running run;
  const v1::Result message = run.shoot();
  const Reduction published = wire::decode(message);
  ASSERT_TRUE(published.quality.reducible) << published.quality.reason;

  const Shot shot = run.stored(message.shot_id());
  EXPECT_EQ(shot.samples(), 4000U);
  EXPECT_TRUE(shot.gaps.empty());
  ASSERT_TRUE(shot.trigger);
  EXPECT_EQ(shot.trigger->kind, TriggerKind::incident);
  EXPECT_EQ(shot.trigger->tick - shot.first_tick, 400);
  expect_same(published, Reducer().reduce(shot));

  // The model's own knowledge of the specimen, which no part of the reduction shares.
  EXPECT_NEAR(greatest(published.stress_Pa) / greatest(run.lab.truth().stress_Pa), 1.0, 0.05);
  EXPECT_NEAR(greatest(published.strain) / greatest(run.lab.truth().strain), 1.0, 0.05);

  const auto announced = run.listener->next_message<v1::Shot>("shot");
  ASSERT_TRUE(announced);
  EXPECT_EQ(wire::decode(*announced).channels, shot.channels);
  const v1::ShotAndResult got = run.listener->control().get_shot(message.shot_id());
  expect_same(wire::decode(got.result()), published);
  EXPECT_EQ(wire::decode(got.shot()).channels, shot.channels);

  const v1::ShotList list = run.listener->control().list_shots();
  ASSERT_EQ(list.shots_size(), 1);
  EXPECT_EQ(list.shots(0).id(), message.shot_id());
  EXPECT_TRUE(list.shots(0).reducible());
  EXPECT_EQ(list.shots(0).peak_stress_pa(), greatest(published.stress_Pa));
  run.daemon->stop();
  expect_sound_store(run.setup, 1);
}

TEST(Daemon, ReplaysAStoredShotExactly) {
  Running live;
  const v1::Result message = live.shoot();
  const Shot original = live.stored(message.shot_id());
  live.daemon->stop();

  Installation again("replay:" + (live.setup.store() / "shots").string(), live.lab.bench());
  // Not the window it was recorded with: a stored shot comes back as it was.
  again.set("trigger", "pre_samples = 10\npost_samples = 500");
  Daemon replay(again.read());
  replay.start();
  ASSERT_TRUE(eventually([&] { return replay.finished(); }));
  Listener listener(replay.endpoints());
  EXPECT_EQ(listener.control().status().state(), v1::ENDED);
  const v1::ShotList list = listener.control().list_shots();
  ASSERT_EQ(list.shots_size(), 1);
  const v1::ShotAndResult got = listener.control().get_shot(list.shots(0).id());
  const Shot replayed = wire::decode(got.shot());
  EXPECT_EQ(replayed.channels, original.channels);
  ASSERT_TRUE(replayed.trigger);
  EXPECT_EQ(replayed.trigger->kind, TriggerKind::marked);
  EXPECT_EQ(replayed.trigger->tick - replayed.first_tick,
            original.trigger->tick - original.first_tick);
  EXPECT_EQ(replayed.trigger->fraction, original.trigger->fraction);
  EXPECT_EQ(replayed.trigger->sigma_samples, original.trigger->sigma_samples);
  expect_same(wire::decode(got.result()), wire::decode(message));

  EXPECT_THROW(listener.control().arm(), InputError);
  EXPECT_THROW(listener.control().fire(), InputError);
  EXPECT_THROW(listener.control().force_trigger(), InputError);
}

TEST(Daemon, ReplaysWhatIsFiledWithACapture) {
  Running live;
  Shot original = live.stored(live.shoot().shot_id());
  live.daemon->stop();
  original.meta = {{"specimen_id", "ball7"}, {"striker_speed_m_per_s", "9.5"}};
  const std::filesystem::path folder = live.setup.folder().path() / "filed";
  std::filesystem::create_directory(folder);
  write_capture(original, folder / "filed.h5");

  Installation again("replay:" + folder.string(), live.lab.bench());
  again.set("meta", "specimen_id = \"another\"\noperator_note = \"again\"");
  Daemon replay(again.read());
  replay.start();
  ASSERT_TRUE(eventually([&] { return replay.finished(); }));
  const Shot replayed = wire::decode(only_shot(replay).shot());
  EXPECT_EQ(replayed.meta, (std::map<std::string, std::string>{{"specimen_id", "ball7"},
                                                               {"striker_speed_m_per_s", "9.5"},
                                                               {"operator_note", "again"},
                                                               {"replayed_from", original.id}}));
}

TEST(Daemon, ReplaysALongCaptureWholeAtAnySpeed) {
  Running live({}, "post_samples = 90000");
  const Shot original = live.stored(live.shoot().shot_id());
  live.daemon->stop();
  Installation again("replay:" + (live.setup.store() / "shots").string(), live.lab.bench());
  again.set("digitiser", "speed = 0.5").set("ring", "seconds = 0.05");
  Daemon replay(again.read());
  replay.start();
  ASSERT_TRUE(eventually([&] { return replay.finished(); }));
  const Shot replayed = wire::decode(only_shot(replay).shot());
  EXPECT_EQ(replayed.channels, original.channels);
}

TEST(Daemon, ReplaysAFolderShotByShotAsFastAsItCan) {
  Running live;
  std::vector<Shot> originals;
  for (int i = 0; i < 3; ++i) {
    originals.push_back(live.stored(live.shoot().shot_id()));
    std::this_thread::sleep_for(milliseconds(30));
  }
  live.daemon->stop();
  Installation again("replay:" + (live.setup.store() / "shots").string(), live.lab.bench());
  again.set("ring", "seconds = 0.012");  // smaller than the folder: the replay must wait
  Daemon replay(again.read());
  replay.start();
  ASSERT_TRUE(eventually([&] { return replay.finished(); }));
  Listener listener(replay.endpoints());
  EXPECT_EQ(listener.control().status().ring_overruns(), 0U);
  EXPECT_EQ(listener.control().status().gaps_of_unknown_length(), 0U);
  const v1::ShotList list = listener.control().list_shots();
  ASSERT_EQ(list.shots_size(), 3);
  for (int i = 0; i < 3; ++i) {
    const Shot replayed = wire::decode(listener.control().get_shot(list.shots(2 - i).id()).shot());
    EXPECT_EQ(replayed.channels, originals[static_cast<std::size_t>(i)].channels) << i;
  }
}

TEST(Daemon, StoresAShotWithAGapAndSaysWhyItIsNotReducible) {
  Running run({.faults = "shot 1 at 900 lose 250"});
  const v1::Result result = run.shoot();
  EXPECT_FALSE(result.quality().reducible());
  EXPECT_NE(result.quality().reason().find("missing"), std::string::npos)
      << result.quality().reason();
  const Shot shot = run.stored(result.shot_id());
  ASSERT_EQ(shot.gaps.size(), 1U);
  EXPECT_TRUE(shot.gaps[0].known);
  EXPECT_EQ(shot.gaps[0].samples, 250);
  const auto fault = run.listener->next_message<v1::Fault>("fault");
  ASSERT_TRUE(fault);
  EXPECT_EQ(run.status().samples_missing(), 250U);
  EXPECT_EQ(run.lab.attribute("injected_lost_samples"), 250);
  run.daemon->stop();
  expect_sound_store(run.setup, 1);
  expect_replay_gives(shot, run);
}

// The trigger holds off for 15 ms after a shot, whose result is there sooner: what is fired then
// would be lost.
TEST(Daemon, FiresWhenTheTriggerWatchesAgain) {
  Running run;
  const v1::Result first = run.shoot();
  const v1::Result second = run.shoot();
  EXPECT_NE(first.shot_id(), second.shot_id());
  EXPECT_TRUE(eventually([&] { return run.status().triggers() == 2; }));
}

TEST(Daemon, SaysThatAClippedShotIsNotReducible) {
  Running run({.faults = "shot 1 at 500 clip 20"});
  const v1::Result result = run.shoot();
  EXPECT_FALSE(result.quality().reducible());
  EXPECT_NE(result.quality().reason().find("converter's ends"), std::string::npos)
      << result.quality().reason();
  EXPECT_GE(clipped_samples(run.stored(result.shot_id()).channels[0]).size(), 20U);
}

TEST(Daemon, KeepsAnInterruptedShotAndReachesTheDigitiserAgain) {
  Running run({.faults = "shot 1 at 2000 drop 300ms"});
  const v1::Result cut = run.shoot();
  EXPECT_FALSE(cut.quality().reducible());
  const Shot shot = run.stored(cut.shot_id());
  EXPECT_LT(shot.samples(), 4000U);
  ASSERT_EQ(shot.gaps.size(), 1U);
  EXPECT_FALSE(shot.gaps[0].known);
  EXPECT_EQ(shot.gaps[0].first_tick, shot.first_tick + static_cast<Tick>(shot.samples()) - 1);
  expect_replay_gives(shot, run);
  EXPECT_TRUE(eventually([&] { return run.status().state() == v1::ARMED; }));
  EXPECT_EQ(run.status().reconnects(), 1U);
  const v1::Result whole = run.shoot();
  EXPECT_TRUE(whole.quality().reducible()) << whole.quality().reason();
  EXPECT_EQ(run.stored(whole.shot_id()).samples(), 4000U);
}

TEST(Daemon, IsNotHeldUpBySubscribersThatDoNotRead) {
  Running run;
  zmq::context_t context;
  std::vector<zmq::socket_t> slow;
  for (const std::string& endpoint :
       {run.daemon->endpoints().results, run.daemon->endpoints().preview}) {
    for (int i = 0; i < 3; ++i) {
      zmq::socket_t& socket = slow.emplace_back(context, zmq::socket_type::sub);
      socket.set(zmq::sockopt::rcvhwm, 1);
      socket.set(zmq::sockopt::rcvbuf, 4096);
      socket.set(zmq::sockopt::linger, 0);
      socket.set(zmq::sockopt::subscribe, "");
      socket.connect(endpoint);
    }
  }
  run.listener->arm();
  for (int i = 0; i < 40; ++i) {
    run.listener->control().force_trigger();
    ASSERT_TRUE(run.listener->next("result")) << i;
  }
  slow.clear();  // and dead ones
  const v1::Result result = run.shoot();
  EXPECT_TRUE(result.quality().reducible()) << result.quality().reason();
  const v1::Status status = run.status();
  EXPECT_EQ(status.shots_journaled(), 41U);
  EXPECT_EQ(status.samples_missing(), 0U);
  EXPECT_EQ(status.gaps_of_unknown_length(), 0U);
  EXPECT_EQ(status.ring_overruns(), 0U);
}

TEST(Daemon, RefusesToArmAnUnbalancedBridge) {
  Running run({.front_end = [](FrontEndSettings& f) { f.offset_microstrain = 1700.0; }});
  std::string refusal;
  ASSERT_TRUE(eventually([&] {
    v1::ControlRequest arm;
    arm.mutable_arm();
    const v1::ControlReply reply = run.listener->control().request(arm);
    refusal = reply.error();
    return !reply.ok() && refusal.find("not known yet") == std::string::npos &&
           reply.preflight().checks_size() > 0;
  }));
  EXPECT_NE(refusal.find("bridge-balance g1"), std::string::npos) << refusal;
  EXPECT_EQ(run.status().state(), v1::DISARMED);
  EXPECT_THROW(run.listener->control().fire(), InputError);  // nobody would see it
}

TEST(Daemon, CountsNothingThatItDidNotSee) {
  Running run;
  EXPECT_EQ(run.status().state(), v1::DISARMED);
  run.listener->arm();
  run.listener->control().disarm();
  EXPECT_EQ(run.status().state(), v1::DISARMED);
  run.listener->control().force_trigger();  // armed or not
  const auto result = run.listener->next_message<v1::Result>("result");
  ASSERT_TRUE(result);
  EXPECT_FALSE(result->quality().reducible());  // noise only
  const Shot shot = run.stored(result->shot_id());
  EXPECT_EQ(shot.trigger->kind, TriggerKind::forced);
  EXPECT_EQ(run.status().triggers(), 1U);
}

TEST(Daemon, TakesNewSettingsWhileDisarmed) {
  Running run;
  run.setup.set("meta", "specimen = \"second batch\"").set("trigger", "post_samples = 2000");
  run.setup.write();
  run.listener->arm();
  EXPECT_THROW(run.listener->control().reload(), InputError);
  run.listener->control().disarm();
  run.listener->control().reload();
  const Shot shot = run.stored(run.shoot().shot_id());
  EXPECT_EQ(shot.meta.at("specimen"), "second batch");
  EXPECT_EQ(shot.samples(), 2400U);

  run.listener->control().disarm();
  run.setup.set("ring", "seconds = 1");
  run.setup.write();
  EXPECT_THROW(run.listener->control().reload(), InputError);
  run.setup.folder().write("bench.toml", "kind = \"shpb\"\n");
  EXPECT_THROW(run.listener->control().reload(), InputError);
  EXPECT_EQ(run.status().state(), v1::DISARMED);
}

TEST(Daemon, FindsItsShotsAgainWithoutACatalogue) {
  Running run;
  const std::string id = run.shoot().shot_id();
  const double peak = run.listener->control().list_shots().shots(0).peak_stress_pa();
  run.daemon->stop();
  run.daemon.reset();
  std::filesystem::remove(run.setup.store() / "catalogue.sqlite");
  Daemon again(run.setup.read());
  again.start();
  Listener listener(again.endpoints());
  const v1::ShotList list = listener.control().list_shots();
  ASSERT_EQ(list.shots_size(), 1);
  EXPECT_EQ(list.shots(0).id(), id);
  EXPECT_EQ(list.shots(0).peak_stress_pa(), peak);
}

TEST(Daemon, StoresTheWindowThatIsOpenWhenItIsStopped) {
  Running run({}, "post_samples = 300000");
  run.listener->arm();
  run.listener->control().fire();
  ASSERT_TRUE(eventually([&] { return run.status().state() == v1::CAPTURING; }));
  run.daemon->stop();
  expect_sound_store(run.setup, 1);
  const Shot shot = read_capture(captures_in(run.setup.store() / "shots").front());
  EXPECT_LT(shot.samples(), 300'000U);
  ASSERT_EQ(shot.gaps.size(), 1U);
  EXPECT_FALSE(Reducer().reduce(shot).quality.reducible);
}

TEST(Daemon, LeavesAStoreInUseAlone) {
  Running run;
  EXPECT_THROW(Daemon second(run.setup.read()), InputError);
}

TEST(Daemon, KeepsTheShotsOfABarThatIsOnlyCharacterised) {
  Running run({.scenario = "bar"});
  const v1::Result result = run.shoot();
  EXPECT_FALSE(result.quality().reducible());
  EXPECT_NE(result.quality().reason().find("specimen"), std::string::npos)
      << result.quality().reason();
  const Shot shot = run.stored(result.shot_id());
  EXPECT_EQ(shot.channels.size(), 4U);
  EXPECT_EQ(shot.bench.kind, BenchKind::bar);
  EXPECT_EQ(run.listener->control().get_shot(result.shot_id()).result().quality().reason(),
            result.quality().reason());
}

TEST(Daemon, HasOneOperatorAtATime) {
  Running run;
  run.listener->arm();
  Listener other(run.daemon->endpoints(), "somebody else");
  EXPECT_THROW(other.control().disarm(), InputError);
  EXPECT_EQ(other.control().status().state(), v1::ARMED);
  EXPECT_EQ(other.control().status().operator_id(), "tester");
  run.listener->control().release();
  other.control().disarm();
  EXPECT_EQ(run.status().state(), v1::DISARMED);
}

TEST(Daemon, ShowsTheStreamInThePreview) {
  Running run;
  SubscriberOptions options;
  options.endpoint = run.daemon->endpoints().preview;
  options.topics = {"preview"};
  Subscriber subscriber(options);
  run.listener->arm();
  run.listener->control().fire();
  double highest = 0.0;
  const bool seen = eventually([&] {
    const SubscriberEvent event = subscriber.next(milliseconds(200));
    const auto* received = std::get_if<Received>(&event);
    v1::Preview preview;
    if (received == nullptr || !preview.ParseFromString(received->payload)) {
      return false;
    }
    const v1::Waveform& maximum = preview.channels(0).maximum();
    EXPECT_EQ(preview.channels(0).gauge(), "g1");
    for (std::size_t i = 0; i + 1 < maximum.data().size(); i += 2) {
      std::int16_t code = 0;
      maximum.data().copy(reinterpret_cast<char*>(&code), 2, i);
      highest = std::max(highest, (code + maximum.offset()) * maximum.scale());
    }
    return highest > 1.0;  // a pulse of 1000 microstrain is 2.5 V
  });
  EXPECT_TRUE(seen) << highest;
}

}  // namespace
}  // namespace kolsky
