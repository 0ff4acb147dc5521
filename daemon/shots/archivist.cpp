#include "daemon/shots/archivist.hpp"

#include <fmt/format.h>

#include <chrono>
#include <future>
#include <set>

#include "daemon/log.hpp"
#include "daemon/shots/summary.hpp"
#include "daemon/thread_priority.hpp"
#include "drivers/files/capture.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

constexpr std::chrono::seconds kPatience{20};

}  // namespace

Archivist::Archivist(StoreLayout store, SharedJournal& journal, FaultSink fault)
    : store_(std::move(store)), journal_(journal), fault_(std::move(fault)) {}

Archivist::~Archivist() {
  stop();
}

void Archivist::start() {
  submit([this] { complete_catalogue(); });
  thread_ = std::thread([this] { run(); });
}

void Archivist::stop() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) {
    thread_.join();
  }
}

void Archivist::store(std::shared_ptr<const Shot> shot, CatalogueEntry entry) {
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return jobs_.size() < kMostWaiting; });
    ++handed_over_;
    jobs_.emplace_back(
        [this, shot = std::move(shot), entry = std::move(entry)] { store_now(*shot, entry); });
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
  name_thread("kolsky-archive");
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return stop_ || !jobs_.empty(); });
    if (jobs_.empty()) {
      return;
    }
    const Job job = std::move(jobs_.front());
    jobs_.pop_front();
    busy_ = true;
    lock.unlock();
    job();
    progress_.fetch_add(1);
    lock.lock();
    busy_ = false;
    changed_.notify_all();
  }
}

bool Archivist::idle() const {
  const std::lock_guard lock(mutex_);
  return jobs_.empty() && !busy_;
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
  if (answer.wait_for(kPatience) != std::future_status::ready) {
    throw InputError("store", "busy with other shots", "ask again");
  }
  return answer.get();
}

StoredShot Archivist::get(const std::string& id) {
  return ask([this, id] {
    const std::optional<CatalogueEntry> entry = catalogue().find(id);
    if (!entry) {
      throw InputError("shot '" + id + "'", "is not in the store", "`kolsky shots` lists them");
    }
    const std::filesystem::path capture = store_.shots() / entry->capture;
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

void Archivist::store_now(const Shot& shot, CatalogueEntry entry) {
  try {
    const std::filesystem::path capture = store_.capture_of(shot.id);
    write_capture(shot, capture);
    stored_.fetch_add(1);
    entry.capture = capture.filename().string();
    catalogue().put(entry);
    journal_.append_stored(shot.id, capture);
  } catch (const std::exception& error) {
    failed_.fetch_add(1);
    fault_(fmt::format("shot {}: {}", shot.id, error.what()));
  }
  tend_journals();
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
                          journal.filename().string(), report.journaled_shots));
  }
}

void Archivist::complete_catalogue() {
  try {
    std::set<std::string> known;
    for (const CatalogueEntry& entry : catalogue().newest()) {
      known.insert(entry.capture);
    }
    std::size_t entered = 0;
    for (const auto& file : std::filesystem::directory_iterator(store_.shots())) {
      if (file.path().extension() == ".h5" && !known.contains(file.path().filename().string())) {
        enter(file.path());
        ++entered;
      }
    }
    if (entered != 0) {
      log::info(fmt::format("catalogue: entered {} captures it did not know", entered));
    }
  } catch (const std::exception& error) {
    fault_(fmt::format("the catalogue could not be completed: {}", error.what()));
  }
}

void Archivist::enter(const std::filesystem::path& capture) {
  try {
    const Shot shot = read_capture(capture);
    catalogue().put(
        summarise(shot, reduce_or_say_why(reducer_, shot), capture.filename().string()));
  } catch (const InputError& error) {
    fault_(error.what());
  }
}

}  // namespace kolsky
