#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <ostream>

#include "clients/cli/command.hpp"
#include "clients/cli/reports/json_value.hpp"
#include "clients/cli/reports/reduced_shot.hpp"
#include "drivers/files/store/store.hpp"
#include "processing/base/error.hpp"

namespace kolsky::cli {
namespace {

using Kind = StoreReport::Problem::Kind;

const char* name_of(Kind kind) {
  switch (kind) {
    case Kind::damaged:
      return "damaged";
    case Kind::missing:
      return "missing";
    case Kind::in_journal:
      break;
  }
  return "in-journal";
}

JsonValue describe(const StoreReport& found, const std::string& store) {
  JsonList problems;
  for (const StoreReport::Problem& problem : found.problems) {
    problems.push_back(JsonObject{
        {"file", problem.file}, {"text", problem.text}, {"kind", name_of(problem.kind)}});
  }
  return JsonObject{{"store", absolute_name(store)},
                    {"sound", found.problems.empty()},
                    {"journals", static_cast<std::uint64_t>(found.journals)},
                    {"journaled_shots", static_cast<std::uint64_t>(found.journaled_shots)},
                    {"captures", static_cast<std::uint64_t>(found.captures)},
                    {"bytes_ignored", found.bytes_ignored},
                    {"catalogue_checked", found.catalogue_read},
                    {"problems", std::move(problems)}};
}

std::string text_of(const StoreReport& found, const std::string& store) {
  std::string text = fmt::format("{}: {} journals with {} shots, {} captures", store,
                                 found.journals, found.journaled_shots, found.captures);
  if (found.bytes_ignored > 0) {
    text +=
        fmt::format(", {} bytes of records that a crash cut short (harmless)", found.bytes_ignored);
  }
  text += found.problems.empty() ? ": every checksum is right\n" : "\n";
  if (!found.catalogue_read) {
    text +=
        "  catalogue.sqlite: is not there or cannot be read now, so captures that only it knows "
        "of are not missed; kolskyd makes it anew from the captures\n";
  }
  for (const StoreReport::Problem& problem : found.problems) {
    text += "  " + problem.file + ": " + problem.text + "\n";
  }
  return text;
}

std::string first_of(const StoreReport& found, bool in_journal) {
  const auto first = std::find_if(
      found.problems.begin(), found.problems.end(),
      [&](const auto& problem) { return (problem.kind == Kind::in_journal) == in_journal; });
  return first->file + ": " + first->text;
}

[[noreturn]] void refuse(const StoreReport& found, const std::string& store) {
  const auto in_journals =
      std::count_if(found.problems.begin(), found.problems.end(),
                    [](const auto& problem) { return problem.kind == Kind::in_journal; });
  const auto lost = static_cast<std::ptrdiff_t>(found.problems.size()) - in_journals;
  if (lost == 0) {
    throw InputError(
        store, fmt::format("{} in journals only, first {}", in_journals, first_of(found, true)),
        "nothing is lost: start kolskyd on this store, and it files them");
  }
  throw InputError(
      store, fmt::format("{} damaged or missing, first {}", lost, first_of(found, false)),
      "restore those files from a backup; the others are sound" +
          (in_journals == 0 ? std::string()
                            : fmt::format(", and {} more are whole in journals, kolskyd files them",
                                          in_journals)));
}

int run(const std::string& store, Context& context) {
  const StoreReport found = verify_store({store});
  context.out << (context.json ? to_text(describe(found, store)) + "\n" : text_of(found, store));
  if (!found.problems.empty()) {
    refuse(found, store);
  }
  return kDone;
}

}  // namespace

Command verify_command() {
  auto store = std::make_shared<std::string>();
  Command command;
  command.name = "verify";
  command.purpose =
      "check every journal and capture of a store against its checksums\n"
      "And that every shot of journals and catalogue has its capture.\n"
      "Changes nothing. Exit code 0: all sound; 2: something is damaged, and it says what.";
  command.examples = "  kolsky verify store\n";
  command.arguments = {
      needed("STORE", "", "the store's folder, as in kolskyd's configuration", store.get())};
  command.run = [store](Context& context) { return run(*store, context); };
  return command;
}

}  // namespace kolsky::cli
