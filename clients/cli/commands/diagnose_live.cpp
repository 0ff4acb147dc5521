#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iostream>
#include <memory>
#include <ostream>
#include <thread>

#include "clients/cli/command.hpp"
#include "clients/cli/daemon_shot.hpp"
#include "clients/cli/reports/daemon_text.hpp"
#include "clients/cli/reports/diagnosis_text.hpp"
#include "processing/base/error.hpp"

namespace kolsky::cli {
namespace {

constexpr auto kPause = std::chrono::milliseconds(200);
constexpr std::uint64_t kMostShots = 256;

struct Settings {
  std::vector<std::string> ids;
  std::optional<std::uint64_t> shots;
  bool no_wait = false;
  bool cancel = false;
  bool last = false;
};

v1::ControlReply ask(ControlClient& client, const v1::ControlRequest& request) {
  v1::ControlReply reply = client.request(request);
  if (!reply.ok()) {
    throw InputError(reply.problem().place(), reply.problem().what(), reply.problem().mend());
  }
  return reply;
}

v1::Diagnosis look(ControlClient& client) {
  v1::ControlRequest request;
  request.mutable_diagnosis();
  return ask(client, request).diagnosis();
}

/// Until it ends; its steps go to stderr.
v1::Diagnosis wait(ControlClient& client, v1::Diagnosis diagnosis, bool tell) {
  const std::string id = diagnosis.summary().id();
  std::string step;
  while (diagnosis.summary().state() == v1::DiagnosisSummary::RUNNING) {
    if (tell && diagnosis.summary().step() != step) {
      step = diagnosis.summary().step();
      std::cerr << "kolsky: " << step << "\n";
    }
    std::this_thread::sleep_for(kPause);
    diagnosis = look(client);
    if (diagnosis.summary().id() != id) {
      throw InputError("diagnosis " + id, "was followed by another, " + diagnosis.summary().id(),
                       "its outcome is in the store's folder diagnoses");
    }
  }
  return diagnosis;
}

constexpr std::array kVerdicts{DiagnosisVerdict::named,      DiagnosisVerdict::tied,
                               DiagnosisVerdict::unknown,    DiagnosisVerdict::adequate,
                               DiagnosisVerdict::untestable, DiagnosisVerdict::bad_data};
constexpr std::array kVerdictsOfCandidates{
    CandidateVerdict::named,       CandidateVerdict::tied,       CandidateVerdict::rejected,
    CandidateVerdict::unconfirmed, CandidateVerdict::not_needed, CandidateVerdict::untestable};

/// @param all  that this version knows
template <typename Verdict, std::size_t n>
Verdict verdict_named(const std::string& name, const std::array<Verdict, n>& all) {
  const auto found = std::find_if(
      all.begin(), all.end(), [&](Verdict verdict) { return kolsky::name_of(verdict) == name; });
  if (found == all.end()) {
    throw InputError("kolskyd", "says \"" + name + "\", a verdict that this version does not know",
                     "use a client of the daemon's version");
  }
  return *found;
}

CandidateResult candidate_of(const v1::DiagnosisCandidate& message) {
  CandidateResult candidate;
  candidate.effect = message.effect();
  candidate.parameter = message.parameter();
  candidate.unit = message.unit();
  candidate.strength = message.strength();
  candidate.sd = message.sd();
  candidate.own_log_p = std::log(message.p_value());
  candidate.log_p = message.log_p();
  candidate.gain = message.gain();
  candidate.held_out_gain = message.held_out_gain();
  candidate.detectable = message.smallest_detectable();
  candidate.identifiable = message.smallest_identifiable();
  candidate.nearest_rival = message.nearest_rival();
  candidate.verdict = verdict_named(message.verdict(), kVerdictsOfCandidates);
  return candidate;
}

/// What the daemon found, as `kolsky diagnose` has it.
Diagnosis found(const v1::Diagnosis& message) {
  Diagnosis diagnosis;
  diagnosis.verdict = verdict_named(message.summary().verdict(), kVerdicts);
  for (const std::string& id : message.summary().effects()) {
    diagnosis.effects.push_back(id);
    std::vector<std::string>& ties = diagnosis.tied_with[id];
    if (const auto own = message.tied_with().find(id); own != message.tied_with().end()) {
      ties.assign(own->second.items().begin(), own->second.items().end());
    }
  }
  const v1::HeldOut& held_out = message.misfit().held_out();
  diagnosis.held_out = {held_out.before(), held_out.after(), held_out.floor()};
  for (const v1::DiagnosisCandidate& candidate : message.candidates()) {
    diagnosis.candidates.push_back(candidate_of(candidate));
  }
  for (const v1::NextExperiment& next : message.next_experiment()) {
    diagnosis.next_experiment.push_back(
        {next.change(), {next.separates().begin(), next.separates().end()}});
  }
  diagnosis.notes.assign(message.notes().begin(), message.notes().end());
  if (!diagnosis.candidates.empty()) {
    diagnosis.model.emplace();  // one was fitted; it stays with the daemon
  }
  return diagnosis;
}

void print(const v1::Diagnosis& diagnosis, Context& context) {
  if (context.json) {
    context.out << to_text(describe(diagnosis)) << "\n";
    return;
  }
  context.out << diagnosis_line(diagnosis.summary()) << "\n";
  if (diagnosis.summary().state() == v1::DiagnosisSummary::DONE) {
    context.out << diagnosis_text(found(diagnosis));
  }
  if (!diagnosis.stored_as().empty()) {
    context.out << "  stored as " << diagnosis.stored_as() << "\n";
  }
}

v1::Diagnosis begin(const Settings& settings, ControlClient& client) {
  v1::ControlRequest request;
  v1::Diagnose& asked = *request.mutable_diagnose();
  if (settings.shots && (*settings.shots == 0 || *settings.shots > kMostShots)) {
    throw InputError("--shots", "is not from 1 to 256", "give how many of the last shots");
  }
  asked.set_shots(static_cast<std::uint32_t>(settings.shots.value_or(0)));
  asked.mutable_ids()->Add(settings.ids.begin(), settings.ids.end());
  return ask(client, request).diagnosis();
}

int run(const Settings& settings, Context& context) {
  if (settings.shots && !settings.ids.empty()) {
    throw InputError("--shots", "is given beside names of shots", "give one of the two");
  }
  ControlClient client = connect_patiently(context.endpoint);
  if (settings.cancel) {
    v1::ControlRequest request;
    request.mutable_cancel_diagnosis();
    (void)ask(client, request);
    print(wait(client, look(client), false), context);
    return kDone;
  }
  v1::Diagnosis diagnosis = settings.last ? look(client) : begin(settings, client);
  if (!settings.no_wait && !settings.last) {
    diagnosis = wait(client, std::move(diagnosis), !context.json);
  }
  print(diagnosis, context);
  const auto state = diagnosis.summary().state();
  if (state == v1::DiagnosisSummary::FAILED) {
    throw InputError("diagnosis " + diagnosis.summary().id(), diagnosis.summary().step(),
                     "choose other shots, or mend what it names");
  }
  return kDone;
}

}  // namespace

Command diagnose_live_command() {
  auto settings = std::make_shared<Settings>();
  Settings& s = *settings;
  Command command;
  command.name = "diagnose-live";
  command.purpose =
      "has the daemon find what its active model lacks, from shots in its store\n"
      "Off the way of the shots, at the lowest priority; one at a time. The outcome is filed "
      "beside "
      "the\n"
      "captures and printed as `kolsky diagnose` prints it.";
  command.examples =
      "  kolsky diagnose-live --shots 8\n"
      "  kolsky diagnose-live 20250117T101530123Z-1f3a-0001 20250117T101612456Z-1f3a-0002 --json\n"
      "  kolsky diagnose-live --cancel\n";
  command.uses_daemon = true;
  command.arguments = {
      {"ID", "", "shots to diagnose; else the newest", &s.ids, false, {}},
      option("--shots", "N", "so many of the newest; 8 if nothing is said", &s.shots),
      flag("--no-wait", "print under which id it has begun, and end", &s.no_wait),
      flag("--last", "begin nothing: print the one under way, or the last", &s.last),
      flag("--cancel", "end the one under way at its next step", &s.cancel)};
  command.run = [settings](Context& context) { return run(*settings, context); };
  return command;
}

}  // namespace kolsky::cli
