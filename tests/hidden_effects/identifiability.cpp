#include "tests/hidden_effects/identifiability.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "tests/hidden_effects/source_freedom.hpp"
#include "tests/hidden_effects/whitening.hpp"

namespace kolsky::scoring {

namespace {

using testing::Campaign;
using testing::EffectKind;
using testing::HiddenEffect;
using testing::Readings;

constexpr double kModulusStep = 5e-4;
constexpr double kDetect = 6.0;
constexpr double kAgainstRival = 5.0;
// A size beyond this many typical ones is nothing a laboratory has.
constexpr double kBeyondReason = 10.0;
// Two branches may change names: which is the second must be beyond doubt.
constexpr double kMostOfBranch = 0.7;
// Below this exponent the generator's own error is no longer small.
constexpr double kMostFractional = 0.25;

Whitening whitening_of(const Campaign& campaign) {
  const double step =
      campaign.bits > 0 ? std::ldexp(campaign.full_scale_strain, 1 - campaign.bits) : 0.0;
  const double rms = campaign.wishes.noise_strain;
  const double quantised = step / std::sqrt(12.0);
  if (campaign.wishes.colour == testing::NoiseColour::white) {
    return Whitening(std::hypot(rms, quantised));
  }
  std::mt19937_64 random(17);
  std::vector<std::vector<double>> samples;
  std::normal_distribution<double> rounding(0.0, quantised);
  for (int i = 0; i < 64; ++i) {
    samples.push_back(testing::noise(campaign.wishes.colour, rms, campaign.world.timing.period_s(),
                                     4096, random, campaign.wishes.measured_noise));
    for (double& value : samples.back()) {
      value += rounding(random);
    }
  }
  return Whitening(samples, 48);
}

Readings difference(const Readings& changed, const Readings& base, double step,
                    const Whitening& whiten) {
  Readings out = changed;
  for (std::size_t i = 0; i < out.size(); ++i) {
    for (std::size_t g = 0; g < out[i].size(); ++g) {
      for (std::size_t n = 0; n < out[i][g].size(); ++n) {
        out[i][g][n] = (out[i][g][n] - base[i][g][n]) / step;
      }
      out[i][g] = whiten(out[i][g]);
    }
  }
  return out;
}

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

bool is_there_or_not(const std::string& id) {
  return id == "geometric-dispersion" || id == "end-reflection" || id == "specimen-inertia";
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

struct Direction {
  Readings readings;
  double prior_sd = 0.0;  // 0: free
};

class Prober {
 public:
  explicit Prober(const Campaign& campaign)
      : campaign_(campaign), whiten_(whitening_of(campaign)), base_(forward_.readings(campaign)) {}

  std::vector<Direction> nuisances() {
    std::vector<Direction> out;
    if (campaign_.split) {
      add_specimen(out);
    }
    const bool held = campaign_.split.has_value();
    const auto filed = [&](const Measured& number) { return number.sd / number.value; };
    const auto& bars = campaign_.filed_bars;
    if (campaign_.world.material.elastic) {
      add_modulus(out, &testing::TrueMaterial::E1_Pa, true,
                  filed(*campaign_.bench.input.youngs_modulus_Pa));
    } else {
      add_modulus(out, &testing::TrueMaterial::E1_Pa, held, bars ? filed(bars->E1_Pa) : 0.0);
      add_modulus(out, &testing::TrueMaterial::E2_Pa, held, bars ? filed(bars->E2_Pa) : 0.0);
      add_modulus(out, &testing::TrueMaterial::eta2_Pa_s, held,
                  bars ? filed(bars->eta2_Pa_s) : 0.0);
    }
    add_gauges(out);
    return out;
  }

  Readings unit_change(const Candidate& candidate) {
    const double step = candidate.effect.strength - candidate.null;
    const auto at = [&](double share) {
      Campaign changed_one = campaign_;
      HiddenEffect effect = candidate.effect;
      effect.strength = candidate.null + share * step;
      testing::hide(changed_one, effect);
      return changed_one;
    };
    return unit_change(at, step, differences_of(candidate.kind));
  }

  // The same change at every gauge, at the cost of one.
  Readings unit_change_everywhere(const Candidate& candidate) {
    const double step = candidate.effect.strength;
    const auto at = [&](double share) {
      Campaign changed_one = campaign_;
      for (const testing::TrueGauge& gauge : campaign_.world.gauges) {
        testing::hide(changed_one, {candidate.effect.id, gauge.name, share * step, {}});
      }
      return changed_one;
    };
    return unit_change(at, step, differences_of(candidate.kind));
  }

  SourceFreedom freedom() {
    const testing::Timing& timing = campaign_.world.timing;
    std::vector<std::vector<double>> bells;
    const auto first = -static_cast<std::ptrdiff_t>(std::floor(timing.lead_s / timing.period_s()));
    const std::size_t length = timing.samples + static_cast<std::size_t>(-first);
    double largest = 0.0;
    for (const std::vector<double>& bell : forward_.bell_records(campaign_, length)) {
      for (const double value : bell) {
        largest = std::max(largest, std::abs(value));
      }
      bells.push_back(whiten_(bell));
    }
    return {std::move(bells),        whiten_(std::vector<double>(timing.samples, 1.0)),
            timing.samples,          first,
            timing.periods_per_knot, 3e-3 / largest};
  }

 private:
  // Ties are exact to first order: differences must be better than that.
  enum class Differences { central, one_sided, whole };

  static Differences differences_of(const EffectKind& kind) {
    // Bending adds what is proportional to it: no difference is more exact than another.
    if (is_there_or_not(kind.id) || kind.id == "gauge-length" || kind.id == "bending") {
      return Differences::whole;
    }
    return kind.one_sided ? Differences::one_sided : Differences::central;
  }

  Readings unit_change(const std::function<Campaign(double)>& at, double step,
                       Differences differences) {
    if (differences == Differences::central) {
      return difference(forward_.readings(at(1.0)), forward_.readings(at(-1.0)), 2.0 * step,
                        whiten_);
    }
    Readings out = difference(forward_.readings(at(1.0)), base_, step, whiten_);
    if (differences == Differences::one_sided) {
      const Readings half = difference(forward_.readings(at(0.5)), base_, 0.5 * step, whiten_);
      for (std::size_t i = 0; i < out.size(); ++i) {
        for (std::size_t g = 0; g < out[i].size(); ++g) {
          for (std::size_t n = 0; n < out[i][g].size(); ++n) {
            out[i][g][n] = 2.0 * half[i][g][n] - out[i][g][n];
          }
        }
      }
    }
    return out;
  }

  // A modulus of the bars, free or within what is filed; held altogether where that is exact.
  void add_modulus(std::vector<Direction>& out, double testing::TrueMaterial::*member, bool held,
                   double relative_sd) {
    if (held && relative_sd == 0.0) {
      return;
    }
    const auto at = [&](double share) {
      Campaign campaign = campaign_;
      campaign.world.material.*member *= 1.0 + share * kModulusStep;
      return campaign;
    };
    out.push_back({unit_change(at, kModulusStep, Differences::central), relative_sd});
  }

  void add_specimen(std::vector<Direction>& out) {
    using S = testing::TrueSpecimen;
    const Specimen& filed = *campaign_.bench.specimen;
    for (const auto& [of_specimen, sd] :
         {std::pair{&S::E1_Pa, 0.0},
          {&S::E2_Pa, 0.0},
          {&S::eta2_Pa_s, 0.0},
          {&S::length_m, filed.length_m.sd / filed.length_m.value},
          {&S::diameter_m, filed.diameter_m.sd / filed.diameter_m.value}}) {
      const auto member = of_specimen;
      if (sd > 0.0 || (member != &S::length_m && member != &S::diameter_m)) {
        const auto at = [&](double share) {
          Campaign campaign = campaign_;
          campaign.split->specimen.*member *= 1.0 + share * kModulusStep;
          return campaign;
        };
        out.push_back({unit_change(at, kModulusStep, Differences::central), sd});
      }
    }
  }

  void add_gauges(std::vector<Direction>& out) {
    for (std::size_t g = 0; g < campaign_.world.gauges.size(); ++g) {
      const Gauge& filed = campaign_.bench.gauges[g];
      const std::string& name = campaign_.world.gauges[g].name;
      if (filed.position_m.sd > 0.0) {
        out.push_back(
            {unit_change({{"gauge-position", name, 1e-4, {}}, {}, 0.0}), filed.position_m.sd});
      }
      if (filed.strain_per_V && filed.strain_per_V->sd > 0.0) {
        out.push_back({unit_change({{"gauge-factor", name, 1e-3, {}}, {}, 0.0}),
                       filed.strain_per_V->sd / filed.strain_per_V->value});
      }
    }
  }

  const Campaign& campaign_;
  testing::CampaignForward forward_;
  Whitening whiten_;
  Readings base_;
};

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

double most_of(const EffectKind& kind, const Campaign& campaign) {
  if (kind.id == "fractional-damping") {
    return kMostFractional;
  }
  return std::min(kBeyondReason * std::abs(kind.typical - kind.null),
                  kMostOfBranch * first_branch_per_Pa(kind, campaign));
}

std::vector<Candidate> all_candidates(const Campaign& campaign) {
  std::vector<Candidate> out;
  for (const EffectKind& kind : campaign.split ? testing::shpb_effects() : testing::bar_effects()) {
    const double most = most_of(kind, campaign);
    if (!kind.per_gauge) {
      out.push_back({probe_of(kind, ""), kind, kind.null, most});
      if (kind.id == "second-relaxation") {
        out.back().effect.details["tau"] = 3e-4;
        for (const double tau : {2e-5, 8e-5, 1.5e-3}) {
          out.push_back({probe_of(kind, ""), kind, kind.null, most});
          out.back().effect.details["tau"] = tau;
        }
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
    const double sd = directions[static_cast<std::size_t>(i)].prior_sd;
    nuisance(i, i) += sd > 0.0 ? 1.0 / (sd * sd) : 0.0;
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
    const double detect = kDetect / std::sqrt(own);
    const double against_rival = kAgainstRival / std::sqrt(std::max(least, 0.0));
    found.detect = bent(found.candidate, detect);
    found.smallest = bent(found.candidate, std::max(detect, against_rival));
    found.rival_share = own > 0.0 ? std::sqrt(std::max(least, 0.0) / own) : 0.0;
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
