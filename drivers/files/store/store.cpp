#include "drivers/files/store/store.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "drivers/files/captures/capture.hpp"
#include "drivers/files/captures/capture_seal.hpp"
#include "drivers/files/captures/new_file.hpp"
#include "drivers/files/captures/shot_codec.hpp"
#include "drivers/files/sha256.hpp"
#include "drivers/files/store/catalogue.hpp"
#include "drivers/files/store/journal_scan.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

/// What two copies of a shot are compared by.
struct Fingerprint {
  std::string metadata;
  std::string everything;
  friend bool operator==(const Fingerprint&, const Fingerprint&) = default;
};

Fingerprint fingerprint_of(const Shot& shot) {
  std::vector<std::byte> bytes;
  encode_shot(shot, bytes);
  return {sha256_hex(encode_metadata(shot)), sha256_hex(bytes)};
}

struct JournaledShot {
  Fingerprint fingerprint;
  std::string journal;
  bool captured = false;  ///< a capture was read that says the same
};

using JournaledShots = std::map<std::string, JournaledShot>;

void add_problem(StoreReport& report, const InputError& error) {
  report.problems.push_back({error.place(), error.problem() + "; " + error.mend()});
}

std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder,
                                            const std::string& extension) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& item : std::filesystem::directory_iterator(folder, error)) {
    if (item.path().extension() == extension && item.path().filename().string().front() != '.') {
      files.push_back(item.path());
    }
  }
  if (error) {
    throw InputError(folder.string(), "cannot be read (" + error.message() + ")",
                     "name a store: a folder with journal/ and shots/ in it");
  }
  std::sort(files.begin(), files.end());
  return files;
}

struct DoneJournal {
  std::filesystem::path path;
  std::size_t shots = 0;
};

struct Journaled {
  JournaledShots shots;
  std::vector<DoneJournal> done;  ///< journals without damage, all of it captured
};

/// Hands on every whole shot of a journal that is not known yet; a shot journaled twice the same
/// counts once.
/// @param visit  returns whether a capture was read that says the same
/// @return how many shots it holds, where it is without damage and all of it captured
template <typename Visit>
std::optional<std::size_t> visit_journal(const std::filesystem::path& path, JournaledShots& shots,
                                         StoreReport& report, const Visit& visit) {
  ++report.journals;
  bool captured = true;
  std::size_t count = 0;
  try {
    const auto scan = scan_journal(path, [&](const JournalRecord& record) {
      if (record.kind != journal_record::Kind::shot) {
        return;
      }
      const Shot shot = journaled_shot(record);
      ++count;
      const Fingerprint fingerprint = fingerprint_of(shot);
      const auto [known, first] =
          shots.try_emplace(shot.id, JournaledShot{fingerprint, path.string()});
      if (first) {
        ++report.journaled_shots;
        known->second.captured = visit(shot, known->second);
      }
      captured = captured && known->second.captured && known->second.fingerprint == fingerprint;
      if (known->second.fingerprint != fingerprint) {
        report.problems.push_back({path.string(), "holds a second, different shot " + shot.id +
                                                      " (the first is in " + known->second.journal +
                                                      "); it stays in the journal only"});
      }
    });
    report.bytes_ignored += scan.bytes_ignored;
    for (const JournalProblem& problem : scan.problems) {
      report.problems.push_back(
          {path.string(), "byte " + std::to_string(problem.offset) + ": " + problem.text});
    }
    if (captured && scan.problems.empty()) {
      return count;
    }
  } catch (const InputError& error) {
    add_problem(report, error);
  }
  return std::nullopt;
}

template <typename Visit>
Journaled visit_journals(const StoreLayout& store, StoreReport& report, const Visit& visit) {
  Journaled found;
  for (const auto& path : files_in(store.journals(), ".kj")) {
    if (!std::filesystem::exists(path)) {
      continue;  // a running daemon has just removed it
    }
    if (const auto shots = visit_journal(path, found.shots, report, visit)) {
      found.done.push_back({path, *shots});
    }
  }
  return found;
}

/// @return whether they are the same
bool compare(const std::filesystem::path& capture, const Fingerprint& stored,
             const JournaledShot& journaled, StoreReport& report) {
  if (stored == journaled.fingerprint) {
    return true;
  }
  const bool codes = stored.metadata == journaled.fingerprint.metadata;
  report.problems.push_back(
      {capture.string(), std::string(codes ? "the codes differ" : "the shot differs") +
                             " from what " + journaled.journal +
                             " holds; neither is overwritten, compare them"});
  return false;
}

bool is_damaged(const std::filesystem::path& capture) {
  try {
    check_seal(capture);
    return false;
  } catch (const InputError&) {
    return true;
  }
}

void check_capture(const std::filesystem::path& path, const JournaledShots& journaled,
                   StoreReport& report) {
  try {
    const Shot shot = read_capture(path);
    if (path.stem() != shot.id) {
      report.problems.push_back(
          {path.string(), "holds the shot " + shot.id + "; give the file the name of its shot"});
    }
    if (const auto known = journaled.find(shot.id); known != journaled.end()) {
      compare(path, fingerprint_of(shot), known->second, report);
    }
  } catch (const InputError& error) {
    const auto known = journaled.find(path.stem().string());
    if (known == journaled.end() || !is_damaged(path)) {
      add_problem(report, error);
      return;
    }
    report.problems.push_back({error.place(),
                               error.problem() + "; " + known->second.journal +
                                   " has the shot: the daemon restores it at its next start",
                               StoreReport::Problem::Kind::in_journal});
  }
}

/// @return whether a capture was read that says the same
bool captured_alike(const std::filesystem::path& capture, const JournaledShot& journaled,
                    StoreReport& report) {
  try {
    return compare(capture, fingerprint_of(read_capture(capture)), journaled, report);
  } catch (const InputError& error) {
    add_problem(report, error);
    return false;
  }
}

/// Gives a damaged capture another name, so that the journal's copy can take its place.
void set_aside(const std::filesystem::path& capture, StoreReport& report) {
  for (int i = 1;; ++i) {
    const std::string name =
        capture.string() + ".damaged" + (i == 1 ? "" : "-" + std::to_string(i));
    if (rename_without_overwriting(capture, name)) {
      report.set_aside.push_back(name);
      return;
    }
  }
}

/// @return whether a capture was read that says the same
bool recover_shot(const Shot& shot, const JournaledShot& journaled,
                  const std::filesystem::path& capture, StoreReport& report) {
  try {
    const bool exists = std::filesystem::exists(std::filesystem::symlink_status(capture));
    if (exists && is_damaged(capture)) {
      set_aside(capture, report);
    } else if (exists) {
      return captured_alike(capture, journaled, report);
    }
    write_capture(shot, capture);
    report.recovered.push_back(shot.id);
  } catch (const InputError& error) {
    add_problem(report, error);
    return false;
  }
  return captured_alike(capture, journaled, report);
}

/// A capture may have been renamed just before a crash: its name must reach the disk before the
/// journal's leaves it.
void prune(const StoreLayout& store, const std::vector<DoneJournal>& journals,
           StoreReport& report) {
  if (journals.empty()) {
    return;
  }
  sync_folder(store.shots());
  for (const auto& [journal, shots] : journals) {
    std::error_code error;
    if (std::filesystem::remove(journal, error)) {
      report.pruned.push_back(journal.string());
      report.pruned_shots += shots;
    } else if (error) {
      report.problems.push_back({journal.string(), "cannot be removed (" + error.message() + ")"});
    }
  }
  sync_folder(store.journals());
}

void check_listed(const StoreLayout& store, const std::vector<CatalogueEntry>& listed,
                  const JournaledShots& journaled, StoreReport& report) {
  for (const CatalogueEntry& entry : listed) {
    const std::filesystem::path capture = store.shots() / entry.capture;
    std::error_code ignored;
    if (!journaled.contains(entry.id) && !std::filesystem::exists(capture, ignored)) {
      report.problems.push_back(
          {capture.string(),
           "is missing: the catalogue lists it, and no journal has it; if it was removed on "
           "purpose, remove " +
               store.catalogue().filename().string() + ", which is made anew",
           StoreReport::Problem::Kind::missing});
    }
  }
}

}  // namespace

void StoreLayout::create() const {
  for (const auto& folder : {root, journals(), shots()}) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) {
      throw InputError(folder.string(), "cannot be made (" + error.message() + ")",
                       "check the folder and its permissions");
    }
  }
  sync_folder(root);
}

StoreReport verify_store(const StoreLayout& store) {
  StoreReport report;
  const auto listed = read_catalogue(store.catalogue());
  report.catalogue_read = listed.has_value();
  const auto nothing_read = [](const Shot&, const JournaledShot&) { return false; };
  const JournaledShots journaled = visit_journals(store, report, nothing_read).shots;
  for (const auto& path : files_in(store.shots(), ".h5")) {
    ++report.captures;
    check_capture(path, journaled, report);
  }
  for (const auto& [id, shot] : journaled) {
    if (std::error_code ignored; !std::filesystem::exists(store.capture_of(id), ignored)) {
      report.problems.push_back({shot.journal,
                                 "holds the shot " + id + ", which has no capture; the daemon " +
                                     "writes it as it runs, or at its next start",
                                 StoreReport::Problem::Kind::in_journal});
    }
  }
  if (listed) {
    check_listed(store, *listed, journaled, report);
  }
  return report;
}

StoreReport prune_journal(const StoreLayout& store, const std::filesystem::path& journal) {
  StoreReport report;
  JournaledShots shots;
  const auto read_back = [&](const Shot& shot, const JournaledShot& journaled) {
    return captured_alike(store.capture_of(shot.id), journaled, report);
  };
  if (const auto count = visit_journal(journal, shots, report, read_back)) {
    prune(store, {{journal, *count}}, report);
  }
  return report;
}

StoreReport recover_store(const StoreLayout& store, DoneJournals done) {
  store.create();
  StoreReport report;
  report.temporary_files = remove_abandoned_files(store.shots());
  const auto recover = [&](const Shot& shot, const JournaledShot& journaled) {
    return recover_shot(shot, journaled, store.capture_of(shot.id), report);
  };
  const Journaled journaled = visit_journals(store, report, recover);
  if (done == DoneJournals::prune) {
    prune(store, journaled.done, report);
  }
  report.captures = files_in(store.shots(), ".h5").size();
  return report;
}

StoreReport file_journaled(const StoreLayout& store, const std::set<std::string>& shot_ids) {
  StoreReport report;
  StoreReport filed;
  const auto file = [&](const Shot& shot, const JournaledShot& journaled) {
    if (shot_ids.contains(shot.id) && filed.problems.empty() &&
        recover_shot(shot, journaled, store.capture_of(shot.id), filed)) {
      report.recovered.push_back(shot.id);
    }
    return false;
  };
  static_cast<void>(visit_journals(store, report, file));
  report.problems = std::move(filed.problems);
  report.set_aside = std::move(filed.set_aside);
  return report;
}

}  // namespace kolsky
