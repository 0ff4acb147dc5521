#pragma once

#include <map>
#include <optional>
#include <vector>

#include "processing/criticism/search/refit.hpp"
#include "processing/criticism/search/search_ground.hpp"
#include "processing/criticism/search/slow_noise.hpp"

namespace kolsky {

/// The chances of candidates on slow noise, each reckoned once.
class SlowChances {
 public:
  /// @param ground  outlives this
  explicit SlowChances(const SearchGround& ground) : ground_(ground) {}

  /// ln of the chances of the best of all additions of each shot's own on slow noise; none where
  /// the candidate is no such addition.
  [[nodiscard]] SlowChance of(std::size_t candidate);

 private:
  [[nodiscard]] std::vector<SlowNoise::Addition> at_other_gauges(const Candidate& own) const;

  const SearchGround& ground_;
  std::optional<SlowNoise> slow_noise_;      ///< once it is asked for
  std::map<std::size_t, SlowChance> known_;  ///< by candidate
};

}  // namespace kolsky
