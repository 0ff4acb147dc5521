#include "daemon/shots/store_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "processing/base/error.hpp"

namespace kolsky {

StoreLock::StoreLock(const std::filesystem::path& store) {
  const std::filesystem::path path = store / "kolskyd.lock";
  file_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (file_ < 0) {
    throw InputError(path.string(), std::generic_category().message(errno),
                     "make the store's folder writable");
  }
  if (flock(file_, LOCK_EX | LOCK_NB) != 0) {
    close(file_);
    throw InputError(store.string(), "another kolskyd works in this store",
                     "stop it, or give this one a store.folder of its own");
  }
}

StoreLock::~StoreLock() {
  close(file_);
}

}  // namespace kolsky
