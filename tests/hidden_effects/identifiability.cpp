#include "tests/hidden_effects/identifiability.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

namespace kolsky::scoring {

namespace {

using testing::Campaign;
using testing::EffectKind;
using testing::HiddenEffect;
using testing::Readings;

constexpr double kDetect = 6.0;
constexpr double kAgainstRival = 5.0;
// A size beyond this many typical ones is nothing a laboratory has.
constexpr double kBeyondReason = 10.0;
// Two branches may change names: which is the second must be beyond doubt.
constexpr double kMostOfBranch = 0.7;
// Differences, and sources made of splines, miss by some hundredths: where no more is left of a
// change beside a rival's, the tie may be exact (the places of three gauges on a bar whose moduli
// are free, a place and a delay on an elastic one).
constexpr double kLeftOfTies = 0.05;
// Below this exponent the generator's own error is no longer small.
constexpr double kMostFractional = 0.25;

// Only one gauge's share of a change made at all gauges at once.
Readings of_gauge(const Readings& all, std::size_t gauge) {
  Readings out = all;
  for (auto& shot : out) {
    for (std::size_t g = 0; g < shot.size(); ++g) {
      if (g != gauge) {
        std::ranges::fill(shot[g], 0.0);
      }
    }
  }
  return out;
}

// The mean over a gauge's length misses the middle by its square.
double power_of(const EffectKind& kind) {
  return kind.id == "gauge-length" ? 2.0 : 1.0;
}

// A strength from what a linear effect with the same change at the probe's strength would need.
double bent(const Candidate& candidate, double linear) {
  const double probe = std::abs(candidate.effect.strength - candidate.null);
  return probe * std::pow(linear / probe, 1.0 / power_of(candidate.kind));
}

// Strengths at which differences are taken: small, but for what is there or not.
HiddenEffect probe_of(const EffectKind& kind, const std::string& gauge) {
  HiddenEffect effect{kind.id, gauge, 0.0, {}};
  if (is_there_or_not(kind.id)) {
    effect.strength = kind.typical;
  } else {
    effect.strength = kind.null + 0.2 * (kind.typical - kind.null);
  }
  return effect;
}

// The compliance of the branch that a further relaxation is second to; none: infinite.
double first_branch_per_Pa(const EffectKind& kind, const Campaign& campaign) {
  if (kind.id == "specimen-second-relaxation") {
    return 1.0 / campaign.split->specimen.E2_Pa;
  }
  return kind.id == "second-relaxation" && !campaign.world.material.elastic
             ? 1.0 / campaign.world.material.E2_Pa
             : std::numeric_limits<double>::infinity();
}

// What two gauges tell of a bar whose moduli are free is a distance times a wavenumber: moduli take
// up a place that is off at every frequency, which differences to first order, and sources made of
// splines, miss by a hundredth.
bool taken_up_by_moduli(const EffectKind& kind, const Campaign& campaign) {
  return kind.id == "gauge-position" && !campaign.split && !campaign.world.material.elastic &&
         campaign.world.gauges.size() == 2;
}

double most_of(const EffectKind& kind, const Campaign& campaign) {
  if (taken_up_by_moduli(kind, campaign)) {
    return 0.0;
  }
  if (kind.id == "fractional-damping") {
    return kMostFractional;
  }
  return std::min(kBeyondReason * std::abs(kind.typical - kind.null),
                  kMostOfBranch * first_branch_per_Pa(kind, campaign));
}

// A bench's hum has phases by shot or one in all, and is alike at all gauges or picked up the other
// way at every second, one bench as often as the other.
std::map<std::string, double> hum_of(const Campaign& campaign) {
  const double phase = campaign.world.shots.front().hum_phase;
  const auto quarter = static_cast<int>(2.0 * phase / std::numbers::pi);
  std::map<std::string, double> details;
  if (quarter % 2 == 1) {
    details["phase"] = campaign.world.shots.back().hum_phase;
  }
  if (quarter / 2 == 1) {
    details["others"] = -0.8;
  }
  return details;
}

// What a kind of effect has besides a strength, each in turn.
std::vector<std::map<std::string, double>> variants_of(const EffectKind& kind,
                                                       const Campaign& campaign) {
  if (kind.id == "second-relaxation") {
    return {{{"tau", 3e-4}}, {{"tau", 2e-5}}, {{"tau", 8e-5}}, {{"tau", 1.5e-3}}};
  }
  if (kind.id == "mains-hum") {
    return {hum_of(campaign)};
  }
  return {{}};
}

std::vector<Candidate> all_candidates(const Campaign& campaign) {
  std::vector<Candidate> out;
  for (const EffectKind& kind : campaign.split ? testing::shpb_effects() : testing::bar_effects()) {
    const double most = most_of(kind, campaign);
    if (!kind.per_gauge) {
      for (const auto& details : variants_of(kind, campaign)) {
        out.push_back({probe_of(kind, ""), kind, kind.null, most});
        out.back().effect.details = details;
      }
      continue;
    }
    for (const testing::TrueGauge& gauge : campaign.world.gauges) {
      out.push_back({probe_of(kind, gauge.name), kind, kind.null, most});
    }
  }
  return out;
}

Eigen::MatrixXd without(const Eigen::MatrixXd& products, const Eigen::MatrixXd& cross,
                        const Eigen::MatrixXd& nuisance) {
  return products - cross * nuisance.ldlt().solve(cross.transpose());
}

bool moves_places(const std::string& id) {
  return id == "gauge-position" || id == "gauge-length";
}

bool same_family(const Candidate& a, const Candidate& b) {
  return a.effect.name() == b.effect.name();
}

}  // namespace

bool Identifiable::all_or_nothing() const {
  return is_there_or_not(candidate.kind.id);
}

bool Identifiable::seen_but_tied() const {
  const double typical = std::abs(candidate.kind.typical - candidate.null);
  return !all_or_nothing() && !possible() && std::isfinite(detect) && detect < 2.0 * typical &&
         4.0 * detect < candidate.most;
}

bool Identifiable::possible() const {
  if (all_or_nothing()) {
    return smallest > 0.0 && smallest <= candidate.kind.typical;
  }
  return smallest > 0.0 && smallest <= candidate.most;
}

Identifiability::Identifiability(const Campaign& campaign) : candidates_(all_candidates(campaign)) {
  Prober prober(campaign);
  std::vector<Direction> directions = prober.nuisances();
  const auto nuisances = static_cast<Eigen::Index>(directions.size());
  std::string everywhere_id;
  Readings everywhere;
  std::size_t gauge = 0;
  for (const Candidate& candidate : candidates_) {
    if (!moves_places(candidate.effect.id)) {
      directions.push_back({prober.unit_change(candidate), 0.0});
      continue;
    }
    if (candidate.effect.id != everywhere_id) {
      everywhere_id = candidate.effect.id;
      everywhere = prober.unit_change_everywhere(candidate);
      gauge = 0;
    }
    directions.push_back({of_gauge(everywhere, gauge++), 0.0});
  }
  const SourceFreedom freedom = prober.freedom();
  const auto count = static_cast<Eigen::Index>(directions.size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(count, count);
  for (std::size_t shot = 0; shot < campaign.world.shots.size(); ++shot) {
    std::vector<const std::vector<std::vector<double>>*> of_shot;
    for (const Direction& direction : directions) {
      of_shot.push_back(&direction.readings[shot]);
    }
    information += freedom.remaining_products(of_shot);
  }
  Eigen::MatrixXd nuisance = information.topLeftCorner(nuisances, nuisances);
  for (Eigen::Index i = 0; i < nuisances; ++i) {
    nuisance(i, i) += directions[static_cast<std::size_t>(i)].known();
  }
  const Eigen::Index wanted = count - nuisances;
  products_ = without(information.bottomRightCorner(wanted, wanted),
                      information.bottomLeftCorner(wanted, nuisances), nuisance);
  judge();
}

void Identifiability::judge() {
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    Identifiable found{candidates_[i], 0.0, 0.0, "", 1.0};
    const double own = std::max(products_(row, row), 0.0);
    double least = own;
    for (std::size_t j = 0; j < candidates_.size(); ++j) {
      const auto column = static_cast<Eigen::Index>(j);
      if (same_family(candidates_[i], candidates_[j]) || candidates_[j].kind.withheld ||
          products_(column, column) <= 0.0) {
        continue;
      }
      const double cross = products_(row, column);
      const double left = own - cross * cross / products_(column, column);
      if (left < least) {
        least = left;
        found.closest = candidates_[j].effect.name();
      }
    }
    found.rival_share = own > 0.0 ? std::sqrt(std::max(least, 0.0) / own) : 0.0;
    if (found.rival_share < kLeftOfTies) {
      least = 0.0;
    }
    const double detect = kDetect / std::sqrt(own);
    const double against_rival = kAgainstRival / std::sqrt(std::max(least, 0.0));
    found.detect = bent(found.candidate, detect);
    found.smallest = bent(found.candidate, std::max(detect, against_rival));
    effects_.push_back(found);
  }
}

double Identifiability::withheld_size(const Identifiable& effect, double sigmas) const {
  const auto of = [&](std::size_t i) { return static_cast<Eigen::Index>(i); };
  const auto found = std::ranges::find_if(candidates_, [&](const Candidate& candidate) {
    return candidate.effect.name() == effect.candidate.effect.name();
  });
  const Eigen::Index row = of(static_cast<std::size_t>(found - candidates_.begin()));
  double least = products_(row, row);
  for (std::size_t a = 0; a < candidates_.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      if (candidates_[a].kind.withheld || candidates_[b].kind.withheld) {
        continue;
      }
      Eigen::Matrix2d pair;
      pair << products_(of(a), of(a)), products_(of(a), of(b)), products_(of(a), of(b)),
          products_(of(b), of(b));
      pair.diagonal() *= 1.0 + 1e-9;
      const Eigen::Vector2d cross(products_(row, of(a)), products_(row, of(b)));
      least = std::min(least, products_(row, row) - cross.dot(pair.ldlt().solve(cross)));
    }
  }
  return sigmas / std::sqrt(std::max(least, 0.0));
}

}  // namespace kolsky::scoring
