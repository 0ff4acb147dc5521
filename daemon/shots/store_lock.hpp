#pragma once

#include <filesystem>

namespace kolsky {

/// Keeps a second daemon out of a store. The lock goes with the process, however it ends.
class StoreLock {
 public:
  /// @throws InputError where another daemon holds it
  explicit StoreLock(const std::filesystem::path& store);
  ~StoreLock();
  StoreLock(const StoreLock&) = delete;
  StoreLock& operator=(const StoreLock&) = delete;

 private:
  int file_ = -1;
};

}  // namespace kolsky
