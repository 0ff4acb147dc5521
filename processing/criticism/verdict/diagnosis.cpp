#include "processing/criticism/verdict/diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "processing/criticism/fitting/held_out.hpp"
#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/search/own_strengths.hpp"
#include "processing/criticism/search/shot_strengths.hpp"
#include "processing/criticism/verdict/unexplained.hpp"

namespace kolsky {

namespace {

/// Beside the best, rivals this close in evidence (squares of normal deviates) are not told apart:
/// the true one stays in the set in 99.7 of 100 cases.
constexpr double kTie = 7.5;
/// A rival may be so much likelier to be chance than what may be named.
constexpr double kRivalChance = 10.0;
constexpr std::size_t kMostBelieved = 2;  ///< effects that are missing at once
constexpr double kAllowedRest = 0.01;     ///< of a misfit that one certified effect explains

std::string chance_text(double log_p) {
  constexpr double kLeast = -27.6;  // 1e-12: below, normal noise is no longer what one knows it as
  return log_p < kLeast ? "less than once in 10^12 campaigns"
                        : fmt::format("once in {:.2g} campaigns", std::exp(-log_p));
}

HeldOut held_out(const Studied& before, const Studied& after, Study& study) {
  const auto mean = [&](const Studied& studied) {
    return held_out_misfit(held_out_squares(studied, study), studied.fit.penalty,
                           static_cast<double>(study.residuals().size()));
  };
  return {mean(before), mean(after),
          study.campaign().shots.size() > 1 ? after.misfit.noise_scale : 1.0};
}

/// Whether an effect is so strong that nothing is built so: then noise was fitted with it.
/// @param slack  while effects beside it are still missing, it stands for a part of these, too
bool beyond_belief(const Studied& studied, const std::string& id, const Campaign& campaign,
                   double slack) {
  const EffectUse* use = studied.model.find(id);
  if (use == nullptr) {
    return false;
  }
  double peak = 0.0;
  for (const CampaignShot& shot : campaign.shots) {
    peak = std::max(peak, shot.facts.peak_strain);
  }
  const auto& parameters = use->effect->about().parameters;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    // What is as strong as anything built comes out stronger every other time.
    constexpr double kDeviations = 3.0;
    constexpr double kExcused = 0.02;
    constexpr double kMostExcused = 0.1;
    const auto beyond = [&](double unit, double most) {
      const double size = unit * std::abs(use->values[p].value);
      const double excused =
          std::clamp(kDeviations * unit * use->values[p].sd, kExcused * most, kMostExcused * most);
      return most > 0.0 && size - excused > slack * most;
    };
    if (beyond(1.0, parameters[p].most) || beyond(peak, parameters[p].most_times_peak)) {
      return true;
    }
  }
  return false;
}

}  // namespace

std::string name_of(DiagnosisVerdict verdict) {
  switch (verdict) {
    case DiagnosisVerdict::named:
      return "named";
    case DiagnosisVerdict::tied:
      return "tied";
    case DiagnosisVerdict::unknown:
      return "unknown";
    case DiagnosisVerdict::adequate:
      return "adequate";
    case DiagnosisVerdict::untestable:
      return "untestable";
    case DiagnosisVerdict::bad_data:
      return "bad-data";
  }
  return {};
}

namespace {

class Diagnostician {
 public:
  Diagnostician(Study& study, const DiagnosisOptions& options) : study_(study), options_(options) {}

  Diagnosis run(const Model& model) {
    options_.progress("fitting the model");
    start_ = model;
    Studied first =
        study_.fit(model, options_.safeguards.fitted_noise ? LearnNoise::yes : LearnNoise::no);
    diagnosis_.before = first.misfit;
    Studied current = first;
    while (diagnosis_.effects.size() < options_.most_effects && add_one(current)) {
    }
    if (diagnosis_.effects.size() == 1 && any_beyond_belief(current)) {
      // Nothing was found beside it that takes its part.
      drop(0, "rejected", without(current, diagnosis_.effects[0]), current);
    }
    if (options_.safeguards.backward && diagnosis_.effects.size() > 1) {
      // The last was certified beside all others, unless these take its part from another start.
      drop_unneeded(current, diagnosis_.effects.size() > kMostBelieved ? 0 : 1);
      if (reconsider(current)) {
        drop_unneeded(current, 0);
      }
    }
    if (on_trial_ && std::ranges::count(diagnosis_.effects, *on_trial_) > 0) {
      // Nothing found beside it makes the shots agree on it.
      for (const std::string& id : std::exchange(diagnosis_.effects, {})) {
        set_verdict(id, "rejected");
      }
      diagnosis_.tied_with.clear();
      current = study_.refit(first);
    }
    make_alike(current);
    conclude(first, current);
    return std::move(diagnosis_);
  }

 private:
  bool add_one(Studied& current) {
    options_.progress(diagnosis_.effects.empty()
                          ? "testing every effect of the library"
                          : "testing what remains after " + diagnosis_.effects.back());
    Search search(study_, current, start_, options_.safeguards);
    const bool first = diagnosis_.effects.empty();
    if (diagnosis_.candidates.empty()) {
      diagnosis_.candidates =
          first_order_table({search.candidates(), search.directions(), current, search.log_trials(),
                             1.0, search.known(), study_.residuals().per_shot()});
    }
    std::optional<Choice> choice = choose(search, current, first);
    if (!choice) {
      return false;
    }
    if (choice->on_trial) {
      on_trial_ = choice->id;
    }
    diagnosis_.effects.push_back(choice->id);
    start_ = with(start_, search.candidates()[choice->candidate], true);
    take(*choice, current);
    return true;
  }

  /// What one search certifies: the best, and what cannot be told from it.
  struct Choice {
    std::string id;
    std::size_t candidate = 0;
    Studied studied;
    std::vector<std::string> ties;
    /// The shots do not agree on it, as they may not while another is missing.
    bool on_trial = false;
  };

  std::optional<Choice> choose(Search& search, const Studied& base, bool note) {
    std::vector<Refit> refits = search.refits();
    const std::vector<Certification> held_out = certify(search, refits, base);
    const std::size_t per_shot = study_.residuals().per_shot();
    if (note) {
      std::vector<std::size_t> all(refits.size());
      std::iota(all.begin(), all.end(), std::size_t{0});
      note_refits(search, refits, held_out, all, per_shot, diagnosis_.candidates);
      for (const auto& [id, verdict] : search.dismissed()) {
        if (std::ranges::none_of(refits, [&](const Refit& refit) {
              return search.candidates()[refit.candidate].id() == id;
            })) {
          set_verdict(id, verdict);
        }
      }
    }
    std::optional<std::size_t> best;
    std::optional<std::size_t> leading;
    std::optional<std::size_t> nearest;
    std::vector<std::size_t> confirmed;
    for (std::size_t i = 0; i < refits.size(); ++i) {
      const Refit& refit = refits[i];
      // What slow noise does by itself is no rival.
      if (!plausible(search, refit)) {
        continue;
      }
      const bool may_be_named = claimable(search, refit);
      leading = may_be_named && !leading ? i : leading;
      if (leading && lead(refits[best.value_or(*leading)], refit) > kTie) {
        continue;
      }
      const std::string id = search.candidates()[refit.candidate].id();
      // Products of what each shot and each gauge has of its own are foretold by each other.
      const bool foretold = refit.products || (held_out[i].gain > 0.0 && held_out[i].share > 0.5);
      const Safeguards& safeguards = options_.safeguards;
      constexpr double kSlack = 1.5;
      const bool sound = (!safeguards.held_out || foretold) &&
                         !beyond_belief(refit.studied, id, study_.campaign(), kSlack);
      if (!sound || (safeguards.shot_agreement &&
                     !shots_agree(refit.studied, refit.gain, id, study_.campaign(), per_shot))) {
        set_verdict(id, "rejected");
        nearest = sound && may_be_named && !nearest ? i : nearest;
        continue;
      }
      confirmed.push_back(i);
      best = may_be_named && !best ? i : best;
    }
    if (!best) {
      return note && nearest ? std::optional(on_trial(search, refits[*nearest])) : std::nullopt;
    }
    std::vector<std::string> ties;
    Refit& refit = refits[*best];
    const std::string id = search.candidates()[refit.candidate].id();
    for (const std::size_t i : confirmed) {
      const std::string other = search.candidates()[refits[i].candidate].id();
      // One and the same may stand there twice, with its strengths alike or each shot's own.
      if (other != id && lead(refits[i], refits[*best]) < kTie) {
        ties.push_back(other);
      }
    }
    // An effect's variant that is confirmed stands for it, wherever it stands among them.
    std::ranges::stable_partition(confirmed, [&](std::size_t i) { return i == *best; });
    note_refits(search, refits, held_out, confirmed, per_shot, diagnosis_.candidates);
    return Choice{id, refit.candidate, std::move(refit.studied), std::move(ties)};
  }

  /// What comes nearest: shots may differ by what is missing beside it.
  static Choice on_trial(const Search& search, Refit& refit) {
    return Choice{search.candidates()[refit.candidate].id(),
                  refit.candidate,
                  std::move(refit.studied),
                  {},
                  true};
  }

  [[nodiscard]] bool claimable(const Search& search, const Refit& refit) const {
    return search.with_search(refit.log_p) <= options_.log_alpha;
  }

  /// Too little to be named by itself, enough not to be told from what is named with hardly more.
  [[nodiscard]] bool plausible(const Search& search, const Refit& refit) const {
    return search.with_search(refit.log_p) <= options_.log_alpha + std::log(kRivalChance);
  }

  /// Exact for those that may be named; of the others first order tells enough.
  std::vector<Certification> certify(const Search& search, const std::vector<Refit>& refits,
                                     const Studied& base) {
    const auto leading = std::find_if(refits.begin(), refits.end(),
                                      [&](const Refit& refit) { return claimable(search, refit); });
    std::vector<Certification> held_out;
    const std::size_t per_shot = study_.residuals().per_shot();
    const std::vector<double> before = held_out_squares(base, study_);
    for (const Refit& refit : refits) {
      const bool near =
          leading != refits.end() && plausible(search, refit) && lead(*leading, refit) < 2.0 * kTie;
      const Studied& own = refit.studied;
      held_out.push_back(certification(
          before, near ? held_out_squares(own, study_) : foretold_squares(own, study_),
          base.fit.penalty - own.fit.penalty,
          shot_strengths(own, search.candidates()[refit.candidate].id(), per_shot).weight));
    }
    return held_out;
  }

  /// The model goes on with it.
  void take(Choice& choice, Studied& current) {
    // The noise shows better now.
    study_.residuals().freeze(choice.studied.composition, choice.studied.fit.theta);
    current = study_.refit(choice.studied);
    if (options_.safeguards.fitted_noise) {
      study_.residuals().calibrate(current.composition, current.fit.theta);
      current = study_.refit(current);
    }
    diagnosis_.tied_with[choice.id] = std::move(choice.ties);
  }

  /// What was found first was chosen beside what was not known yet: each but the last is sought
  /// again beside all others. @return whether anything else took its place
  bool reconsider(Studied& current) {
    bool changed = false;
    for (std::size_t i = 0; i + 1 < diagnosis_.effects.size(); ++i) {
      const std::string id = diagnosis_.effects[i];
      options_.progress("seeking " + id + " again beside the others");
      const Studied base = without(current, id);
      Model start = start_;
      std::erase_if(start.effects, [&](const EffectUse& use) { return use.id() == id; });
      Search search(study_, base, start, options_.safeguards);
      std::optional<Choice> choice = choose(search, base, false);
      if (!choice || std::count(diagnosis_.effects.begin(), diagnosis_.effects.end(), choice->id) >
                         (choice->id == id ? 1 : 0)) {
        continue;
      }
      if (on_trial_ == id) {
        on_trial_.reset();
      }
      if (choice->studied.fit.objective() > current.fit.objective() + 1.0) {
        // Not where it was found before: that was better.
        std::ranges::replace(choice->ties, id, choice->id);
        diagnosis_.tied_with[id] = std::move(choice->ties);
        continue;
      }
      if (choice->id != id) {
        set_verdict(id, "not needed");
        diagnosis_.tied_with.erase(id);
        diagnosis_.effects[i] = choice->id;
        changed = true;
      }
      start_ = with(start, search.candidates()[choice->candidate], true);
      take(*choice, current);
    }
    return changed;
  }

  static Model model_without(const Studied& current, const std::string& id) {
    Model model = current.model;
    std::erase_if(model.effects, [&](const EffectUse& use) { return use.id() == id; });
    return model;
  }

  Studied without(const Studied& current, const std::string& id) {
    return changed(current, model_without(current, id));
  }

  /// The same begun from the moduli that the model started with: what goes may have stood in for
  /// one of them, which has moved to where it does nothing and does not find back.
  Studied without_from_start(const Studied& current, const std::string& id) {
    Model model = model_without(current, id);
    for (EffectUse& use : model.effects) {
      const EffectUse* start = start_.find(use.id());
      use = use.effect->about().base && start != nullptr ? *start : use;
    }
    start_moduli(model, study_.campaign(), study_.residuals());
    return begun_at(model, Composition(model, study_.campaign()).start());
  }

  /// Another model, begun from where one stands.
  Studied changed(const Studied& current, const Model& model) {
    const Composition composition(model, study_.campaign());
    return begun_at(model, carry(current.composition, current.fit.theta, composition));
  }

  Studied begun_at(const Model& model, std::vector<double> theta) {
    Composition composition(model, study_.campaign());
    ModelFit fit = fit_model(composition, study_.residuals(), study_.executor(), std::move(theta));
    const Misfit misfit =
        misfit_of(study_.residuals(), fit.residual, fit.degrees_of_freedom(composition));
    Model after = fitted(model, composition, fit);
    return {std::move(after), std::move(composition), std::move(fit), misfit};
  }

  /// Strengths that every gauge has of its own lean to none, since what all gauges have alike could
  /// be the source's: where one for all does as well, it is that.
  void make_alike(Studied& current) {
    constexpr double kNoWorse = -4.6;
    for (const std::string& id : diagnosis_.effects) {
      Model model = current.model;
      EffectUse* use = model.find(id);
      if (use == nullptr || !use->per_shot || !use->effect->about().each_gauge || use->alike) {
        continue;
      }
      use->alike = true;
      Studied alike = changed(current, model);
      const double freedom = alike.fit.degrees_of_freedom(alike.composition) -
                             current.fit.degrees_of_freedom(current.composition);
      const double loss = (alike.fit.objective() - current.fit.objective()) /
                          noise_of(current.misfit, study_.campaign().shots.size());
      if (freedom > 0.0 && log_chi2_tail(std::max(loss, 0.0), freedom) > kNoWorse) {
        current = std::move(alike);
      }
    }
  }

  /// Backward: what others have made superfluous goes, but for so many of the last.
  void drop_unneeded(Studied& current, std::size_t spared) {
    for (std::size_t i = 0; i + spared < diagnosis_.effects.size();) {
      const std::string id = diagnosis_.effects[i];
      Studied left = without(current, id);
      const bool confirmed =
          !options_.safeguards.own_strengths ||
          own_strengths_confirmed(current, id, study_.campaign(), Claim::standing);
      if (confirmed && missed_in(left, current)) {
        left = without_from_start(current, id);
      }
      if (!confirmed || !missed_in(left, current)) {
        drop(i, "not needed", std::move(left), current);
      } else {
        ++i;
      }
    }
  }

  /// Whether a fit is worse for want of what went.
  [[nodiscard]] bool missed_in(const Studied& left, const Studied& current) const {
    constexpr double kMissed = 16.0;  // as a square of a normal deviate
    const double noise = noise_of(current.misfit, study_.campaign().shots.size());
    const double loss = (left.fit.objective() - current.fit.objective()) / noise;
    return equivalent_square(log_gain_tail(loss, 1.0, false)) >= kMissed;
  }

  /// @param left  the fit without it
  void drop(std::size_t i, const std::string& verdict, Studied left, Studied& current) {
    const std::string id = diagnosis_.effects[i];
    current = std::move(left);
    std::erase_if(start_.effects, [&](const EffectUse& use) { return use.id() == id; });
    diagnosis_.tied_with.erase(id);
    diagnosis_.effects.erase(diagnosis_.effects.begin() + static_cast<std::ptrdiff_t>(i));
    set_verdict(id, verdict);
  }

  void conclude(const Studied& first, const Studied& current) {
    options_.progress("looking for what nothing explains");
    const Unexplained left = unexplained(study_, current);
    diagnosis_.unexplained_log_p = left.log_p;
    diagnosis_.after = current.misfit;
    // Both by the same measure of the noise.
    const Studied before = diagnosis_.effects.empty() ? first : study_.refit(first);
    diagnosis_.before = before.misfit;
    diagnosis_.held_out = held_out(before, current, study_);
    diagnosis_.model = current.model;
    const double noise = noise_of(current.misfit, study_.campaign().shots.size());
    const double explained = (before.fit.objective() - current.fit.objective()) / noise;
    // Smooth distortions show that something is left; how much, all that repeats.
    const double excess = std::max(left.excess, repeated_excess(current.misfit));
    const bool remains = diagnosis_.unexplained_log_p < options_.log_alpha &&
                         excess > allowed_rest() * std::max(0.0, explained);
    const std::vector<std::string> reasons =
        options_.safeguards.unknown ? why_unknown(current, remains) : std::vector<std::string>{};
    // What is claimed itself is no rival of what is claimed beside it.
    for (auto& [id, ties] : diagnosis_.tied_with) {
      std::erase_if(ties, [&](const std::string& other) {
        return std::ranges::count(diagnosis_.effects, other) > 0;
      });
    }
    const bool tied = std::any_of(diagnosis_.tied_with.begin(), diagnosis_.tied_with.end(),
                                  [](const auto& own) { return !own.second.empty(); });
    if (!reasons.empty()) {
      give_up(reasons, before);
    } else if (diagnosis_.effects.empty()) {
      diagnosis_.verdict = DiagnosisVerdict::adequate;
    } else {
      diagnosis_.verdict = tied ? DiagnosisVerdict::tied : DiagnosisVerdict::named;
    }
    for (const std::string& id : diagnosis_.effects) {
      set_verdict(id, diagnosis_.tied_with[id].empty() ? "named" : "tied");
      for (CandidateResult& result : diagnosis_.candidates) {
        if (result.effect == id) {
          set_strength(current, id, study_.residuals().per_shot(), result);
        }
      }
    }
    for (const auto& [id, ties] : diagnosis_.tied_with) {
      for (const std::string& other : ties) {
        set_verdict(other, "tied");
      }
    }
    if (study_.campaign().shots.size() < 2) {
      diagnosis_.notes.emplace_back(
          "one shot: held out were parts of its record, not shots; repeat the shot to certify");
    }
  }

  /// Nothing is named, and the model stays as it was.
  void give_up(const std::vector<std::string>& reasons, const Studied& before) {
    diagnosis_.verdict = DiagnosisVerdict::unknown;
    diagnosis_.notes.insert(diagnosis_.notes.end(), reasons.begin(), reasons.end());
    if (!diagnosis_.effects.empty()) {
      std::string nearest;
      for (const std::string& id : diagnosis_.effects) {
        set_verdict(id, "rejected");
        nearest += (nearest.empty() ? "" : " with ") + id;
      }
      diagnosis_.notes.push_back(fmt::format(
          "nearest came {}: held-out misfit {:.3g} -> {:.3g}, noise alone {:.3g}", nearest,
          diagnosis_.held_out.before, diagnosis_.held_out.after, diagnosis_.held_out.floor));
    }
    diagnosis_.effects.clear();
    diagnosis_.tied_with.clear();
    diagnosis_.model = before.model;
    diagnosis_.after = diagnosis_.before;
    diagnosis_.held_out.after = diagnosis_.held_out.before;
  }

  /// Why what was found is not what is missing, in sentences; empty: it may be.
  /// @param remains  misfit that nothing explains
  [[nodiscard]] std::vector<std::string> why_unknown(const Studied& current, bool remains) const {
    std::vector<std::string> reasons;
    if (remains) {
      reasons.push_back(fmt::format(
          "misfit repeats that no effect of the library explains: noise leaves as much {}",
          chance_text(diagnosis_.unexplained_log_p)));
    }
    if (at_all_gauges_but_one()) {
      reasons.emplace_back(
          "the records ask for one effect at every gauge but one: it stands for something of that "
          "one which the library lacks");
    }
    if (more_than_two()) {
      reasons.emplace_back(
          "it takes three effects of the library: likelier than that three are missing is that one "
          "is which the library lacks");
    }
    for (const std::string& id : diagnosis_.effects) {
      if (beyond_belief(current, id, study_.campaign(), 1.0)) {
        reasons.push_back(id + " would have to be stronger than anything is built");
      }
    }
    return reasons;
  }

  /// Beside what was found later, what was found first may have grown out of all bounds.
  [[nodiscard]] bool any_beyond_belief(const Studied& current) const {
    return std::any_of(
        diagnosis_.effects.begin(), diagnosis_.effects.end(),
        [&](const std::string& id) { return beyond_belief(current, id, study_.campaign(), 1.0); });
  }

  [[nodiscard]] double repeated_excess(const Misfit& misfit) const {
    const double noise = noise_of(misfit, study_.campaign().shots.size());
    return (misfit.chi2_reduced / noise - 1.0) * misfit.degrees_of_freedom;
  }

  /// Effects together fit what is not in the library better than one does, so less may remain.
  [[nodiscard]] double allowed_rest() const {
    const auto effects = static_cast<double>(std::max<std::size_t>(diagnosis_.effects.size(), 1));
    return kAllowedRest / (effects * effects);
  }

  /// What all gauges but one need alike is something of that one which the library does not have.
  [[nodiscard]] bool at_all_gauges_but_one() const {
    std::map<std::string, std::size_t> gauges;
    for (const std::string& id : diagnosis_.effects) {
      if (const auto colon = id.find(':'); colon != std::string::npos) {
        ++gauges[id.substr(0, colon)];
      }
    }
    const std::size_t most = study_.campaign().gauges() - 1;
    return most > 1 && std::any_of(gauges.begin(), gauges.end(),
                                   [&](const auto& own) { return own.second >= most; });
  }

  /// Anything can be expanded in three effects: that one is missing which the library does not have
  /// is likelier than that three are at once.
  [[nodiscard]] bool more_than_two() const { return diagnosis_.effects.size() > kMostBelieved; }

  void set_verdict(const std::string& id, const std::string& verdict) {
    for (CandidateResult& result : diagnosis_.candidates) {
      if (result.effect == id) {
        result.verdict = verdict;
      }
    }
  }

  Study& study_;
  const DiagnosisOptions& options_;
  Model start_;                          ///< unfitted, with the effects found so far
  std::optional<std::string> on_trial_;  ///< of these, what is to be certified beside others yet
  Diagnosis diagnosis_;
};

}  // namespace

Diagnosis diagnose(Study& study, const Model& model, const DiagnosisOptions& options) {
  return Diagnostician(study, options).run(model);
}

}  // namespace kolsky
