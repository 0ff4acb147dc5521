#include "processing/criticism/search/slow_chances.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "processing/criticism/search/candidate_kinds.hpp"
#include "processing/criticism/search/own_strengths.hpp"

namespace kolsky {

SlowChance SlowChances::of(std::size_t index) {
  const Candidate& candidate = ground_.candidates[index];
  const Direction& direction = ground_.directions[index];
  // Far from the records, what repeats is most of what slow noise would be.
  if (!(may_be_slow_noise(candidate) || has_shares(candidate)) || direction.freedom < 1.0 ||
      ground_.far_off()) {
    return {};
  }
  if (const auto known = known_.find(index); known != known_.end()) {
    return known->second;
  }
  if (!slow_noise_) {
    slow_noise_.emplace(ground_.base, ground_.study);
  }
  std::set<std::string> kinds;
  for (const Candidate& other : ground_.candidates) {
    if (may_be_slow_noise(other)) {
      kinds.insert(other.id());
    }
  }
  const double among = std::log(2.0 * static_cast<double>(kinds.size()));
  const SlowNoise::Addition own{candidate, direction};
  SlowChance chance{slow_noise_->log_chance({&own, 1}) + among};
  std::vector<SlowNoise::Addition> others = at_other_gauges(candidate);
  if (!slow_noise_excluded(chance.alone, Claim::fresh) && !others.empty()) {
    const double beside = slow_noise_->log_chance_beside(own, others);
    others.push_back(own);
    chance.with_others = std::max(beside, slow_noise_->log_chance(others)) + among;
  }
  known_.emplace(index, chance);
  return chance;
}

/// The same addition at other gauges.
std::vector<SlowNoise::Addition> SlowChances::at_other_gauges(const Candidate& own) const {
  std::vector<SlowNoise::Addition> list;
  for (std::size_t i = 0; i < ground_.candidates.size(); ++i) {
    const EffectUse& use = ground_.candidates[i].use;
    if (use.effect == own.use.effect && use.gauge != own.use.gauge &&
        may_be_slow_noise(ground_.candidates[i]) && ground_.directions[i].freedom >= 1.0) {
      list.push_back({ground_.candidates[i], ground_.directions[i]});
    }
  }
  return list;
}

}  // namespace kolsky
