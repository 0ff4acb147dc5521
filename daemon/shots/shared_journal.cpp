#include "daemon/shots/shared_journal.hpp"

#include <fmt/format.h>

namespace kolsky {

SharedJournal::SharedJournal(const StoreLayout& store, std::uint64_t boot_id)
    : folder_(store.journals()), boot_id_(boot_id) {
  open();
}

void SharedJournal::open() {
  const std::string name = files_ == 0 ? fmt::format("{:016x}.kj", boot_id_)
                                       : fmt::format("{:016x}-{}.kj", boot_id_, files_);
  ++files_;
  journal_ = std::make_unique<Journal>(folder_ / name);
}

template <typename Append>
void SharedJournal::append(const Append& write) {
  const std::lock_guard lock(mutex_);
  for (int attempt = 0;; ++attempt) {
    try {
      if (!journal_) {
        open();
      }
      write(*journal_);
      return;
    } catch (...) {
      journal_.reset();
      if (attempt == 1) {
        throw;
      }
    }
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
