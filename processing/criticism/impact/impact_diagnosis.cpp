#include "processing/criticism/impact/impact_diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "processing/criticism/fitting/held_out.hpp"
#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/impact/flat_effects.hpp"
#include "processing/criticism/impact/impact_search.hpp"
#include "processing/criticism/search/shot_strengths.hpp"

namespace kolsky {

namespace {

constexpr double kAllowedRest = 0.03;   ///< of a misfit that certified effects explain
constexpr double kSpeedsDiffer = -9.2;  ///< ln of the chance of strengths so different
constexpr double kWorthAllowing = 0.8;  ///< of the solver's usual share: less is not worth it
constexpr double kPart = 0.02;    ///< of what an effect explains: no matter where speeds differ
constexpr double kPressed = 2.0;  ///< deviations beyond its bound that a law would have to go
const char* const kReading = "three-dimensional-reading";
const char* const kLaw = "finite-strain-law";
constexpr std::array kReadingNames{"full", "bulk-E1", "bulk-Einf", "exact"};

/// chi2 that strengths of their own at every speed would gain over the common one.
double disagreement(const Studied& studied, const std::string& id, const ImpactRecords& records,
                    std::size_t per_shot) {
  const ShotStrengths shots = shot_strengths(studied, id, per_shot);
  double q = 0.0;
  for (const SpeedGroup& group : records.groups) {
    double information = 0.0;
    double pull = 0.0;
    for (std::size_t i = 0; i < group.shots.size() && !shots.weight.empty(); ++i) {
      const std::size_t n = group.shots[i];
      information += shots.weight[n];
      pull += shots.weight[n] * (1.0 - shots.over_common[n]);
    }
    q += information > 0.0 ? pull * pull / information : 0.0;
  }
  return q;
}

/// By how many of its deviations the finite-strain law would leave its bounds if it might: to first
/// order, from the slope that is left at the bound.
double law_beyond_bounds(const Studied& studied) {
  const ModelFit& fit = studied.fit;
  const std::vector<FreeNumber>& numbers = studied.composition.numbers();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const FreeNumber& own = numbers[i];
    const double value = own.value_at(fit.theta[i]);
    const double edge = 1e-6 * (own.upper - own.lower);
    if (studied.composition.uses()[own.use].id() != kLaw ||
        (value > own.lower + edge && value < own.upper - edge)) {
      continue;
    }
    const auto at = static_cast<Eigen::Index>(i);
    double slope = fit.jacobian.col(at).dot(fit.residual);
    if (own.prior_sd > 0.0) {
      slope += (value - own.prior_mean) * own.scale / (own.prior_sd * own.prior_sd);
    }
    const double variance = fit.covariance(at, at);
    const double doubt = fit.doubt.size() > 0 ? fit.doubt(at, at) : 0.0;
    return std::abs(slope) * variance / std::sqrt(variance + doubt);
  }
  return 0.0;
}

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

NextExperiment separating(const std::vector<std::string>& ids) {
  const auto holds = [&](const char* word) {
    return std::any_of(ids.begin(), ids.end(),
                       [&](const std::string& id) { return id.find(word) != std::string::npos; });
  };
  NextExperiment next;
  next.separates = ids;
  if (holds("bridge") || holds("gauge-factor") || holds("amplifier") || holds("crosstalk")) {
    next.change =
        "a shunt or a striker of known momentum on the same gauges at the same strain: it shows "
        "the bridge without the ball";
  } else if (holds("off-centre") || holds("sabot") || holds("friction")) {
    next.change =
        "a photograph of the contact, and rebound speeds: they show what touches without the "
        "material";
  } else {
    next.change =
        "the materials alone on the Hopkinson bar at larger strain, and impacts at 15 to 20 m/s "
        "with "
        "rebound speeds";
  }
  return next;
}

class Diagnostician {
 public:
  Diagnostician(ImpactStudy& study, const DiagnosisOptions& options)
      : study_(study), options_(options) {}

  Diagnosis run(const Model& model, ImpactsSeen* seen) {
    options_.progress(fmt::format("impacts at {} speeds on {} and {} elements, then the fit",
                                  records().groups.size(), study_.residuals().meshes().fine,
                                  study_.residuals().meshes().middle));
    Studied first = study_.fit(model);
    first_anchor_ = study_.residuals().anchored_at();
    options_.progress("testing every effect of the library");
    std::optional<ImpactSearch> search(std::in_place, study_, first);
    if (const double share = search->solver_share(); share < kWorthAllowing) {
      first = study_.allowing(share, first);
      search.emplace(study_, first);
    }
    Studied current = first;
    while ((add_one(*search, current) || add_two(current)) &&
           diagnosis_.effects.size() < options_.most_effects) {
      options_.progress("testing what remains after " + diagnosis_.effects.back());
      search.emplace(study_, current);
    }
    weigh_beside_others(first, current);
    weigh_beside_rest(first);
    conclude(first, current);
    ImpactComparison after = study_.compare(current);
    note_restitution(after);
    if (seen != nullptr) {
      seen->before = diagnosis_.effects.empty() ? after : compared_at_first(first);
      seen->after = std::move(after);
    }
    return std::move(diagnosis_);
  }

 private:
  [[nodiscard]] const ImpactRecords& records() { return study_.residuals().records(); }

  /// Gain on shots and on speeds that the fits did not see.
  [[nodiscard]] double gain_on_shots(const Studied& before, const Studied& after) {
    const std::size_t per_shot = study_.residuals().per_shot();
    return sum(held_out_squares(before, per_shot)) - sum(held_out_squares(after, per_shot));
  }
  [[nodiscard]] double gain_on_speeds(const Studied& before, const Studied& after) {
    const std::size_t per_shot = study_.residuals().per_shot();
    return sum(held_out_speeds(before, records(), per_shot)) -
           sum(held_out_speeds(after, records(), per_shot));
  }

  bool certified(const ImpactSearch& search, const ImpactRefit& refit, const Studied& current) {
    const std::string id = search.candidate(refit).id();
    const double q = disagreement(refit.studied, id, records(), study_.residuals().per_shot());
    const double speeds = static_cast<double>(records().groups.size());
    const bool agrees = speeds < 2.0 || q < kPart * refit.gain ||
                        log_chi2_tail(q / search.scale(), speeds - 1.0) > kSpeedsDiffer;
    return search.with_search(refit.log_p) <= options_.log_alpha && agrees &&
           gain_on_shots(current, refit.studied) > 0.0 &&
           (speeds < 2.0 || gain_on_speeds(current, refit.studied) > 0.0);
  }

  bool add_one(ImpactSearch& search, Studied& current) {
    options_.progress("refitting rivals");
    const std::vector<ImpactRefit> refits = search.refits();
    scale_ = search.scale();
    if (diagnosis_.candidates.empty()) {
      diagnosis_.candidates = first_order_table(
          {search.candidates(), search.directions(), current, search.log_trials(), search.scale()});
      note_refits(search, refits, current);
    }
    const auto claimed = first_certified(search, refits, current);
    if (!claimed) {
      rest_.reset();
      // A filed number that is set free has its place in every model already.
      if (!refits.empty() && refits.front().evidence > kStandsBefore &&
          !search.candidate(refits.front()).frees_prior) {
        rest_ = Rest{search.candidate(refits.front()).id(), refits.front().studied};
      }
      return false;
    }
    const std::string id = search.candidate(*claimed).id();
    diagnosis_.effects.push_back(id);
    diagnosis_.tied_with[id] = beside(search, refits, *claimed);
    take(claimed->studied, current);
    return true;
  }

  /// Where two are missing, each spoils what the other foretells. So what came nearest to a claim
  /// takes its place, and is weighed beside the next (weigh_beside_others), if that is certified.
  bool add_two(Studied& current) {
    if (!rest_ || diagnosis_.effects.size() + 2 > options_.most_effects) {
      return false;
    }
    options_.progress("testing two effects, of which one is " + rest_->id);
    const Rest nearest = *rest_;
    Studied beside = nearest.studied;
    ImpactSearch search(study_, beside);
    const std::size_t place = diagnosis_.effects.size();
    if (!add_one(search, beside)) {
      rest_ = nearest;
      return false;
    }
    diagnosis_.effects.insert(diagnosis_.effects.begin() + static_cast<std::ptrdiff_t>(place),
                              nearest.id);
    current = std::move(beside);
    return true;
  }

  [[nodiscard]] const ImpactRefit* first_certified(const ImpactSearch& search,
                                                   const std::vector<ImpactRefit>& refits,
                                                   const Studied& current) {
    for (const ImpactRefit& refit : refits) {
      if (refit.evidence < refits.front().evidence - kStandsBefore) {
        break;
      }
      if (certified(search, refit, current)) {
        return &refit;
      }
      set_verdict(search.candidate(refit).id(), "rejected");
    }
    return nullptr;
  }

  /// What a refit does not stand before.
  [[nodiscard]] static std::vector<std::string> beside(const ImpactSearch& search,
                                                       const std::vector<ImpactRefit>& refits,
                                                       const ImpactRefit& own) {
    std::vector<std::string> ties;
    for (const ImpactRefit& rival : refits) {
      const std::string other = search.candidate(rival).id();
      if (other != search.candidate(own).id() && rival.evidence > own.evidence - kStandsBefore) {
        ties.push_back(other);
      }
    }
    return ties;
  }

  void take(const Studied& refit, Studied& current) {
    searched_ = refit.fit.objective();
    anchor_.emplace(refit.composition, refit.fit.theta);
    // Refits borrow their derivatives, and their fine forces from a ball without the effect.
    current = study_.settled(refit);
  }

  [[nodiscard]] Studied without(const Model& model, const std::string& id) {
    Model others = model;
    std::erase_if(others.effects, [&](const EffectUse& use) { return use.id() == id; });
    return study_.refit(others, study_.executor());
  }

  /// A number that every model here holds has no place to be taken from.
  [[nodiscard]] static bool is_filed(const Studied& first, const std::string& id) {
    return first.model.find(id) != nullptr;
  }

  /// What was found before other effects were may have stood for a mix of them, or be tied with one
  /// that is in the model by now: each again in its place beside the others, until all stay.
  void weigh_beside_others(const Studied& first, Studied& current) {
    constexpr int kMostPasses = 3;
    bool moved = diagnosis_.effects.size() > 1;
    for (int pass = 0; moved && pass < kMostPasses; ++pass) {
      moved = false;
      for (const std::string& id : std::vector<std::string>(diagnosis_.effects)) {
        moved = (!is_filed(first, id) && moves_beside_others(id, current)) || moved;
      }
    }
  }

  /// @return whether another took its place, or none
  bool moves_beside_others(const std::string& id, Studied& current) {
    options_.progress("weighing " + id + " beside what else was found");
    const Studied others = without(current.model, id);
    ImpactSearch search(study_, others);
    const std::vector<ImpactRefit> refits = search.refits();
    const ImpactRefit* claimed = first_certified(search, refits, others);
    diagnosis_.tied_with.erase(id);
    if (claimed == nullptr) {
      std::erase(diagnosis_.effects, id);
      set_verdict(id, "rejected");
      take(others, current);
      return true;
    }
    const std::string now = search.candidate(*claimed).id();
    std::replace(diagnosis_.effects.begin(), diagnosis_.effects.end(), id, now);
    diagnosis_.tied_with[now] = beside(search, refits, *claimed);
    if (now == id) {
      return false;
    }
    set_verdict(id, "rejected");
    take(claimed->studied, current);
    return true;
  }

  /// What is left may hold an effect that is not certified by itself. With it in the model, what
  /// was claimed may be tied with more.
  void weigh_beside_rest(const Studied& first) {
    if (!rest_ || diagnosis_.effects.empty()) {
      return;
    }
    for (const std::string& id : diagnosis_.effects) {
      options_.progress("weighing " + id + " beside " + rest_->id);
      if (is_filed(first, id) || rest_->studied.model.find(id) == nullptr) {
        continue;
      }
      const Studied others = without(rest_->studied.model, id);
      ImpactSearch search(study_, others);
      const std::vector<ImpactRefit> refits = search.refits();
      const auto own = std::find_if(refits.begin(), refits.end(), [&](const ImpactRefit& refit) {
        return search.candidate(refit).id() == id;
      });
      if (own == refits.end()) {
        continue;
      }
      std::vector<std::string>& ties = diagnosis_.tied_with[id];
      for (const std::string& other : beside(search, refits, *own)) {
        if (std::find(ties.begin(), ties.end(), other) == ties.end()) {
          ties.push_back(other);
        }
      }
    }
    diagnosis_.notes.push_back(
        "what is claimed leaves something that is not certified; nearest is " + rest_->id);
  }

  /// Other readings of the law in three dimensions, without what was found: where one does as well,
  /// what was found is not more than a choice of reading.
  void weigh_readings(const Studied& first, const Studied& current) {
    const EffectUse* own = first.model.find(kReading);
    const bool question =
        !diagnosis_.effects.empty() || current.misfit.repeatable_log_p < kUnexplained;
    if (own == nullptr || !question) {
      return;
    }
    options_.progress("weighing the other readings of the law in three dimensions");
    const auto now = static_cast<std::size_t>(std::lround(own->values[0].value));
    std::array<double, kReadingNames.size()> objective{};
    const auto with_reading = [&](std::size_t r, const Workers& executor, Settle settle) {
      Model model = first.model;
      model.find(kReading)->values[0].value = static_cast<double>(r);
      return study_.refit(model, executor, settle).fit.objective();
    };
    // All around the same fine forces, as the search itself.
    if (anchor_) {
      study_.residuals().anchor(first.composition, first_anchor_);
    }
    study_.executor().run(kReadingNames.size(), [&](std::size_t r, std::size_t worker) {
      if (r != now) {
        objective[r] = with_reading(r, serial_on(worker), Settle::roughly);
      }
    });
    std::size_t best = now;
    for (std::size_t r = 0; r < kReadingNames.size(); ++r) {
      if (r != now && std::isfinite(objective[r]) &&
          (best == now || objective[r] < objective[best])) {
        best = r;
      }
    }
    const auto ahead_of = [&](double objective_there) {
      return (objective_there - (anchor_ ? searched_ : current.fit.objective())) / scale_;
    };
    constexpr double kRoughlyKnown = 1.0;
    if (best != now &&
        std::abs(std::abs(ahead_of(objective[best])) - kStandsBefore) < kRoughlyKnown) {
      objective[best] = with_reading(best, study_.executor(), Settle::fully);
    }
    if (anchor_) {
      study_.residuals().anchor(anchor_->first, anchor_->second);
    }
    const double ahead = ahead_of(objective[best]);
    if (best == now || ahead > kStandsBefore) {
      return;
    }
    const std::string name = kReadingNames.at(best);
    if (diagnosis_.effects.empty()) {
      diagnosis_.notes.push_back("reading " + name + " of the law leaves less unexplained than " +
                                 kReadingNames.at(now) + ": choose it with `model new --reading`");
    } else if (ahead < -kStandsBefore) {
      diagnosis_.notes.push_back(
          "reading " + name + " of the law explains more than " + diagnosis_.effects.front() +
          " does: nothing is claimed; choose it with `model new --reading` and diagnose again");
      for (const std::string& id : diagnosis_.effects) {
        set_verdict(id, "rejected");
      }
      diagnosis_.effects.clear();
      diagnosis_.tied_with.clear();
      overruled_ = true;
    } else {
      diagnosis_.tied_with[diagnosis_.effects.front()].push_back(kReading);
      diagnosis_.notes.push_back("reading " + name + " of the law in place of " +
                                 kReadingNames.at(now) + " explains as much as " +
                                 diagnosis_.effects.front());
    }
  }

  void conclude(const Studied& first, const Studied& current) {
    weigh_readings(first, current);
    diagnosis_.before = first.misfit;
    diagnosis_.after = current.misfit;
    diagnosis_.model = current.model;
    const auto [chi2, freedom] = study_.repeated(current.fit.residual);
    const double explained = first.fit.objective() - current.fit.objective();
    diagnosis_.unexplained_log_p = study_.unexplained_log_p(current.fit.residual);
    const bool rest = diagnosis_.unexplained_log_p < kUnexplained &&
                      chi2 - freedom > kAllowedRest * std::max(0.0, explained);
    set_held_out(first, current);
    if (rest || overruled_) {
      diagnosis_.verdict = DiagnosisVerdict::unknown;
      for (const std::string& id : diagnosis_.effects) {
        set_verdict(id, "rejected");
      }
      if (!diagnosis_.effects.empty()) {
        diagnosis_.notes.push_back("nearest, but not enough: " + diagnosis_.effects.front());
      }
      diagnosis_.effects.clear();
      diagnosis_.tied_with.clear();
    } else if (diagnosis_.effects.empty()) {
      // What a ball lacks may have gone into the law's form, as far as that goes.
      diagnosis_.verdict = law_beyond_bounds(current) > kPressed ? DiagnosisVerdict::untestable
                                                                 : DiagnosisVerdict::adequate;
    } else {
      const bool tied = std::any_of(diagnosis_.tied_with.begin(), diagnosis_.tied_with.end(),
                                    [](const auto& own) { return !own.second.empty(); });
      diagnosis_.verdict = tied ? DiagnosisVerdict::tied : DiagnosisVerdict::named;
    }
    for (const std::string& id : diagnosis_.effects) {
      set_verdict(id, diagnosis_.tied_with[id].empty() ? "named" : "tied");
      for (CandidateResult& result : diagnosis_.candidates) {
        if (result.effect == id) {
          set_strength(current, id, result);
        }
      }
      for (const std::string& other : diagnosis_.tied_with[id]) {
        set_verdict(other, "tied");
      }
      if (!diagnosis_.tied_with[id].empty()) {
        std::vector<std::string> ids = diagnosis_.tied_with[id];
        ids.insert(ids.begin(), id);
        diagnosis_.next_experiment.push_back(separating(ids));
      }
    }
    add_notes(current);
  }

  void set_held_out(const Studied& before, const Studied& after) {
    const std::size_t per_shot = study_.residuals().per_shot();
    const double size = static_cast<double>(before.fit.residual.size());
    const bool speeds = records().groups.size() > 1;
    const auto mean = [&](const Studied& studied) {
      return (speeds ? sum(held_out_speeds(studied, records(), per_shot))
                     : sum(held_out_squares(studied, per_shot))) /
             size;
    };
    // Noise alone leaves what arrivals and offsets do not take up.
    const double left = 1.0 - study_.residuals().eliminated() / static_cast<double>(per_shot);
    diagnosis_.held_out = {mean(before), mean(after), left};
  }

  void add_notes(const Studied& current) {
    ImpactResiduals& residuals = study_.residuals();
    const ImpactWindow& window = records().window;
    if (records().groups.size() < 2) {
      diagnosis_.notes.emplace_back(
          "one speed: nothing was held out over speeds; what grows with the speed needs three");
    }
    if (study_.campaign().shots.size() == records().groups.size()) {
      diagnosis_.notes.emplace_back(
          "no shot is repeated: noise is what the samples before the pulse show, and deviations of "
          "the speed go unseen");
    }
    diagnosis_.notes.push_back(fmt::format(
        "judged up to {:.3g} kHz{}; the calculation may be off by {:.2g} % of the force slowly and "
        "by as much from sample to sample ({}the mesh of {} elements differs from {} by {:.2g} % "
        "rms once shifted to fit), and a square of a deviate counts over {:.2g}: `detectable` says "
        "what that leaves",
        1e-3 * window.cutoff_Hz,
        window.to_far_end_only ? ", until the far end's reflection is back" : "",
        100.0 * residuals.solver_sd(),
        residuals.solver_share() < 1.0
            ? fmt::format("by these records, {:.2f} of what is allowed for else; ",
                          residuals.solver_share())
            : "",
        residuals.meshes().middle, residuals.meshes().fine, 100.0 * residuals.mesh_difference(),
        scale_));
    const std::size_t unsaid = records().unsaid_rebounds();
    if (unsaid == study_.campaign().shots.size()) {
      diagnosis_.notes.emplace_back(
          "no rebound speeds: what damps the ball is known by the force alone");
    } else {
      diagnosis_.notes.push_back(fmt::format(
          "rebound speeds of {} shots are fitted, each known to {:.2g} %; of restitution the "
          "calculation may be off by {:.2g}",
          study_.campaign().shots.size() - unsaid, 100.0 * residuals.rebound_sd(),
          ImpactWhitening::kRestitutionDoubt));
    }
    note_law(current);
    note_friction(current);
    note_flat_effects(current);
    if (residuals.falling_share() > 0.0) {
      diagnosis_.notes.push_back(fmt::format(
          "at the highest speed {:.2g} % of the softening layer is strained beyond 1/(2|b|), from "
          "where on its law's stress falls with strain: such a strength is outside of what the law "
          "allows, and its size hangs on the mesh",
          100.0 * residuals.falling_share()));
    }
    if (residuals.speed_sd() > 0.0) {
      diagnosis_.notes.push_back(
          fmt::format("speeds scatter by {:.2g} % beyond what is filed or "
                      "repeats' noise explains",
                      100.0 * residuals.speed_sd()));
    }
    for (std::string& line : what_records_hold(study_, current)) {
      diagnosis_.notes.push_back(std::move(line));
    }
  }

  void note_restitution(const ImpactComparison& comparison) {
    for (const SpeedSummary& speed : comparison.speeds) {
      if (speed.restitution_measured > 0.0) {
        diagnosis_.notes.push_back(fmt::format(
            "restitution at {:.1f} m/s: {:.4f} foretold, {:.4f} measured", speed.speed_m_per_s,
            speed.restitution_foretold, speed.restitution_measured));
      }
    }
  }

  /// The first model with the forces that it was fitted with, which are at hand.
  [[nodiscard]] ImpactComparison compared_at_first(const Studied& first) {
    study_.residuals().anchor(first.composition, first_anchor_);
    return study_.compare(first);
  }

  /// Friction that is filed within a deviation is fitted, and so it is never missing.
  void note_friction(const Studied& current) {
    const EffectUse* friction = current.model.find("contact-friction");
    if (friction == nullptr || !(friction->values[0].prior_sd > 0.0)) {
      return;
    }
    const ModelValue& mu = friction->values[0];
    std::string note = fmt::format("friction reads {:.2f} ± {:.2f} where {:.2g} ± {:.2g} is filed",
                                   mu.value, mu.sd, mu.prior_mean, mu.prior_sd);
    const double pull = std::abs(mu.value - mu.prior_mean) / mu.prior_sd;
    const auto own = std::find_if(
        diagnosis_.candidates.begin(), diagnosis_.candidates.end(),
        [](const CandidateResult& candidate) { return candidate.effect == "contact-friction"; });
    constexpr double kFar = 2.0;
    if (pull > kFar && own != diagnosis_.candidates.end()) {
      note += fmt::format(
          ", {:.1f} filed deviations off: fitted, and not missing, as what is filed so widely is "
          "claimed only from {:.2g} off on. File what it reads, or a narrower deviation",
          pull, own->detectable);
    }
    if (const auto& second = study_.second_minimum()) {
      note +=
          fmt::format("; at {:.2f}, with other moduli, chi2 is more by {:.0f}, where {:.0f} tells",
                      second->friction, second->behind, kStandsBefore * scale_);
    }
    diagnosis_.notes.push_back(std::move(note));
  }

  void note_law(const Studied& current) {
    const EffectUse* law = current.model.find(kLaw);
    if (law == nullptr) {
      return;
    }
    std::string note = fmt::format(
        "finite-strain law: {:.2f} ± {:.2f} on the way from Kirchhoff's stress (0) to Cauchy's (1)",
        law->values[0].value, law->values[0].sd);
    if (const double beyond = law_beyond_bounds(current); beyond > 0.0) {
      note += fmt::format(", at its bound, beyond which the records want it by {:.1f} deviations",
                          beyond);
      note += beyond > kPressed ? ": something is missing that nothing tested here explains, and "
                                  "what is fitted took it up"
                                : "";
    }
    diagnosis_.notes.push_back(std::move(note));
  }

  /// What has no slope at none is not to be excluded by a search that begins there.
  void note_flat_effects(const Studied& current) {
    std::vector<std::string> untested;
    for (const CandidateResult& result : diagnosis_.candidates) {
      if (result.verdict == "untestable") {
        untested.push_back(result.effect);
      }
    }
    for (const FlatEffect& flat : flat_effects(study_, current, untested, kStandsBefore * scale_)) {
      if (!(flat.not_excluded > 0.0)) {
        continue;
      }
      std::string note =
          fmt::format("cannot exclude {} up to {:.2g} {}, which has no slope at none", flat.id,
                      flat.not_excluded, flat.unit);
      if (flat.nearest > 0.0) {
        note += fmt::format("; at {:.2g} {} chi2 is less by {:.0f}, where {:.0f} tells",
                            flat.nearest, flat.unit, flat.gain, kStandsBefore * scale_);
      }
      diagnosis_.notes.push_back(std::move(note));
    }
  }

  void set_verdict(const std::string& id, const std::string& verdict) {
    for (CandidateResult& result : diagnosis_.candidates) {
      if (result.effect == id) {
        result.verdict = verdict;
      }
    }
  }

  void note_refits(const ImpactSearch& search, const std::vector<ImpactRefit>& refits,
                   const Studied& current) {
    for (const ImpactRefit& refit : refits) {
      for (CandidateResult& result : diagnosis_.candidates) {
        if (result.effect == search.candidate(refit).id()) {
          result.gain = refit.gain;
          result.log_p = search.with_search(refit.log_p);
          result.own_log_p = refit.log_p;
          result.held_out_gain = records().groups.size() > 1
                                     ? gain_on_speeds(current, refit.studied)
                                     : gain_on_shots(current, refit.studied);
          set_strength(refit.studied, result.effect, result);
        }
      }
    }
  }

  ImpactStudy& study_;
  const DiagnosisOptions& options_;
  Diagnosis diagnosis_;
  double scale_ = kSolverDoubt;  ///< of the last search
  double searched_ = 0.0;        ///< objective with what was added last, as the search had it
  std::vector<double> first_anchor_;
  /// Where the fine forces were taken for what was added last.
  std::optional<std::pair<Composition, std::vector<double>>> anchor_;
  bool overruled_ = false;  ///< by another reading of the law
  struct Rest {
    std::string id;
    Studied studied;  ///< with it beside all that was found
  };
  /// What came nearest to a claim last, of what stands before nothing at all.
  std::optional<Rest> rest_;
};

}  // namespace

Diagnosis diagnose_impacts(ImpactStudy& study, const Model& model, const DiagnosisOptions& options,
                           ImpactsSeen* seen) {
  return Diagnostician(study, options).run(model, seen);
}

}  // namespace kolsky
