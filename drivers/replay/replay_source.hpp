#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "drivers/digitiser/open.hpp"
#include "processing/base/shot.hpp"

namespace kolsky {

/// The captures of a replay, checked when it is opened: all of them deliver the same stream.
class ReplaySource {
 public:
  /// @param path  a capture, or a folder of them, which are played by name
  /// @throws InputError where there is none, one cannot be read, one differs from the first (and it
  /// is
  ///   named), or they do not deliver what the options ask for
  ReplaySource(const std::filesystem::path& path, const DigitiserOptions& options);

  [[nodiscard]] const std::vector<PlayedCapture>& captures() const noexcept { return captures_; }
  [[nodiscard]] SampleRate rate() const noexcept { return rate_; }
  [[nodiscard]] const std::vector<ChannelInfo>& channels() const noexcept { return channels_; }
  [[nodiscard]] std::size_t total_samples() const noexcept { return total_samples_; }

  /// Reads a capture, keeping the channels of the stream, in its order; gaps sorted.
  /// @throws InputError where it cannot be read or is not what it was
  [[nodiscard]] Shot load(std::size_t index) const;

 private:
  [[nodiscard]] Shot chosen(Shot shot, const std::filesystem::path& path) const;

  std::vector<std::filesystem::path> paths_;
  DigitiserOptions options_;
  SampleRate rate_;
  std::vector<ChannelInfo> channels_;
  std::vector<PlayedCapture> captures_;
  std::size_t total_samples_ = 0;
};

}  // namespace kolsky
