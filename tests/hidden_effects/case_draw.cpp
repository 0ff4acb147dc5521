#include "tests/hidden_effects/case_draw.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "tests/hidden_effects/identifiability.hpp"

namespace kolsky::scoring {

namespace {

using Random = std::mt19937_64;
using testing::Campaign;
using testing::CampaignWishes;
using testing::HiddenEffect;
using testing::NoiseColour;

constexpr std::array kMultiples{1.0, 2.0, 4.0};
constexpr double kWithheldSigmas = 6.0;

double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

template <typename T>
const T& one_of(Random& random, const std::vector<T>& choices) {
  return choices[std::uniform_int_distribution<std::size_t>(0, choices.size() - 1)(random)];
}

NoiseColour draw_colour(Random& random, bool measured) {
  const double u = uniform(random, 0.0, 1.0);
  if (u < 0.6) {
    return NoiseColour::white;
  }
  if (u < 0.8) {
    return NoiseColour::coloured;
  }
  return u < 0.9 || !measured ? NoiseColour::pink : NoiseColour::measured;
}

CampaignWishes draw_wishes(Random& random, const Plan& plan) {
  CampaignWishes wishes;
  wishes.seed = random() % 1000000000u;
  wishes.measured_noise = plan.measured_noise;
  wishes.split = plan.split;
  wishes.soft_specimen = plan.soft;
  wishes.low_loss_specimen = plan.low_loss;
  if (plan.quick) {
    wishes.shots = 4;
    wishes.gauges = 3;
    wishes.rate_Hz = 1e6;
    wishes.samples = 1000;
    wishes.noise_strain = 4e-6;
    return wishes;
  }
  wishes.shots = std::uniform_int_distribution(4, plan.split ? 6 : 10)(random);
  wishes.gauges = std::uniform_int_distribution(2, plan.split ? 4 : 6)(random);
  wishes.noise_strain = uniform(random, 2e-6, 10e-6);
  wishes.colour = draw_colour(random, !plan.measured_noise.empty());
  wishes.tolerances =
      uniform(random, 0.0, 1.0) < 0.4 ? testing::Tolerances::filed : testing::Tolerances::none;
  const double u = uniform(random, 0.0, 1.0);
  if (u < 0.1) {
    // Where steps are coarse the noise is as others measured it; without any nothing would dither.
    wishes.bits = 8;
    wishes.noise_strain = uniform(random, 10e-6, 16e-6);
  }
  wishes.elastic = u > 0.9 && !plan.soft;
  return wishes;
}

// The same bench with other shots would need other sizes; only noise is new, and by how much what
// is filed is off: one draw of that would be in all cases of a bench.
Campaign anew(const Campaign& bench, const Plan& plan, Random& random) {
  Campaign campaign = bench;
  if (plan.truth_anew) {
    testing::draw_truth_anew(random, campaign);
  }
  campaign.wishes.seed = random() % 1000000000u;
  return campaign;
}

struct Planted {
  HiddenEffect effect;
  double multiple;
};

Planted sized(const Identifiable& found, double multiple, Random& random) {
  HiddenEffect effect = found.candidate.effect;
  if (found.all_or_nothing()) {
    effect.strength = found.candidate.kind.typical;
    return {effect, effect.strength / found.smallest};
  }
  const bool falls = found.candidate.kind.typical < found.candidate.null;
  double sign = falls ? -1.0 : 1.0;
  if (!found.candidate.kind.one_sided && uniform(random, 0.0, 1.0) < 0.5) {
    sign = -sign;
  }
  const double size = std::min(multiple * found.smallest, found.candidate.most);
  effect.strength = found.candidate.null + sign * size;
  return {effect, size / found.smallest};
}

Case with(std::string id, CaseKind kind, Campaign campaign, const std::vector<Planted>& planted) {
  Case made{std::move(id), kind, campaign, std::move(campaign), {}};
  for (const Planted& one : planted) {
    testing::hide(made.campaign, one.effect);
    made.multiples.push_back(one.multiple);
  }
  return made;
}

// One effect per family, so that effects with a gauge in their name are not drawn more often.
std::vector<const Identifiable*> drawn_families(const std::vector<Identifiable>& effects,
                                                bool withheld, Random& random) {
  std::map<std::string, std::vector<const Identifiable*>> families;
  for (const Identifiable& effect : effects) {
    if (effect.candidate.kind.withheld == withheld && (withheld || effect.possible())) {
      families[effect.candidate.effect.id].push_back(&effect);
    }
  }
  std::vector<const Identifiable*> out;
  for (const auto& [id, members] : families) {
    out.push_back(one_of(random, members));
  }
  std::ranges::shuffle(out, random);
  return out;
}

// What the generators do not make together: a solid bar ends freely or not at all, and a specimen
// that waves cross is a rod, whatever else is meant to happen at its faces or to its springs.
bool go_together(const Identifiable& a, const Identifiable& b) {
  static const std::set<std::string> beside_no_inertia{
      "specimen-nonlinearity", "radial-inertia", "interface-friction", "interface-gap", "punching"};
  const auto part = [](const std::string& one, const std::string& other) {
    return (one == "geometric-dispersion" && other == "end-reflection") ||
           (one == "specimen-inertia" && beside_no_inertia.contains(other));
  };
  const std::string& first = a.candidate.effect.id;
  const std::string& second = b.candidate.effect.id;
  return !part(first, second) && !part(second, first);
}

// Clearly there, and nobody could say which of several it is.
std::vector<Planted> tied(const std::vector<Identifiable>& effects, Random& random) {
  std::vector<Planted> out;
  for (const Identifiable& effect : effects) {
    if (!effect.candidate.kind.withheld && effect.seen_but_tied()) {
      const double multiple = kMultiples[1 + random() % 2];
      Identifiable to_be_seen = effect;
      to_be_seen.smallest = effect.detect;
      out.push_back(sized(to_be_seen, multiple, random));
    }
  }
  std::ranges::shuffle(out, random);
  return out;
}

// Unseen even at several times what laboratories meet.
std::vector<Planted> absorbed(const std::vector<Identifiable>& effects, Random& random) {
  std::vector<Planted> out;
  for (const Identifiable& effect : effects) {
    const double size = std::abs(effect.candidate.kind.typical - effect.candidate.null);
    if (!effect.candidate.kind.withheld && !effect.all_or_nothing() &&
        std::isfinite(effect.detect) && effect.detect > 6.0 * size) {
      HiddenEffect planted = effect.candidate.effect;
      planted.strength = effect.candidate.kind.typical;
      out.push_back({planted, size / effect.smallest});
    }
  }
  std::ranges::shuffle(out, random);
  return out;
}

std::vector<Planted> withheld(const Identifiability& found, Random& random) {
  std::vector<Planted> out;
  for (const Identifiable* effect : drawn_families(found.effects(), true, random)) {
    const double size = found.withheld_size(*effect, kWithheldSigmas);
    const double most = 20.0 * std::abs(effect->candidate.kind.typical);
    if (size < most) {
      HiddenEffect planted = effect->candidate.effect;
      planted.strength = std::min(uniform(random, 1.5, 3.0) * size, most);
      out.push_back({planted, planted.strength / size});
    }
  }
  return out;
}

}  // namespace

std::vector<Case> draw_cases(const Plan& plan, int bench) {
  Random random(plan.seed * 7919u + static_cast<std::uint64_t>(bench));
  const Campaign campaign = testing::draw_campaign(draw_wishes(random, plan));
  std::vector<Case> cases;
  const auto id = [&](CaseKind kind) {
    return fmt::format("b{:04}-{:02}-{}", bench, cases.size(), name_of(kind));
  };
  for (int i = 0; i < plan.nulls_per_bench; ++i) {
    cases.push_back(with(id(CaseKind::null), CaseKind::null, anew(campaign, plan, random), {}));
  }
  if (plan.singles_per_bench + plan.tied_per_bench + plan.doubles_per_bench +
          plan.absorbed_per_bench + plan.withheld_per_bench ==
      0) {
    return cases;
  }
  const Identifiability found(campaign);
  const auto singles = drawn_families(found.effects(), false, random);
  for (std::size_t i = 0;
       i < singles.size() && i < static_cast<std::size_t>(plan.singles_per_bench); ++i) {
    const double multiple = std::max(plan.least_multiple, kMultiples[random() % kMultiples.size()]);
    cases.push_back(with(id(CaseKind::single), CaseKind::single, anew(campaign, plan, random),
                         {sized(*singles[i], multiple, random)}));
  }
  for (int i = 0; i < plan.doubles_per_bench && singles.size() >= 2; ++i) {
    const auto drawn = drawn_families(found.effects(), false, random);
    const auto beside = std::find_if(drawn.begin() + 1, drawn.end(), [&](const Identifiable* own) {
      return go_together(*drawn[0], *own);
    });
    if (beside == drawn.end()) {
      continue;
    }
    const double multiple = kMultiples[1 + random() % 2];
    cases.push_back(with(id(CaseKind::two), CaseKind::two, anew(campaign, plan, random),
                         {sized(*drawn[0], multiple, random), sized(**beside, multiple, random)}));
  }
  const auto unclear = tied(found.effects(), random);
  for (std::size_t i = 0; i < unclear.size() && i < static_cast<std::size_t>(plan.tied_per_bench);
       ++i) {
    cases.push_back(
        with(id(CaseKind::tied), CaseKind::tied, anew(campaign, plan, random), {unclear[i]}));
  }
  const auto unseen = absorbed(found.effects(), random);
  for (std::size_t i = 0;
       i < unseen.size() && i < static_cast<std::size_t>(plan.absorbed_per_bench); ++i) {
    cases.push_back(with(id(CaseKind::absorbed), CaseKind::absorbed, anew(campaign, plan, random),
                         {unseen[i]}));
  }
  const auto strange = withheld(found, random);
  for (std::size_t i = 0;
       i < strange.size() && i < static_cast<std::size_t>(plan.withheld_per_bench); ++i) {
    cases.push_back(with(id(CaseKind::withheld), CaseKind::withheld, anew(campaign, plan, random),
                         {strange[i]}));
  }
  return cases;
}

}  // namespace kolsky::scoring
