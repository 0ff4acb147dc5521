#pragma once

#include <memory>
#include <vector>

#include "daemon/acquisition/sample_ring.hpp"
#include "daemon/publish/preview_decimator.hpp"
#include "daemon/publish/publisher.hpp"
#include "processing/base/shot.hpp"

namespace kolsky {

/// Publishes the envelope of what has come into the ring since the last look. Where the stream is
/// faster than it, samples between are passed over; the preview counts them.
class Previewer {
 public:
  /// @param blank  the channels
  Previewer(const SampleRing& ring, Publisher& publisher, const Shot& blank);

  void publish_new();

 private:
  [[nodiscard]] bool copy(Tick first, std::size_t samples);

  const SampleRing& ring_;
  Publisher& publisher_;
  PreviewDecimator decimator_;
  Tick next_tick_ = 0;
  bool started_ = false;
  std::vector<std::vector<std::int32_t>> chunk_;
  std::vector<std::span<const std::int32_t>> codes_;
};

}  // namespace kolsky
