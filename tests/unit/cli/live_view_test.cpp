#include "clients/cli/live/live_view.hpp"
#include "clients/cli/reports/daemon_text.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "proto/codec.hpp"

namespace kolsky::cli {
namespace {

Received message(const std::string& topic, const google::protobuf::MessageLite& payload) {
  return {
      .topic = topic, .sequence = 1, .utc_ns = 1234567890, .payload = payload.SerializeAsString()};
}

v1::Status armed() {
  v1::Status status;
  status.set_state(v1::ARMED);
  status.set_digitiser_uri("ip:lab");
  status.set_sampling_frequency_hz(1e6);
  v1::ChannelStatus& channel = *status.add_channels();
  channel.set_gauge("g1");
  channel.set_unit("strain");
  channel.set_noise_rms(4e-6);
  return status;
}

v1::Result result(const std::string& id, bool reducible) {
  Reduction reduction;
  reduction.quality.reducible = reducible;
  reduction.quality.reason = reducible ? "" : "a gap";
  if (reducible) {
    reduction.time_s = {0.0, 1e-6, 2e-6};
    reduction.stress_Pa = {0.0, 3e6, 1e6};
    reduction.strain = {0.0, 0.01, 0.02};
    for (auto* history :
         {&reduction.strain_rate_per_s, &reduction.force_front_N, &reduction.force_back_N,
          &reduction.incident, &reduction.reflected, &reduction.transmitted}) {
      *history = {0.0, 0.0, 0.0};
    }
  }
  v1::Result encoded;
  wire::encode(reduction, id, encoded);
  return encoded;
}

nlohmann::json events(const LiveView& view) {
  return nlohmann::json::parse(to_text(view.events()));
}

TEST(LiveView, CountsAndShowsLostMessages) {
  LiveView view;
  EXPECT_EQ(view.take(Lost{"result", 5, 3}), "3 messages of result lost");
  static_cast<void>(view.take(Lost{"preview", 1, 2}));
  EXPECT_EQ(view.lost_messages(), 5U);
  EXPECT_NE(view.screen({}).find("lost on the way here: 5 (2 of preview) (3 of result)"),
            std::string::npos);
  EXPECT_EQ(events(view)[0]["first_sequence"], 5);
}

TEST(LiveView, KeepsTheLastLoopWhenAShotIsNotReducible) {
  LiveView view;
  static_cast<void>(view.take(message("result", result("one", true))));
  static_cast<void>(view.take(message("result", result("two", false))));
  EXPECT_EQ(view.results(), 2U);
  const std::string screen = view.screen({.rows = 40});
  EXPECT_NE(screen.find("stress [MPa]   one"), std::string::npos) << screen;
  EXPECT_NE(screen.find("two  fail    a gap"), std::string::npos) << screen;
  EXPECT_EQ(events(view)[0]["peak_stress_Pa"], 3e6);
  EXPECT_EQ(events(view)[1]["reducible"], false);
}

TEST(LiveView, HeartbeatsAreNoEventsButChangesAre) {
  LiveView view;
  EXPECT_EQ(view.take(message("status", armed())), "armed");
  EXPECT_EQ(view.take(message("status", armed())), "");
  EXPECT_EQ(events(view).size(), 1U);
}

TEST(LiveView, SaysWhatItCannotRead) {
  LiveView view;
  const std::string line = view.take(Received{.topic = "result", .payload = "\xff\xff"});
  EXPECT_TRUE(line.starts_with("unreadable message: ")) << line;
  EXPECT_EQ(events(view)[0]["event"], "unreadable");
}

TEST(LiveView, FitsTheTerminalHoweverSmall) {
  LiveView view;
  static_cast<void>(view.take(message("status", armed())));
  static_cast<void>(view.take(message("result", result("one", true))));
  static_cast<void>(view.take(message("fault", [] {
    v1::Fault fault;
    fault.set_kind("overflow");
    fault.set_text(std::string(300, 'x'));
    return fault;
  }())));
  for (const bool colour : {false, true}) {
    for (const int rows : {3, 10, 24, 60}) {
      for (const int columns : {20, 80, 200}) {
        const std::string screen =
            view.screen({.interactive = true, .colour = colour, .columns = columns, .rows = rows});
        EXPECT_LT(std::count(screen.begin(), screen.end(), '\n'), rows);
        std::size_t begin = 0;
        for (std::size_t end = screen.find('\n'); end != std::string::npos;
             begin = end + 1, end = screen.find('\n', begin)) {
          EXPECT_LE(columns_of(screen.substr(begin, end - begin)),
                    static_cast<std::size_t>(columns));
        }
      }
    }
  }
}

TEST(LiveView, DrawsThePreview) {
  LiveView view;
  static_cast<void>(view.take(message("status", armed())));
  v1::Preview preview;
  preview.set_step_s(1e-3);
  v1::ChannelPreview& channel = *preview.add_channels();
  channel.set_gauge("g1");
  for (v1::Waveform* waveform : {channel.mutable_minimum(), channel.mutable_maximum()}) {
    waveform->set_unit("strain");
    waveform->set_dtype(v1::Waveform::INT16);
    waveform->set_scale(1e-6);
    waveform->mutable_converter()->set_bits(16);
    waveform->mutable_converter()->set_code_min(-32768);
    waveform->mutable_converter()->set_code_max(32767);
  }
  channel.mutable_minimum()->set_data(std::string("\x9c\xff\x9c\xff", 4));  // -100, -100
  channel.mutable_maximum()->set_data(std::string("\x64\x00\x64\x00", 4));  // 100, 100
  static_cast<void>(view.take(message("preview", preview)));
  const std::string screen = view.screen({});
  EXPECT_NE(screen.find("2 ms: -100 to 100 microstrain\n"), std::string::npos) << screen;
  EXPECT_NE(screen.find("⣿"), std::string::npos) << screen;
}

TEST(StoreLine, SaysThatShotsWaitForRoom) {
  v1::Status status;
  status.set_triggers(39);
  status.set_shots_stored(1);
  status.set_disk_free_bytes(2'000'000);
  EXPECT_NE(store_line(status).find("the disk is full"), std::string::npos);
  status.set_shots_stored(39);
  EXPECT_EQ(store_line(status).find("the disk is full"), std::string::npos) << "none waits";
  status.set_shots_stored(1);
  status.set_disk_free_bytes(2'000'000'000);
  EXPECT_EQ(store_line(status).find("the disk is full"), std::string::npos);
}

}  // namespace
}  // namespace kolsky::cli
