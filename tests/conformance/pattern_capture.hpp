#pragma once

#include <atomic>
#include <filesystem>
#include <string>

#include "processing/base/shot.hpp"

namespace kolsky {

/// A folder of its own under the system's temporary ones, gone at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// A shot of two gauges, g1 and g2, that carry the test pattern.
/// @param pattern_start  the pattern's tick at sample 0
[[nodiscard]] Shot pattern_shot(Tick pattern_start, std::size_t samples);

/// Declares samples missing, as they are stored: the last code before them repeated.
void make_gap(Shot& shot, Tick first_tick, Tick samples);

}  // namespace kolsky
