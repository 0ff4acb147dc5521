#include <memory>
#include <ostream>

#include "clients/cli/command.hpp"
#include "clients/cli/daemon_shot.hpp"
#include "clients/cli/reports/daemon_text.hpp"
#include "clients/cli/reports/time_text.hpp"
#include "processing/base/error.hpp"

namespace kolsky::cli {
namespace {

int list_shots(std::optional<std::uint64_t> most, Context& context) {
  if (most == 0U) {
    throw InputError("kolsky shots: --most", "0 shots are none",
                     "give 1 or more, or leave it out for all");
  }
  ControlClient client = connect_patiently(context.endpoint);
  const v1::ShotList shots = client.list_shots(most.value_or(0));
  if (context.json) {
    JsonList list;
    for (const v1::ShotSummary& shot : shots.shots()) {
      list.push_back(describe(shot));
    }
    context.out << to_text(JsonObject{{"shots", std::move(list)}}) << "\n";
    return kDone;
  }
  if (shots.shots().empty()) {
    context.out << "no shots yet\n";
  }
  for (const v1::ShotSummary& shot : shots.shots()) {
    context.out << short_time(shot.utc_ns()) << "  " << shot_line(shot, context.terminal.colour)
                << "\n";
  }
  return kDone;
}

struct GetSettings {
  std::string id;
  bool with_true = false;
};

int get(const GetSettings& settings, Context& context) {
  ControlClient client = connect_patiently(context.endpoint);
  ReducedShot shot = fetch_shot(client, settings.id);
  shot.request.with_true = shot.request.with_true || settings.with_true;
  context.out << (context.json ? to_text(describe(shot)) + "\n" : report(shot, context.terminal));
  return kDone;
}

}  // namespace

Command shots_command() {
  auto most = std::make_shared<std::optional<std::uint64_t>>();
  Command command;
  command.name = "shots";
  command.purpose =
      "the shots in the daemon's store, newest first\n"
      "Id, time (UTC), verdict, peak stress and strain; --json also names each capture's file.";
  command.examples = "  kolsky shots --most 10\n";
  command.uses_daemon = true;
  command.arguments = {option("--most", "N", "how many at most; else all", most.get())};
  command.run = [most](Context& context) { return list_shots(*most, context); };
  return command;
}

Command get_command() {
  auto settings = std::make_shared<GetSettings>();
  Command command;
  command.name = "get";
  command.purpose =
      "a shot's result from the daemon, as reduce shows it\n"
      "With --json the same numbers, to the bit, as reduce --json for that capture.";
  command.examples = "  kolsky get last\n  kolsky get last --json > shot.json\n";
  command.uses_daemon = true;
  command.arguments = {needed("ID", "", "the shot's id, as shots lists it, or last", &settings->id),
                       flag("--true", kTrueHelp, &settings->with_true)};
  command.run = [settings](Context& context) { return get(*settings, context); };
  return command;
}

}  // namespace kolsky::cli
