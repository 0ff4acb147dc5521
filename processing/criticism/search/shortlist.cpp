#include "processing/criticism/search/shortlist.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "processing/criticism/search/candidate_kinds.hpp"
#include "processing/criticism/search/own_strengths.hpp"
#include "processing/criticism/search/shot_strengths.hpp"
#include "processing/models/formula_strength.hpp"

namespace kolsky {

namespace {

/// Evidence and candidate.
using Ranked = std::pair<double, std::size_t>;

/// The best variant of each effect, the best first.
std::vector<Ranked> best_variants(const SearchGround& ground) {
  // So much more must a harmonic explain than the mains' own frequency, which hums most: in a
  // record much shorter than a period all frequencies look alike, with amplitudes in inverse
  // proportion.
  constexpr double kHarmonic = 9.0;
  std::map<std::string, Ranked> best;
  for (std::size_t i = 0; i < ground.candidates.size(); ++i) {
    const double evidence = ground.evidence_of(i);
    const EffectUse& use = ground.candidates[i].use;
    auto& own = best[use.id() + (use.per_shot ? " per shot" : "") + (use.alike ? " alike" : "")];
    if (evidence > own.first + (is_harmonic(use) ? kHarmonic : 0.0)) {
      own = {evidence, i};
    }
  }
  std::vector<Ranked> ranked;
  for (const auto& [id, own] : best) {
    if (own.first > 0.0) {
      ranked.push_back(own);
    }
  }
  std::sort(ranked.rbegin(), ranked.rend());
  return ranked;
}

/// Whether it is chosen among a few which it is.
bool has_forms(const EffectUse& use) {
  return std::ranges::any_of(use.effect->about().parameters, &EffectParameter::chosen);
}

class Shortlist {
 public:
  explicit Shortlist(const SearchGround& ground)
      : ground_(ground), ranked_(best_variants(ground)) {}

  /// First-order ties can separate at finite size, the more so the larger the misfit.
  void add_near_the_best() {
    constexpr std::size_t kMostRefits = 14;
    // However far behind the first at first order; additions to records, which can follow nearly
    // anything slow there, stand in nobody's way.
    constexpr std::size_t kAlwaysRefits = 8;
    constexpr double kAlike = 0.99;  // two that first order does not tell apart go together
    std::size_t others = 0;
    double last = HUGE_VAL;
    for (const auto& [evidence, i] : ranked_) {
      const double best = ranked_.front().first;
      const double margin = std::max(25.0, 0.6 * best);
      // Far from the records, first order says little of what fits best.
      const bool near =
          evidence > best - margin ||
          ((ground_.far_off() || others < kAlwaysRefits) && evidence > kWorthRefitting);
      if (evidence > kAlike * last) {
        add(i);
      } else if (chosen_.size() < kMostRefits && near) {
        add(i);
        last = evidence;
        others += is_addition(*ground_.candidates[i].use.effect) ? 0 : 1;
      }
    }
  }

  /// What shots have of their own gains little by noise that was learned from their differences: of
  /// each such addition, one variant that slow noise does not do.
  void add_beyond_slow_noise(SlowChances& slow) {
    std::set<std::string> seen;
    for (const std::size_t i : chosen_) {
      if (may_be_slow_noise(ground_.candidates[i])) {
        seen.insert(ground_.candidates[i].id());
      }
    }
    add_where([&](std::size_t i) {
      const Candidate& own = ground_.candidates[i];
      return may_be_slow_noise(own) && seen.insert(own.id()).second &&
             slow_noise_excluded(slow.of(i).least(), Claim::fresh);
    });
  }

  /// At the gauge of the best a delay, a filter and a length.
  void add_at_the_same_gauge() {
    for (const auto& [evidence, i] : ranked_) {
      if (at_one_gauge(ground_.candidates[i], ground_.candidates[ranked_.front().second])) {
        add(i);
      }
    }
  }

  /// Of a hum the mains' other frequency: a record that is short beside both knows neither.
  void add_other_mains() {
    const std::vector<std::size_t> sought = chosen_;
    for (const std::size_t hum : sought) {
      add_where([&](std::size_t i) {
        return is_other_mains(ground_.candidates[i], ground_.candidates[hum]);
      });
    }
  }

  /// Of what is there or not, first order takes a share, and of what begins suddenly it tells no
  /// variant from another: far from the records that says nothing.
  void add_what_is_there_or_not() {
    if (!ground_.far_off()) {
      return;
    }
    add_where([&](std::size_t i) {
      return is_switch(ground_.candidates[i]) || is_sudden(ground_.candidates[i]);
    });
  }

  /// First order hardly tells an effect's times apart, and far from the records not its forms: a
  /// bending of 1 mm was refitted as one of the deflection alone, which it is not, and a relaxation
  /// from a time whose valley leads elsewhere. (Far from the records times do not matter so: what
  /// is found first is found beside others again.)
  void add_other_variants_of_leaders() {
    constexpr std::size_t kLeaders = 3;
    constexpr double kNearlyAsGood = 0.7;
    for (std::size_t r = 0; r < std::min(kLeaders, ranked_.size()); ++r) {
      const auto& [evidence, best] = ranked_[r];
      const EffectUse& leader = ground_.candidates[best].use;
      if (has_forms(leader) != ground_.far_off() || leader.per_shot || is_harmonic(leader)) {
        continue;
      }
      const double least = ground_.far_off() ? 0.0 : kNearlyAsGood * evidence;
      add_where([&](std::size_t i) {
        const EffectUse& use = ground_.candidates[i].use;
        return use.id() == leader.id() && !use.per_shot && use.alike == leader.alike &&
               !is_harmonic(use) && ground_.evidence_of(i) >= least;
      });
    }
  }

  /// Of what every specimen does by formula first order says little where moduli do its work.
  void add_formulas() {
    constexpr double kSomething = 25.0;  // of evidence: noise seldom has as much
    if (ranked_.empty() || ranked_.front().first <= kSomething) {
      return;
    }
    add_where([&](std::size_t i) { return has_formula(ground_.candidates[i].use); });
  }

  /// Of the material, what can say nothing at first order for standing at its bound.
  void add_bounded_materials() {
    if (std::ranges::none_of(chosen_,
                             [&](std::size_t i) { return of_material(ground_.candidates[i]); })) {
      return;
    }
    add_where([&](std::size_t i) {
      const Candidate& own = ground_.candidates[i];
      return of_material(own) && own.signs == Signs::one &&
             own.use.effect->about().parameters.size() == 1 && !own.use.per_shot;
    });
  }

  /// The same of a gauge that comes into question: a filter is a delay at first order, which moduli
  /// take up between two gauges, and what it does to amplitudes grows by the square of its time.
  void add_bounded_sensors() {
    constexpr double kAsGood = 0.5;
    const auto leads = [&](const Ranked& own) {
      return own.first > kWorthRefitting && own.first > kAsGood * ranked_.front().first;
    };
    add_where([&](std::size_t i) {
      const Candidate& own = ground_.candidates[i];
      return own.signs == Signs::one && !own.use.per_shot &&
             std::ranges::any_of(ranked_, [&](const Ranked& leader) {
               return leads(leader) && at_one_gauge(own, ground_.candidates[leader.second]);
             });
    });
  }

  [[nodiscard]] const std::vector<std::size_t>& chosen() const { return chosen_; }

 private:
  void add(std::size_t candidate) {
    if (std::ranges::find(chosen_, candidate) == chosen_.end()) {
      chosen_.push_back(candidate);
    }
  }

  template <typename Condition>
  void add_where(const Condition& condition) {
    for (std::size_t i = 0; i < ground_.candidates.size(); ++i) {
      if (condition(i)) {
        add(i);
      }
    }
  }

  const SearchGround& ground_;
  std::vector<Ranked> ranked_;
  std::vector<std::size_t> chosen_;
};

}  // namespace

std::vector<std::size_t> worth_refitting(const SearchGround& ground, SlowChances* slow) {
  Shortlist list(ground);
  list.add_near_the_best();
  if (slow != nullptr) {
    list.add_beyond_slow_noise(*slow);
  }
  list.add_at_the_same_gauge();
  list.add_other_mains();
  list.add_what_is_there_or_not();
  list.add_other_variants_of_leaders();
  list.add_formulas();
  list.add_bounded_materials();
  list.add_bounded_sensors();
  return list.chosen();
}

}  // namespace kolsky
