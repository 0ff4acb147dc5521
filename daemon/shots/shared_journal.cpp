#include "daemon/shots/shared_journal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "processing/base/error.hpp"

namespace kolsky {

SharedJournal::SharedJournal(const StoreLayout& store, std::uint64_t boot_id,
                             std::uint64_t limit_bytes)
    : folder_(store.journals()), boot_id_(boot_id), limit_bytes_(limit_bytes) {
  static_cast<void>(current());
}

std::filesystem::path SharedJournal::next_path() {
  const int file = files_++;
  return folder_ / (file == 0 ? fmt::format("{:016x}.kj", boot_id_)
                              : fmt::format("{:016x}-{}.kj", boot_id_, file));
}

std::shared_ptr<Journal> SharedJournal::current() {
  const std::lock_guard lock(mutex_);
  if (!journal_) {
    journal_ = std::make_shared<Journal>(next_path());
  }
  return journal_;
}

void SharedJournal::give_up(const std::shared_ptr<Journal>& journal) {
  const std::lock_guard lock(mutex_);
  if (journal_ == journal) {
    journal_.reset();
  }
}

template <typename Append>
std::shared_ptr<Journal> SharedJournal::append(const Append& write) {
  std::shared_ptr<Journal> journal = current();
  try {
    write(*journal);
  } catch (const InputError&) {
    throw;  // the shot is not storable; nothing was written
  } catch (const std::runtime_error&) {
    give_up(journal);
    journal = current();
    write(*journal);
  }
  return journal;
}

void SharedJournal::write_shot(const Shot& shot) {
  written_ = append([&](Journal& open) { open.write_shot(shot); });
}

void SharedJournal::make_durable(const Shot& shot) {
  std::shared_ptr<Journal> journal = std::exchange(written_, nullptr);
  try {
    journal->make_durable();
  } catch (const std::runtime_error&) {
    give_up(journal);
    journal = append([&](Journal& open) { open.append_shot(shot); });
  }
  const std::lock_guard lock(mutex_);
  not_stored_[shot.id] = std::move(journal);
}

void SharedJournal::append_stored(const std::string& shot_id,
                                  const std::filesystem::path& capture) {
  append([&](Journal& open) { open.append_stored(shot_id, capture); });
  const std::lock_guard lock(mutex_);
  not_stored_.erase(shot_id);
}

bool SharedJournal::holds(const std::string& shot_id) const {
  const std::lock_guard lock(mutex_);
  return not_stored_.contains(shot_id);
}

void SharedJournal::turn_over() {
  std::shared_ptr<Journal> open;
  {
    const std::lock_guard lock(mutex_);
    open = journal_;
  }
  if (!open || open->bytes() < limit_bytes_) {
    return;
  }
  std::filesystem::path path;
  {
    const std::lock_guard lock(mutex_);
    path = next_path();
  }
  auto next = std::make_shared<Journal>(path);
  const std::lock_guard lock(mutex_);
  // It may have been given up meanwhile; then whichever took its place ends early.
  if (const auto old = std::exchange(journal_, std::move(next))) {
    ended_.push_back(old);
  }
}

std::vector<std::filesystem::path> SharedJournal::take_done() {
  std::vector<std::shared_ptr<Journal>> done;
  {
    const std::lock_guard lock(mutex_);
    const auto in_use = [](const auto& journal) { return journal.use_count() > 1; };
    const auto first = std::stable_partition(ended_.begin(), ended_.end(), in_use);
    done.assign(std::make_move_iterator(first), std::make_move_iterator(ended_.end()));
    ended_.erase(first, ended_.end());
  }
  std::vector<std::filesystem::path> paths;
  for (const auto& journal : done) {
    paths.push_back(journal->path());
  }
  return paths;  // closing them takes time that nobody should wait for: not under the lock
}

}  // namespace kolsky
