#include "daemon/shots/shared_journal.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "processing/base/error.hpp"

namespace kolsky {

SharedJournal::SharedJournal(const StoreLayout& store, std::uint64_t boot_id)
    : folder_(store.journals()), boot_id_(boot_id) {
  static_cast<void>(current());
}

std::shared_ptr<Journal> SharedJournal::current() {
  const std::lock_guard lock(mutex_);
  if (!journal_) {
    const std::string name = files_ == 0 ? fmt::format("{:016x}.kj", boot_id_)
                                         : fmt::format("{:016x}-{}.kj", boot_id_, files_);
    journal_ = std::make_shared<Journal>(folder_ / name);
    ++files_;
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
void SharedJournal::append(const Append& write) {
  const std::shared_ptr<Journal> first = current();
  try {
    write(*first);
  } catch (const InputError&) {
    throw;  // the shot is not storable; nothing was written
  } catch (const std::runtime_error&) {
    give_up(first);
    write(*current());
  }
}

void SharedJournal::append_shot(const Shot& shot) {
  append([&](Journal& journal) { journal.append_shot(shot); });
}

void SharedJournal::append_stored(const std::string& shot_id,
                                  const std::filesystem::path& capture) {
  append([&](Journal& journal) { journal.append_stored(shot_id, capture); });
}

}  // namespace kolsky
