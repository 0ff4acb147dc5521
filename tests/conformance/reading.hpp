#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <functional>
#include <thread>

#include "drivers/digitiser/digitiser.hpp"

namespace kolsky {

/// Code i of a channel of a block.
[[nodiscard]] inline std::int32_t code_at(const StreamInfo& info, const Block& block,
                                          std::size_t channel, std::size_t i) {
  const std::byte* from = block.channels.at(channel).data() + i * sample_bytes(info.format);
  if (info.format == SampleFormat::int16) {
    std::int16_t code = 0;
    std::memcpy(&code, from, sizeof code);
    return code;
  }
  std::int32_t code = 0;
  std::memcpy(&code, from, sizeof code);
  return code;
}

/// Reads until something other than a block or, where they are allowed, a time-out comes; `each`
/// says whether to go on. @return what ended it, `samples` if it was `each`
inline ReadStatus read_while(Digitiser& digitiser, const std::function<bool(const Block&)>& each) {
  Block block;
  for (int timeouts = 0; timeouts < 20;) {
    const ReadStatus status = digitiser.read(block);
    if (status == ReadStatus::timeout) {
      ++timeouts;
      continue;
    }
    if (status != ReadStatus::samples || !each(block)) {
      return status;
    }
  }
  return ReadStatus::timeout;
}

/// As the daemon does it: a server lets go of a stream some time after it was dropped, and the
/// device is busy until then.
inline bool comes_back(Digitiser& digitiser) {
  for (int attempt = 0; attempt < 200; ++attempt) {
    if (digitiser.reconnect()) {
      return true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

/// Reads the next block, whatever precedes it. @return whether there was one
inline bool next_block(Digitiser& digitiser, Block& block) {
  for (int tries = 0; tries < 20; ++tries) {
    const ReadStatus status = digitiser.read(block);
    if (status == ReadStatus::samples) {
      return true;
    }
    if (status == ReadStatus::disconnected || status == ReadStatus::end_of_capture) {
      return false;
    }
  }
  return false;
}

}  // namespace kolsky
