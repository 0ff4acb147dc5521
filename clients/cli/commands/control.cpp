#include <chrono>
#include <functional>
#include <memory>
#include <ostream>
#include <thread>

#include "clients/cli/command.hpp"
#include "clients/cli/daemon_shot.hpp"
#include "clients/cli/reports/daemon_text.hpp"
#include "clients/figure/layout.hpp"
#include "processing/base/error.hpp"

namespace kolsky::cli {
namespace {

int show_status(Context& context) {
  ControlClient client = connect(context.endpoint);
  const v1::Status status = client.status();
  if (context.json) {
    context.out << to_text(describe(status)) << "\n";
    return kDone;
  }
  const bool colour = context.terminal.colour;
  context.out << headline(status, colour) << "\n"
              << counters_line(status, colour) << "\n"
              << store_line(status) << "\n"
              << "bench " << status.bench_path() << ", store " << status.store_folder() << "\n";
  for (const v1::ChannelStatus& channel : status.channels()) {
    context.out << "  " << channel_line(channel) << "\n";
  }
  if (!status.last_shot_id().empty()) {
    context.out << "last shot " << status.last_shot_id() << "\n";
  }
  if (!status.model_path().empty()) {
    context.out << "compares with " << status.model_path() << "\n";
  }
  if (status.has_comparison()) {
    context.out << comparison_line(status.comparison(), colour) << "\n"
                << "  " << status.comparison().rule() << "\n";
  }
  if (status.has_diagnosis()) {
    context.out << diagnosis_line(status.diagnosis()) << "\n";
  }
  return kDone;
}

[[noreturn]] void refuse(const v1::ControlReply& reply) {
  if (reply.has_problem()) {
    throw InputError(reply.problem().place(), reply.problem().what(), reply.problem().mend());
  }
  throw InputError("kolskyd", reply.error(), "see kolsky status");
}

int arm(Context& context) {
  ControlClient client = connect_patiently(context.endpoint);
  v1::ControlRequest request;
  request.mutable_arm();
  const v1::ControlReply reply = client.request(request);
  if (context.json && reply.ok()) {
    context.out << to_text(JsonObject{{"armed", true}, {"checks", describe(reply.preflight())}})
                << "\n";
  } else if (!context.json) {
    context.out << preflight_text(reply.preflight(), context.terminal.colour)
                << (reply.ok() ? "armed\n" : "");
  }
  if (!reply.ok()) {
    refuse(reply);
  }
  return kDone;
}

// Waits until there is a result of a shot after `previous`.
std::string wait_for_result(ControlClient& client, const std::string& previous, double patience_s) {
  using Clock = std::chrono::steady_clock;
  constexpr auto kPause = std::chrono::milliseconds(50);
  const auto end = Clock::now() + std::chrono::duration<double>(patience_s);
  do {
    std::string id = client.status().last_shot_id();
    if (id != previous && client.get_shot(id).has_result()) {
      return id;
    }
    std::this_thread::sleep_for(kPause);
  } while (Clock::now() < end);
  throw InputError("kolskyd", "no result within " + with_unit(patience_s, "s"),
                   "is it armed? see kolsky status");
}

using Action = std::function<void(ControlClient&)>;

void print(Context& context, const JsonValue& object, const std::string& line) {
  context.out << (context.json ? to_text(object) : line) << "\n";
}

int act(const Action& action, const std::string& done, Context& context) {
  ControlClient client = connect_patiently(context.endpoint);
  action(client);
  print(context, JsonObject{{"done", done}}, done);
  return kDone;
}

int act_and_wait(const Action& action, const std::string& done, std::optional<double> patience_s,
                 Context& context) {
  if (!patience_s.has_value()) {
    return act(action, done, context);
  }
  if (!(*patience_s > 0.0)) {
    throw InputError("--wait", "is not a time to wait", "give more than 0 seconds");
  }
  ControlClient client = connect_patiently(context.endpoint);
  const std::string previous = client.status().last_shot_id();
  action(client);
  const std::string id = wait_for_result(client, previous, *patience_s);
  print(context, JsonObject{{"done", done}, {"shot", id}}, done + ": shot " + id);
  return kDone;
}

Command daemon_command(const std::string& name, const std::string& purpose) {
  Command command;
  command.name = name;
  command.purpose = purpose;
  command.examples = "  kolsky " + name + "\n";
  command.uses_daemon = true;
  return command;
}

Command simple_command(const std::string& name, const std::string& purpose, const Action& action,
                       const std::string& done) {
  Command command = daemon_command(name, purpose);
  command.run = [action, done](Context& context) { return act(action, done, context); };
  return command;
}

Command shot_command(const std::string& name, const std::string& purpose, const Action& action,
                     const std::string& done) {
  auto patience_s = std::make_shared<std::optional<double>>();
  Command command = daemon_command(name, purpose);
  command.examples += "  kolsky " + name + " --wait 10\n";
  command.arguments = {
      option("--wait", "S", "wait for the shot's result, so many seconds at most, and print its id",
             patience_s.get())};
  command.run = [=](Context& context) { return act_and_wait(action, done, *patience_s, context); };
  return command;
}

}  // namespace

Command status_command() {
  Command command = daemon_command(
      "status",
      "what the daemon does, reads and has lost\n"
      "State, digitiser, counts since its start, noise and trigger level of each gauge.");
  command.examples += "  kolsky status --endpoint tcp://127.0.0.1:5602 --json\n";
  command.run = show_status;
  return command;
}

Command arm_command() {
  Command command = daemon_command(
      "arm",
      "make the daemon wait for a shot, after a preflight of disk, ring, balance and noise\n"
      "Takes the lease: until it is released, or silent for long, no other operator can act.");
  command.run = arm;
  return command;
}

Command disarm_command() {
  return simple_command(
      "disarm",
      "stop waiting for shots; streaming and preview go on\n"
      "What was triggered already is stored and published.",
      [](ControlClient& client) { client.disarm(); }, "disarmed");
}

Command fire_command() {
  return shot_command(
      "fire",
      "ask a simulated digitiser for its pulse\n"
      "Refused on hardware and replays: nothing here actuates a gun.",
      [](ControlClient& client) { client.fire(); }, "fired");
}

Command force_trigger_command() {
  return shot_command(
      "force-trigger",
      "take a window now, without a pulse\n"
      "For looking at noise and baselines: stored like any shot.",
      [](ControlClient& client) { client.force_trigger(); }, "triggered");
}

Command reload_command() {
  return simple_command(
      "reload",
      "make the daemon read its configuration and bench again\n"
      "Only while disarmed; a file that is wrong is refused and the old one stays.",
      [](ControlClient& client) { client.reload(); }, "reloaded");
}

Command release_command() {
  return simple_command(
      "release",
      "give the lease back, so that another operator can act\n"
      "The daemon stays armed or disarmed as it is.",
      [](ControlClient& client) { client.release(); }, "released");
}

Command stop_command() {
  return simple_command(
      "stop",
      "end the daemon, after it has stored what it took\n"
      "Shots are not lost by any other end either: it recovers them at its next start.",
      [](ControlClient& client) { client.stop(); }, "stopping");
}

}  // namespace kolsky::cli
