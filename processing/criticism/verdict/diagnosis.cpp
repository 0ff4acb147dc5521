#include "processing/criticism/verdict/diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "processing/criticism/fitting/astray.hpp"
#include "processing/criticism/fitting/branch_order.hpp"
#include "processing/criticism/fitting/held_out.hpp"
#include "processing/criticism/fitting/moduli_starts.hpp"
#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/records/arrival_order.hpp"
#include "processing/criticism/search/candidate_table.hpp"
#include "processing/criticism/search/own_strengths.hpp"
#include "processing/criticism/search/shot_strengths.hpp"
#include "processing/criticism/search/slow_noise.hpp"
#include "processing/criticism/verdict/at_bounds.hpp"
#include "processing/criticism/verdict/choice.hpp"
#include "processing/criticism/verdict/claims.hpp"
#include "processing/criticism/verdict/disbelief.hpp"
#include "processing/criticism/verdict/filed_bars.hpp"
#include "processing/criticism/verdict/filed_conflict.hpp"
#include "processing/criticism/verdict/loud_pulses.hpp"
#include "processing/criticism/verdict/other_law.hpp"
#include "processing/criticism/verdict/parting.hpp"
#include "processing/criticism/verdict/refits.hpp"
#include "processing/criticism/verdict/slow_ties.hpp"
#include "processing/criticism/verdict/small_rest.hpp"
#include "processing/criticism/verdict/strength_notes.hpp"
#include "processing/criticism/verdict/unexplained.hpp"
#include "processing/criticism/verdict/unlisted.hpp"

namespace kolsky {

namespace {

constexpr double kAllowedRest = 0.01;  ///< of a misfit that one certified effect explains
/// ln of a chance that needs no search to be counted: 1e-5.
constexpr double kSure = -11.5;

HeldOut held_out(const Studied& before, const Studied& after, Left left, Study& study) {
  const auto mean = [&](const Studied& studied) {
    return held_out_misfit(held_out_squares(studied, study), studied.fit.penalty,
                           static_cast<double>(study.residuals().size()));
  };
  return {mean(before), mean(after), floor_of(after, left, study.campaign().shots.size())};
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

/// Where earlier beginnings of a search have been.
struct Trail {
  /// Effects that stood beside each other when two were found, and which of them was on trial.
  using Pair = std::pair<std::set<std::string>, std::string>;
  std::set<Pair> pairs;
  double excess = 0.0;  ///< misfit that was left where the last one ended
};

class Diagnostician {
 public:
  /// @param barred  is not what the search begins with
  /// @param trail   of earlier beginnings, to which this one's is added; outlives this
  Diagnostician(Study& study, const DiagnosisOptions& options, std::vector<std::string> barred,
                Trail& trail)
      : study_(study), options_(options), barred_(std::move(barred)), trail_(trail) {}

  /// What the search began with, where that led nowhere and what came next to it was not beaten:
  /// what was left unexplained outweighs its lead, and may be what made the lead.
  [[nodiscard]] const std::optional<std::string>& led_nowhere() const { return led_nowhere_; }

  Diagnosis run(const Model& model) {
    options_.progress("fitting the model");
    start_ = begun_afresh(model).value_or(model);
    Studied first =
        study_.fit(model, options_.safeguards.fitted_noise ? LearnNoise::yes : LearnNoise::no);
    diagnosis_.before = first.misfit;
    Studied current = first;
    const bool settled = seek(first, current);
    first = let_out_.value_or(first);
    if (trodden_) {
      led_nowhere_ = outweighed_by(trail_.excess) ? std::optional(begun_with_) : std::nullopt;
      diagnosis_.effects.clear();
      return std::move(diagnosis_);
    }
    if (diagnosis_.effects.size() == 1 && any_beyond_belief(current)) {
      // Nothing was found beside it that takes its part.
      drop(0, CandidateVerdict::rejected, without(study_, current, diagnosis_.effects[0]), current);
    }
    if (options_.safeguards.backward && diagnosis_.effects.size() > 1 && !settled) {
      go_back(current);
    }
    if (on_trial_ && std::ranges::count(diagnosis_.effects, *on_trial_) > 0) {
      // Nothing found beside it makes the shots agree on it.
      drop_claims(diagnosis_);
      current = study_.refit(first);
    }
    set_dwarfed_aside(current);
    set_what_a_law_leaves_aside(first, current);
    make_alike(current);
    set_drifts_of_shares_aside(current);
    tie_with_drifts(study_, current, diagnosis_);
    tie_with_hum(study_, current, diagnosis_);
    conclude(first, current);
    return std::move(diagnosis_);
  }

 private:
  /// One effect after another. Two are sought again beside each other before a third is: that may
  /// explain no more than what the first of them was chosen wrongly for.
  /// @return that nothing was added to two that stand beside each other
  bool seek(const Studied& first, Studied& current) {
    bool gone_back = false;
    while (surprises(diagnosis_.effects, current.model).size() < options_.most_effects) {
      const bool two = beside_the_bar(diagnosis_.effects).size() == 2;
      if (two && !gone_back && options_.safeguards.backward) {
        go_back(current);
        gone_back = true;
        far_off_ = leaves_most(first, current);
        if (has_been_here() || far_off_) {
          return true;
        }
      }
      if (!add_one(current)) {
        return two && gone_back && beside_the_bar(diagnosis_.effects).size() == 2;
      }
    }
    return false;
  }

  /// Whether two that stand beside each other leave more of what repeats than they explain: no
  /// third and no other beginning explains what nothing in the library is near to, and a search is
  /// long.
  bool leaves_most(const Studied& first, const Studied& current) {
    if (beside_the_bar(diagnosis_.effects).size() < 2) {
      return false;
    }
    const double noise = noise_of(current.misfit, study_.campaign().shots.size());
    // In the noise that is frozen, which is that of what was found.
    const Studied before = changed(study_, first, first.model);
    const double explained = (before.fit.objective() - current.fit.objective()) / noise;
    return explained < repeated_excess(study_, current);
  }

  /// Whether an earlier beginning came by the same pair: from there on the way is the same.
  bool has_been_here() {
    const std::set<std::string> here(diagnosis_.effects.begin(), diagnosis_.effects.end());
    trodden_ = beside_the_bar(diagnosis_.effects).size() == 2 &&
               !trail_.pairs.insert({here, on_trial_.value_or("")}).second;
    return trodden_;
  }

  /// Whether what is left weighs more than the lead of what the search began with, so that another
  /// beginning may be the right one.
  [[nodiscard]] bool outweighed_by(double excess) const {
    return !far_off_ && lead_over_next_ && *lead_over_next_ < excess;
  }

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
    std::optional<Choice> choice = first ? chooser_.choose_first(search, current, barred_)
                                         : chooser_.choose_next(search, current);
    if (first) {
      parting_ = parting_in_place_of(study_, current, start_, choice ? choice->studied : current);
    }
    if (!choice || parting_) {
      return false;
    }
    if (first) {
      begun_with_ = choice->id;
      lead_over_next_ = choice->lead_over_next;
    }
    if (choice->on_trial) {
      on_trial_ = choice->id;
    }
    diagnosis_.effects.push_back(choice->id);
    start_ = with(start_, search.candidates()[choice->candidate], Auxiliaries::free);
    take(*choice, current);
    return !first || let_out_ || !was_astray(current) || add_one(current);
  }

  /// A fit that has gone astray gains by whatever lets it out, and keeps the gain without it: then
  /// nothing was found, and the search begins from where the fit is now.
  bool was_astray(Studied& current) {
    if (!options_.safeguards.backward) {
      return false;
    }
    Studied left = without(study_, current, diagnosis_.effects.front());
    if (missed_in(study_, left, current)) {
      return false;
    }
    drop(0, CandidateVerdict::not_needed, std::move(left), current);
    diagnosis_.candidates.clear();
    on_trial_.reset();
    lead_over_next_.reset();
    let_out_ = current;
    return true;
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
    variants_differ_[choice.id] = choice.variants_differ;
  }

  void go_back(Studied& current) {
    const std::size_t found = diagnosis_.effects.size();
    const bool many = beside_the_bar(diagnosis_.effects).size() > kMostBelieved;
    // The last was certified beside all others, unless these take its part from another start.
    drop_unneeded(current, many ? 0 : 1);
    // It stood beside what is gone now, and its rivals may have been what that took up.
    const std::size_t spared = diagnosis_.effects.size() < found ? 0 : 1;
    if (reconsider(current, spared)) {
      drop_unneeded(current, 0);
    }
  }

  /// What was found first was chosen beside what was not known yet: each but so many of the last is
  /// sought again beside all others. @return whether anything else took its place
  bool reconsider(Studied& current, std::size_t spared) {
    bool changed = false;
    for (std::size_t i = 0; i + spared < diagnosis_.effects.size(); ++i) {
      const std::string id = diagnosis_.effects[i];
      options_.progress("seeking " + id + " again beside the others");
      const Studied base = without(study_, current, id);
      Model start = start_;
      std::erase_if(start.effects, [&](const EffectUse& use) { return use.id() == id; });
      Search search(study_, base, start, options_.safeguards);
      std::optional<Choice> choice = chooser_.choose_next(search, base);
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
        set_verdict(diagnosis_, id, CandidateVerdict::not_needed);
        diagnosis_.tied_with.erase(id);
        diagnosis_.effects[i] = choice->id;
        changed = true;
      }
      start_ = with(start, search.candidates()[choice->candidate], Auxiliaries::free);
      take(*choice, current);
    }
    return changed;
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
    return begun_at(study_, model, Composition(model, study_.campaign()).start());
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
      Studied alike = changed(study_, current, model);
      const double freedom = alike.fit.degrees_of_freedom(alike.composition) -
                             current.fit.degrees_of_freedom(current.composition);
      const double loss = (alike.fit.objective() - current.fit.objective()) /
                          noise_of(current.misfit, study_.campaign().shots.size());
      if (freedom > 0.0 && log_chi2_tail(std::max(loss, 0.0), freedom) > kNoWorse) {
        current = std::move(alike);
      }
    }
  }

  /// A drift is no claim beside a hum whose unequal shares do as well.
  void set_drifts_of_shares_aside(Studied& current) {
    auto hum = hum_in_shares(study_, current, diagnosis_.effects);
    if (!hum) {
      return;
    }
    for (const std::string& drift : hum->drifts) {
      drop_claim(diagnosis_, drift, CandidateVerdict::not_needed);
      std::erase_if(start_.effects, [&](const EffectUse& use) { return use.id() == drift; });
    }
    current = std::move(hum->studied);
  }

  /// A third beside a solid's formula that explains next to nothing of what the others do is what
  /// these leave.
  void set_dwarfed_aside(Studied& current) {
    if (!options_.safeguards.unknown ||
        beside_the_bar(diagnosis_.effects).size() <= kMostBelieved) {
      return;
    }
    const double noise = noise_of(current.misfit, study_.campaign().shots.size());
    const ClaimGains gains = claim_gains(study_, current, diagnosis_.effects, noise);
    const std::optional<std::string> id = dwarfed(gains);
    if (id) {
      set_aside_ = {*id, gains.others.at(*id), dwarfed_text(gains, *id)};
      const auto at = std::ranges::find(diagnosis_.effects, *id);
      drop(static_cast<std::size_t>(at - diagnosis_.effects.begin()), CandidateVerdict::rejected,
           without(study_, current, *id), current);
    }
  }

  /// What a specimen departs from a claimed law by, and is next to nothing of what that explains,
  /// is what the law's formula leaves: no second claim, and nothing against the first.
  void set_what_a_law_leaves_aside(const Studied& first, Studied& current) {
    if (!options_.safeguards.unknown || diagnosis_.effects.size() != 2) {
      return;
    }
    auto other = other_law_in_place_of(study_, current, diagnosis_.effects);
    if (!other) {
      return;
    }
    const double explained = first.fit.objective() - current.fit.objective();
    const double by_claim = other->without.fit.objective() - current.fit.objective();
    if (by_claim < kAllowedRest * explained) {
      diagnosis_.notes.push_back(
          fmt::format("{} would explain {:.1g} % of what {} does: by so much a specimen may depart "
                      "from that law",
                      other->claim, 100.0 * by_claim / explained, other->law));
      const auto at = std::ranges::find(diagnosis_.effects, other->claim);
      drop(static_cast<std::size_t>(at - diagnosis_.effects.begin()), CandidateVerdict::rejected,
           std::move(other->without), current);
    }
  }

  /// What claims beside a solid's formula leave, where it is so little of what they explain that it
  /// is their own; it is told, and counts in their deviations.
  /// @param more  it is more than noise leaves
  std::optional<SmallRest> their_own(const Studied& current, const Unexplained& left, bool more,
                                     double noise) {
    constexpr double kSpread = 2.0;  // deviations of what noise leaves of all that repeats
    if (!options_.safeguards.unknown || beside_the_bar(diagnosis_.effects).size() < 2 ||
        left.apart.log_p < options_.log_alpha || !(more || set_aside_)) {
      return std::nullopt;
    }
    const double repeated = repeated_excess(study_, current) -
                            kSpread * std::sqrt(2.0 * current.misfit.degrees_of_freedom);
    const double rest =
        std::max(set_aside_ ? set_aside_->gain : 0.0, more ? std::max(left.excess, repeated) : 0.0);
    ClaimGains gains = claim_gains(study_, current, diagnosis_.effects, noise);
    return rest < small_rest(gains) ? std::optional(SmallRest{std::move(gains), rest})
                                    : std::nullopt;
  }

  /// Backward: what others have made superfluous goes, but for so many of the last.
  void drop_unneeded(Studied& current, std::size_t spared) {
    for (std::size_t i = 0; i + spared < diagnosis_.effects.size();) {
      const std::string id = diagnosis_.effects[i];
      Studied left = without(study_, current, id);
      const bool confirmed = !options_.safeguards.own_strengths || stands(left, current, id);
      if (confirmed && missed_in(study_, left, current)) {
        left = without_from_start(current, id);
      }
      if (!confirmed || !missed_in(study_, left, current)) {
        drop(i, CandidateVerdict::not_needed, std::move(left), current);
      } else {
        ++i;
      }
    }
  }

  /// Whether strengths of each shot's own are still more than slow noise.
  bool stands(const Studied& left, const Studied& current, const std::string& id) {
    const EffectUse& use = *current.model.find(id);
    if (own_strengths_confirmed(current, id, study_.campaign(), Claim::standing)) {
      return true;
    }
    if (!is_addition(*use.effect)) {
      return false;
    }
    Candidate candidate{null_use(*use.effect, use.gauge)};
    for (std::size_t p = 0; p < use.values.size(); ++p) {
      const bool auxiliary = use.effect->about().parameters[p].auxiliary();
      candidate.use.values[p].free = !auxiliary;
      candidate.use.values[p].prior_sd = use.values[p].prior_sd;
      if (auxiliary) {
        candidate.use.values[p].value = use.values[p].value;
      }
    }
    candidate.use.per_shot = use.per_shot;
    candidate.use.alike = use.alike;
    const Direction direction = direction_of(candidate, left, study_);
    const SlowNoise::Addition addition{candidate, direction};
    return slow_noise_excluded(SlowNoise(left, study_).log_chance({&addition, 1}), Claim::standing);
  }

  /// @param left  the fit without it
  void drop(std::size_t i, CandidateVerdict verdict, Studied left, Studied& current) {
    const std::string id = diagnosis_.effects[i];
    current = std::move(left);
    std::erase_if(start_.effects, [&](const EffectUse& use) { return use.id() == id; });
    drop_claim(diagnosis_, id, verdict);
  }

  void conclude(const Studied& first, const Studied& current) {
    options_.progress("looking for what nothing explains");
    const Unexplained left = unexplained(study_, current);
    diagnosis_.unexplained_log_p = left.log_p;
    diagnosis_.after = current.misfit;
    // Both by the same measure of the noise, which what was found and let go again has changed.
    const Studied before = diagnosis_.effects.empty() ? current : study_.refit(first);
    diagnosis_.before = before.misfit;
    diagnosis_.model = current.model;
    const double noise = noise_of(current.misfit, study_.campaign().shots.size());
    const double explained = (before.fit.objective() - current.fit.objective()) / noise;
    // Smooth distortions show that something is left; how much, all that repeats.
    const double excess = std::max(left.excess, repeated_excess(study_, current));
    // Shots that ask for moduli or readings of their own may leave no more than noise does. What a
    // claim leaves of what it explains is its own inexactness only while noise might leave as much:
    // ends that return waves explain so much that anything else would be less than a share of it.
    const bool more = diagnosis_.unexplained_log_p < options_.log_alpha &&
                      (diagnosis_.effects.empty() || diagnosis_.unexplained_log_p < kSure ||
                       excess > allowed_rest() * std::max(0.0, explained));
    small_rest_ = their_own(current, left, more, noise);
    const bool remains = more && !small_rest_;
    diagnosis_.held_out = held_out(
        before, current,
        diagnosis_.unexplained_log_p < options_.log_alpha ? Left::more : Left::noise, study_);
    std::vector<std::string> reasons =
        doubts(before, current, remains ? std::optional(left) : std::nullopt, noise);
    if (set_aside_ && !small_rest_) {
      reasons.push_back(set_aside_->text);
    }
    const bool doubted = !reasons.empty();
    if (options_.safeguards.unknown && !doubted && diagnosis_.effects.empty()) {
      judge_loud_pulses(current, reasons);
    }
    if (reasons.empty()) {
      settle_claims(diagnosis_, [&](CandidateResult& result) {
        set_strength(current, result.effect, study_.residuals().per_shot(), result);
        result.sd = std::hypot(result.sd, variants_differ_[result.effect],
                               share_moved(small_rest_, result.effect) * result.strength);
      });
      note_strengths(current);
      if (blames_bar_of_two_gauges(diagnosis_, study_.campaign())) {
        diagnosis_.notes.push_back(two_gauges_text());
      }
      if (blames_times_of_several_gauges(diagnosis_, study_.campaign())) {
        diagnosis_.notes.push_back(several_times_text());
      }
    } else {
      // What shots or gauges have of their own says nothing of what the search began with.
      if (remains && left.common_log_p < options_.log_alpha && outweighed_by(excess)) {
        led_nowhere_ = begun_with_;
      }
      trail_.excess = excess;
      give_up(diagnosis_, reasons, before.model,
              floor_of(before, Left::more, study_.campaign().shots.size()));
      if (doubted) {
        tell_where(before);
      }
    }
    if (study_.campaign().shots.size() < 2) {
      note_one_shot();
    }
  }

  void note_one_shot() {
    diagnosis_.notes.emplace_back(
        "one shot: held out were parts of its record, not shots; repeat the shot to certify");
    const HeldOut& misfit = diagnosis_.held_out;
    if (diagnosis_.verdict == DiagnosisVerdict::adequate && beyond_quiet(misfit)) {
      diagnosis_.notes.push_back(left_of_one_shot_text("the model", misfit.after));
    }
  }

  /// More than noise may be beyond what the quiet part shows of it.
  [[nodiscard]] static bool beyond_quiet(const HeldOut& misfit) {
    constexpr double kOfQuiet = 1.5;
    return misfit.after > kOfQuiet * misfit.floor;
  }

  /// Numbers of what is claimed that stand at the end of what they may be.
  [[nodiscard]] std::vector<AtBound> claimed_at_bounds(const Studied& current) const {
    std::vector<AtBound> list = numbers_at_bounds(current.model);
    std::erase_if(list, [&](const AtBound& number) {
      return std::ranges::count(diagnosis_.effects, number.effect) == 0;
    });
    return list;
  }

  /// What the strengths found do not say by themselves.
  void note_strengths(const Studied& current) {
    if (small_rest_) {
      diagnosis_.notes.push_back(
          small_rest_text(*small_rest_, set_aside_ ? set_aside_->effect : ""));
    }
    for (const AtBound& number : claimed_at_bounds(current)) {
      diagnosis_.notes.push_back(in_words(number));
    }
    for (const std::string& id : diagnosis_.effects) {
      const EffectUse* use = current.model.find(id);
      if (use == nullptr) {
        continue;
      }
      for (const auto& text : {either_branch_text(current.model, id), unlike_formula_text(*use),
                               only_begins_text(*use)}) {
        if (text) {
          diagnosis_.notes.push_back(*text);
        }
      }
    }
  }

  /// At which gauge most of what nothing explains is.
  void tell_where(const Studied& before) {
    const auto where = where_text(loudness_of_pulses(study_, before), study_.campaign());
    if (where) {
      diagnosis_.notes.push_back(*where);
    }
  }

  /// Why what was found is not what is missing, by the noise that it was found with.
  std::vector<std::string> doubts(const Studied& before, const Studied& current,
                                  const std::optional<Unexplained>& remains, double noise) {
    if (!options_.safeguards.unknown) {
      return {};
    }
    if (parting_) {
      return {*parting_};
    }
    std::vector<std::string> reasons =
        why_unknown(diagnosis_, current, study_.campaign(), remains,
                    (before.fit.objective() - current.fit.objective()) / noise, options_.log_alpha);
    if (const FiledConflict filed = conflict_with_filed(current); filed.log_p < kSure) {
      reasons.push_back(filed_text(filed));
    }
    // An effect's limit is another effect that it only imitates.
    for (const AtBound& number : claimed_at_bounds(current)) {
      if (number.auxiliary) {
        reasons.push_back(in_words(number));
      }
    }
    if (is_worse_where_held_out()) {
      reasons.push_back("what was found makes shots that were held out misfit more");
    }
    if (leaves_much_of_one_shot()) {
      reasons.push_back(left_of_one_shot_text("what was found", diagnosis_.held_out.after));
    }
    if (!reasons.empty() || !diagnosis_.effects.empty()) {
      judge_filed_bars(before, current, noise, reasons);
    }
    if (reasons.empty()) {
      judge_temperature(current, noise, reasons);
    }
    if (reasons.empty()) {
      if (const auto law = other_law_in_place_of(study_, current, diagnosis_.effects)) {
        reasons.push_back(other_law_text(*law));
      }
    }
    if (const auto unlisted =
            unlisted_in_place_of(study_, before, current, beside_the_bar(diagnosis_.effects).size(),
                                 reasons.empty() ? InPlaceOf::claims : InPlaceOf::all)) {
      reasons.push_back(*unlisted);
    }
    return reasons;
  }

  /// What shots that were held out are farther from with it explains nothing.
  [[nodiscard]] bool is_worse_where_held_out() const {
    return !diagnosis_.effects.empty() && options_.safeguards.held_out &&
           diagnosis_.held_out.after > diagnosis_.held_out.before;
  }

  /// No other shot tells what a claim leaves from noise. Of one shot, then, that must be no more
  /// than noise may be beyond what the quiet part shows of it.
  [[nodiscard]] bool leaves_much_of_one_shot() const {
    const HeldOut& misfit = diagnosis_.held_out;
    return study_.campaign().shots.size() < 2 && !diagnosis_.effects.empty() &&
           beyond_quiet(misfit) &&
           misfit.after - misfit.floor > allowed_rest() * (misfit.before - misfit.after);
  }

  /// Where nobody filed at which temperature the bars have their moduli, these are off by what it
  /// was: that is no second effect.
  void judge_temperature(const Studied& current, double noise, std::vector<std::string>& reasons) {
    const std::string temperature = "temperature";
    const Bench& bench = study_.campaign().bench;
    if (bench.temperature_K || diagnosis_.effects.size() < 2 ||
        std::ranges::count(diagnosis_.effects, temperature) == 0) {
      return;
    }
    Model alone = current.model;
    std::erase_if(alone.effects, [&](const EffectUse& use) {
      return use.id() != temperature && std::ranges::count(diagnosis_.effects, use.id()) > 0;
    });
    if (const std::optional<Model> any = with_bars_of_any_moduli(alone, bench)) {
      if (changed(study_, current, *any).fit.objective() < current.fit.objective() + kTie * noise) {
        reasons.push_back(no_temperature_text());
      }
    }
  }

  /// What is claimed must do at least as well as other bars would. Where it is doubted anyway, they
  /// are told too if they do nearly as well: of a wrong wave speed lengths and positions make up
  /// three effects.
  void judge_filed_bars(const Studied& before, const Studied& current, double noise,
                        std::vector<std::string>& reasons) {
    constexpr double kBetter = 16.0;  // three numbers gain as much from noise once in a thousand
    constexpr double kNearly = 0.1;
    const std::optional<Model> any = with_bars_of_any_moduli(before.model, study_.campaign().bench);
    if (!any) {
      return;
    }
    const Studied other = changed(study_, before, *any);
    const double behind = other.fit.objective() - current.fit.objective();
    const double explained = before.fit.objective() - current.fit.objective();
    const bool doubted = !reasons.empty() && !diagnosis_.effects.empty();
    if (auto one = one_modulus_in_place_of_an_effect(current, noise)) {
      reasons.push_back(*std::move(one));
    } else if (behind < (doubted ? kNearly * explained : -kBetter * noise)) {
      reasons.push_back(other_bars_text(
          before.model, other.model,
          behind < 0.0 ? OtherBars::explain_more : OtherBars::explain_nearly_as_much));
    }
  }

  /// Where all shots are so alike that what is claimed to change the bars' moduli from shot to shot
  /// is another modulus in all of them.
  std::optional<std::string> one_modulus_in_place_of_an_effect(const Studied& current,
                                                               double noise) {
    for (const std::string& id : diagnosis_.effects) {
      if (!is_one_modulus(id, study_.campaign().shots)) {
        continue;
      }
      const Model left = model_without(current, id);
      const std::optional<Model> any = with_bars_of_any_moduli(left, study_.campaign().bench);
      const Studied other = changed(study_, current, any.value_or(left));
      if (any && other.fit.objective() < current.fit.objective() + kTie * noise) {
        return other_bars_text(left, other.model, OtherBars::explain_nearly_as_much) +
               one_modulus_text(id);
      }
    }
    return std::nullopt;
  }

  /// Where nothing comes back and nothing is claimed, by the noise of the quiet parts.
  void judge_loud_pulses(const Studied& current, std::vector<std::string>& reasons) {
    const std::vector<LoudPulses> loud = loudness_of_pulses(study_, current);
    if (study_.campaign().shots.size() > 1 && beyond_noise(loud.front())) {
      reasons.push_back(loud_text(loud, study_.campaign()));
    }
  }

  /// Beside what was found later, what was found first may have grown out of all bounds.
  [[nodiscard]] bool any_beyond_belief(const Studied& current) const {
    return std::any_of(
        diagnosis_.effects.begin(), diagnosis_.effects.end(),
        [&](const std::string& id) { return beyond_belief(current, id, study_.campaign(), 1.0); });
  }

  /// Effects together fit what is not in the library better than one does, so less may remain.
  [[nodiscard]] double allowed_rest() const {
    const auto effects = static_cast<double>(std::max<std::size_t>(diagnosis_.effects.size(), 1));
    return kAllowedRest / (effects * effects);
  }

  Study& study_;
  const DiagnosisOptions& options_;
  Model start_;                                    ///< unfitted, with the effects found so far
  std::map<std::string, double> variants_differ_;  ///< strengths of what is claimed, see `Choice`
  /// Claimed as the third, see `set_dwarfed_aside`.
  struct SetAside {
    std::string effect;
    double gain = 0.0;
    std::string text;  ///< why nothing is named where what it leaves is not the others' own
  };
  std::optional<SetAside> set_aside_;
  std::optional<SmallRest> small_rest_;
  std::optional<std::string> parting_;  ///< that the specimen's faces part, in a sentence
  std::vector<std::string> barred_;
  Trail& trail_;
  bool trodden_ = false;
  bool far_off_ = false;  ///< see `leaves_most`
  std::string begun_with_;
  std::optional<double> lead_over_next_;  ///< of that
  std::optional<std::string> led_nowhere_;
  std::optional<Studied> let_out_;       ///< the model, where its first fit had gone astray
  std::optional<std::string> on_trial_;  ///< of these, what is to be certified beside others yet
  Diagnosis diagnosis_;
  Chooser chooser_{study_, options_, diagnosis_};
};

/// Where two effects are missing, what fits best alone may be neither: a slow relaxation for a
/// dashpot beside a quick one. Then nothing fits beside it, and the search begins again with what
/// came next.
Diagnosis begun_rightly(Study& study, const Model& model, const DiagnosisOptions& options) {
  constexpr std::size_t kMostBeginnings = 3;
  std::vector<std::string> barred;
  Trail trail;
  std::optional<Diagnosis> first;
  while (true) {
    Diagnostician diagnostician(study, options, barred, trail);
    Diagnosis diagnosis = diagnostician.run(model);
    const std::optional<std::string>& dead_end = diagnostician.led_nowhere();
    if (!dead_end || barred.size() + 1 == kMostBeginnings) {
      return first && diagnosis.effects.empty() ? *std::move(first) : diagnosis;
    }
    options.progress("what fits best, " + *dead_end + ", leaves too much: beginning with the next");
    barred.push_back(*dead_end);
    study.residuals().believe_quiet();
    first = first ? std::move(first) : std::move(diagnosis);
  }
}

}  // namespace

Diagnosis diagnose(Study& study, const Model& model, const DiagnosisOptions& options) {
  Diagnosis diagnosis = begun_rightly(study, model, options);
  if (auto exchanged = out_of_order(study.campaign())) {
    diagnosis.notes.insert(diagnosis.notes.begin(), *std::move(exchanged));
  }
  return diagnosis;
}

}  // namespace kolsky
