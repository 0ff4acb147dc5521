#include "daemon/shots/archivist.hpp"

#include <fmt/format.h>

#include <chrono>
#include <future>
#include <set>

#include "daemon/log.hpp"
#include "daemon/shots/shot_id.hpp"
#include "daemon/shots/summary.hpp"
#include "drivers/files/captures/capture.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

constexpr std::chrono::seconds kPatience{20};
constexpr std::chrono::milliseconds kLook{50};
constexpr std::size_t kMostKeptCodes = std::size_t{1} << 24U;  // 64 MiB

bool is_capture_name(const std::filesystem::path& path) {
  return path.extension() == ".h5" && path.filename().string().front() != '.';
}

}  // namespace

Archivist::Archivist(StoreLayout store, SharedJournal& journal, FaultSink fault,
                     std::chrono::milliseconds retry)
    : store_(std::move(store)), journal_(journal), fault_(std::move(fault)), retry_(retry) {}

Archivist::~Archivist() {
  stop();
}

void Archivist::start() {
  tried_ = std::chrono::steady_clock::now();
  submit([this] { complete_catalogue(); });
  thread_ = Thread("kolsky-archive", [this] { run(); });
}

void Archivist::stop() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Archivist::store(std::shared_ptr<const Shot> shot, CatalogueEntry entry) {
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return shots_to_store_.size() < kMostWaiting; });
    ++handed_over_;
    shots_to_store_.emplace_back(
        [this, shot = std::move(shot), entry = std::move(entry)] { store_now(shot, entry); });
  }
  changed_.notify_all();
}

void Archivist::submit(Job job) {
  {
    const std::lock_guard lock(mutex_);
    jobs_.push_back(std::move(job));
  }
  changed_.notify_all();
}

void Archivist::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    wait_for_job(lock);
    const Job job = take_job();
    if (!job) {
      break;
    }
    busy_ = true;
    lock.unlock();
    do_job(job);
    progress_.fetch_add(1);
    lock.lock();
    busy_ = false;
    changed_.notify_all();
  }
  lock.unlock();
  file_unfiled();
}

Archivist::Job Archivist::take_job() {
  std::deque<Job>& from = shots_to_store_.empty() ? jobs_ : shots_to_store_;
  if (from.empty()) {
    return {};
  }
  Job job = std::move(from.front());
  from.pop_front();
  return job;
}

/// A disk that fails in the midst of tidying up must not take the thread with it, on which every
/// later shot depends.
void Archivist::do_job(const Job& job) {
  try {
    job();
  } catch (const std::exception& error) {
    fault_(fmt::format("the store: {}", error.what()));
  }
}

/// Whoever keeps asking must not keep what is left over from its turn.
void Archivist::wait_for_job(std::unique_lock<std::mutex>& lock) {
  const auto ready = [&] { return stop_ || !jobs_.empty() || !shots_to_store_.empty(); };
  if (unfiled_.empty() && catalogue_complete_) {
    tried_ = std::chrono::steady_clock::now();
    changed_.wait(lock, ready);
    return;
  }
  changed_.wait_until(lock, tried_ + retry_, ready);
  if (const auto now = std::chrono::steady_clock::now(); !stop_ && now >= tried_ + retry_) {
    tried_ = now;
    jobs_.emplace_back([this] { try_again(); });
  }
}

bool Archivist::idle() const {
  const std::lock_guard lock(mutex_);
  return jobs_.empty() && shots_to_store_.empty() && !busy_;
}

bool Archivist::ends() const {
  const std::lock_guard lock(mutex_);
  return stop_;
}

void Archivist::await_expected() {
  const std::uint64_t expected = expected_.load();
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, kPatience, [&] { return handed_over_ >= expected; });
}

template <typename Ask>
auto Archivist::ask(Ask question) -> decltype(question()) {
  // Shared with the job: the answer may come after the asker has given up.
  auto task = std::make_shared<std::packaged_task<decltype(question())()>>(std::move(question));
  auto answer = task->get_future();
  await_expected();
  submit([task] { (*task)(); });
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (answer.wait_for(kLook) != std::future_status::ready) {
    if (ends()) {
      throw InputError("store", "kolskyd is ending", "ask again once it runs");
    }
    if (std::chrono::steady_clock::now() > until) {
      throw InputError("store", "busy with other shots", "ask again");
    }
  }
  return answer.get();
}

StoredShot Archivist::get(const std::string& id) {
  return ask([this, id] {
    const std::optional<CatalogueEntry> entry = catalogue().find(id);
    if (const auto waiting = unfiled_.find(id); waiting != unfiled_.end()) {
      throw InputError(
          "shot " + id,
          std::string("is ") + (waiting->second.shot ? "in memory" : "in the journal") +
              " only, its capture could not be written yet (" + waiting->second.reason + ")",
          "make room in " + store_.root.string() + ": it is filed by itself then");
    }
    if (!entry) {
      throw InputError("shot '" + id + "'", "is not in the store", "`kolsky shots` lists them");
    }
    const std::filesystem::path capture = store_.shots() / entry->capture;
    if (!std::filesystem::exists(capture)) {
      throw InputError(capture.string(), "is missing", "restore it from a backup");
    }
    StoredShot stored;
    stored.shot = read_capture(capture);
    stored.reduction = reduce_or_say_why(reducer_, stored.shot);
    stored.capture = capture.string();
    return stored;
  });
}

std::vector<CatalogueEntry> Archivist::newest(std::size_t most) {
  return ask([this, most] { return catalogue().newest(most); });
}

Catalogue& Archivist::catalogue() {
  if (!catalogue_) {
    catalogue_ = std::make_unique<Catalogue>(store_.catalogue());
  }
  return *catalogue_;
}

void Archivist::store_now(const std::shared_ptr<const Shot>& shot, CatalogueEntry entry) {
  try {
    write_capture(*shot, store_.capture_of(shot->id));
    enter_stored(shot->id, entry);
    file_unfiled();
  } catch (const std::exception& error) {
    failed_.fetch_add(1);
    fault_(fmt::format("shot {}: {}; it is tried again", shot->id, error.what()));
    keep(shot, std::move(entry), error.what());
  }
  tend_journals();
}

void Archivist::enter_stored(const std::string& shot_id, CatalogueEntry entry) {
  const std::filesystem::path capture = store_.capture_of(shot_id);
  entry.capture = capture.filename().string();
  catalogue().put(entry);
  stored_.fetch_add(1);
  try {
    journal_.append_stored(shot_id, capture);
  } catch (const std::exception& error) {
    fault_(
        fmt::format("shot {} is stored, but the journal cannot say so: {}", shot_id, error.what()));
  }
}

void Archivist::keep(const std::shared_ptr<const Shot>& shot, CatalogueEntry entry,
                     std::string reason) {
  const std::size_t codes = shot->samples() * shot->channels.size();
  const bool journaled = journal_.holds(shot->id);
  if (!journaled && kept_codes_ + codes > kMostKeptCodes) {
    fault_(
        fmt::format("shot {} is lost: neither journal nor capture could be written, and too "
                    "many such shots wait in memory",
                    shot->id));
    return;
  }
  kept_codes_ += journaled ? 0 : codes;
  unfiled_[shot->id] = {std::move(entry), journaled ? nullptr : shot, std::move(reason)};
}

void Archivist::try_again() {
  if (!catalogue_complete_) {
    complete_catalogue();
  }
  file_unfiled();
}

void Archivist::file_unfiled() {
  if (unfiled_.empty()) {
    return;
  }
  const std::size_t before = unfiled_.size();
  try {
    file_from_memory();
    file_from_journals();
  } catch (const std::exception& error) {
    log::debug(fmt::format("still not filed: {} shots: {}", unfiled_.size(), error.what()));
  }
  if (unfiled_.size() < before) {
    log::info(fmt::format("filed {} shots that could not be filed before; {} wait",
                          before - unfiled_.size(), unfiled_.size()));
    tend_journals();
  }
}

void Archivist::file_from_memory() {
  for (auto it = unfiled_.begin(); it != unfiled_.end();) {
    const auto& [id, unfiled] = *it;
    if (!unfiled.shot) {
      ++it;
      continue;
    }
    if (!std::filesystem::exists(store_.capture_of(id))) {
      write_capture(*unfiled.shot, store_.capture_of(id));
    }
    enter_stored(id, unfiled.entry);
    kept_codes_ -= unfiled.shot->samples() * unfiled.shot->channels.size();
    it = unfiled_.erase(it);
  }
}

void Archivist::file_from_journals() {
  std::set<std::string> ids;
  for (const auto& [id, unfiled] : unfiled_) {
    ids.insert(id);
  }
  if (ids.empty()) {
    return;
  }
  for (const std::string& id : file_journaled(store_, ids).recovered) {
    enter_stored(id, unfiled_.at(id).entry);
    unfiled_.erase(id);
  }
}

void Archivist::tend_journals() {
  try {
    journal_.turn_over();
  } catch (const InputError& error) {
    fault_(fmt::format("the journal grows on beyond its limit: {}", error.what()));
  }
  for (const std::filesystem::path& done : journal_.take_done()) {
    submit([this, done] { prune(done); });
  }
}

void Archivist::prune(const std::filesystem::path& journal) {
  const StoreReport report = prune_journal(store_, journal);
  for (const StoreReport::Problem& problem : report.problems) {
    fault_(fmt::format("{} stays: {}: {}", journal.string(), problem.file, problem.text));
  }
  if (!report.pruned.empty()) {
    log::info(fmt::format("journal {} removed, its {} shots were read back from their captures",
                          journal.filename().string(), report.pruned_shots));
  }
}

void Archivist::complete_catalogue() {
  try {
    std::set<std::string> known;
    for (const CatalogueEntry& entry : catalogue().newest()) {
      if (!std::filesystem::exists(store_.shots() / entry.capture)) {
        note_missing(entry);
      } else if (!entry.verdict.empty()) {
        known.insert(entry.capture);
      }
    }
    std::size_t unknown = 0;
    for (const auto& file : std::filesystem::directory_iterator(store_.shots())) {
      if (is_capture_name(file.path()) && !known.contains(file.path().filename().string())) {
        submit([this, capture = file.path()] { enter(capture); });
        ++unknown;
      }
    }
    if (unknown != 0) {
      log::info(fmt::format("catalogue: entering {} captures that it does not know", unknown));
      submit([] { log::info("catalogue: complete"); });
    }
    catalogue_complete_ = true;
  } catch (const std::exception& error) {
    note_incomplete(error.what());
  }
}

void Archivist::enter(const std::filesystem::path& capture) {
  if (ends()) {
    return;
  }
  try {
    const Shot shot = read_capture(capture);
    catalogue().put(
        summarise(shot, reduce_or_say_why(reducer_, shot), capture.filename().string()));
  } catch (const InputError& error) {
    fault_(error.what());
    CatalogueEntry entry;
    entry.id = capture.stem().string();
    entry.utc_ns = utc_of_shot_id(entry.id).value_or(0);
    entry.capture = capture.filename().string();
    entry.reason = "its capture cannot be used: " + error.problem();
    catalogue().put(entry);
  } catch (const std::exception& error) {
    note_incomplete(error.what());
  }
}

void Archivist::note_incomplete(const std::string& why) {
  catalogue_complete_ = false;
  const std::string text =
      fmt::format("the catalogue could not be completed: {}; it is tried again", why);
  if (text != incomplete_because_) {
    fault_(text);
  }
  incomplete_because_ = text;
}

void Archivist::note_missing(CatalogueEntry entry) {
  fault_(fmt::format("{} is missing; restore it from a backup",
                     (store_.shots() / entry.capture).string()));
  entry.verdict.clear();
  entry.reducible = false;
  entry.reason = "its capture is missing";
  entry.peak_stress_Pa = entry.peak_strain = entry.peak_force_N = entry.restitution = 0.0;
  catalogue().put(entry);
}

}  // namespace kolsky
