#include "processing/criticism/comparing/shot_groups.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kolsky {

namespace {

constexpr double kAlike = 1.25;  ///< strongest over weakest of one group

}  // namespace

double ShotGroup::sigma() const {
  return noise.mean > 0.0 ? std::sqrt(energy / noise.mean) : 0.0;
}

double usual_strain_rate_per_s(double peak_strain, const Model& model, const Bench& bench) {
  if (!bench.specimen) {
    return 0.0;
  }
  double modulus = bench.input.youngs_modulus_Pa.value_or(Measured{}).value;
  if (const EffectUse* use = model.find("three-element-bar")) {
    modulus = use->values.front().value;
  }
  return peak_strain * std::sqrt(modulus / bench.input.density_kg_m3) / bench.specimen->length_m;
}

ShotGroups by_strength(const Comparison& comparison, const Model& model, const Campaign& campaign) {
  const bool split = campaign.bench.specimen.has_value();
  ShotGroups by{split ? "strain rate" : "peak strain", split ? "1/s" : "strain", {}};
  const auto strength = [&](std::size_t shot) {
    const double peak = campaign.shots[shot].facts.peak_strain;
    return split ? usual_strain_rate_per_s(peak, model, campaign.bench) : peak;
  };
  std::vector<std::size_t> order(campaign.shots.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return strength(a) < strength(b); });
  for (const std::size_t shot : order) {
    const double own = strength(shot);
    if (by.groups.empty() || own > kAlike * by.groups.back().low) {
      by.groups.push_back({own, own, {}, 0.0, {}, 0.0});
    }
    ShotGroup& group = by.groups.back();
    group.high = own;
    group.shots.push_back(shot);
    for (const Tile& tile : comparison.tiles) {
      if (tile.shot == shot) {
        group.energy += tile.energy;
        group.noise += tile.noise;
        group.share += tile.share;
      }
    }
  }
  if (by.groups.size() < 2) {
    by.groups.clear();
  }
  return by;
}

}  // namespace kolsky
