#include "processing/base/shot.hpp"

namespace kolsky {

std::vector<std::size_t> clipped_samples(const ChannelRecord& channel) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < channel.codes.size(); ++i) {
    if (channel.codes[i] <= channel.code_min || channel.codes[i] >= channel.code_max) {
      indices.push_back(i);
    }
  }
  return indices;
}

}  // namespace kolsky
