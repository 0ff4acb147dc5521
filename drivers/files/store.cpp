#include "drivers/files/store.hpp"

#include <algorithm>
#include <map>

#include "drivers/files/capture.hpp"
#include "drivers/files/journal_scan.hpp"
#include "drivers/files/new_file.hpp"
#include "drivers/files/sha256.hpp"
#include "drivers/files/shot_codec.hpp"
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

struct Journaled {
  JournaledShots shots;
  std::vector<std::filesystem::path> done;  ///< journals without damage, all of it captured
};

/// Hands on every whole shot of a journal that is not known yet; a shot journaled twice the same
/// counts once.
/// @param visit  returns whether a capture was read that says the same
/// @return whether the journal is without damage and all of it captured
template <typename Visit>
bool visit_journal(const std::filesystem::path& path, JournaledShots& shots, StoreReport& report,
                   const Visit& visit) {
  ++report.journals;
  bool captured = true;
  try {
    const auto scan = scan_journal(path, [&](const JournalRecord& record) {
      if (record.kind != journal_record::Kind::shot) {
        return;
      }
      const Shot shot = journaled_shot(record);
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
    return captured && scan.problems.empty();
  } catch (const InputError& error) {
    add_problem(report, error);
    return false;
  }
}

template <typename Visit>
Journaled visit_journals(const StoreLayout& store, StoreReport& report, const Visit& visit) {
  Journaled found;
  for (const auto& path : files_in(store.journals(), ".kj")) {
    if (!std::filesystem::exists(path)) {
      continue;  // a running daemon has just removed it
    }
    if (visit_journal(path, found.shots, report, visit)) {
      found.done.push_back(path);
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
    add_problem(report, error);
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

/// @return whether a capture was read that says the same
bool recover_shot(const Shot& shot, const JournaledShot& journaled,
                  const std::filesystem::path& capture, StoreReport& report) {
  try {
    if (!std::filesystem::exists(std::filesystem::symlink_status(capture))) {
      write_capture(shot, capture);
      report.recovered.push_back(shot.id);
    }
  } catch (const InputError& error) {
    add_problem(report, error);
    return false;
  }
  return captured_alike(capture, journaled, report);
}

/// A capture may have been renamed just before a crash: its name must reach the disk before the
/// journal's leaves it.
void prune(const StoreLayout& store, const std::vector<std::filesystem::path>& journals,
           StoreReport& report) {
  if (journals.empty()) {
    return;
  }
  sync_folder(store.shots());
  for (const auto& journal : journals) {
    std::error_code error;
    if (std::filesystem::remove(journal, error)) {
      report.pruned.push_back(journal.string());
    } else if (error) {
      report.problems.push_back({journal.string(), "cannot be removed (" + error.message() + ")"});
    }
  }
  sync_folder(store.journals());
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
  const auto nothing_read = [](const Shot&, const JournaledShot&) { return false; };
  const JournaledShots journaled = visit_journals(store, report, nothing_read).shots;
  for (const auto& path : files_in(store.shots(), ".h5")) {
    ++report.captures;
    check_capture(path, journaled, report);
  }
  for (const auto& [id, shot] : journaled) {
    if (std::error_code ignored; !std::filesystem::exists(store.capture_of(id), ignored)) {
      report.problems.push_back(
          {shot.journal, "holds the shot " + id +
                             ", which has no capture; the daemon writes it at "
                             "its next start"});
    }
  }
  return report;
}

StoreReport prune_journal(const StoreLayout& store, const std::filesystem::path& journal) {
  StoreReport report;
  JournaledShots shots;
  const auto read_back = [&](const Shot& shot, const JournaledShot& journaled) {
    return captured_alike(store.capture_of(shot.id), journaled, report);
  };
  if (visit_journal(journal, shots, report, read_back)) {
    prune(store, {journal}, report);
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

}  // namespace kolsky
