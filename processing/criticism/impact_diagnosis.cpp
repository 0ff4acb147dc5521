#include "processing/criticism/impact_diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "processing/criticism/held_out.hpp"
#include "processing/criticism/own_strengths.hpp"
#include "processing/criticism/statistics.hpp"

namespace kolsky {

namespace {

constexpr double kTie = 7.5;            ///< squares of normal deviates, as for bars
constexpr double kDetected = 6.0;       ///< sigma
constexpr double kToldApart = 5.0;      ///< sigma beside a rival
constexpr double kAllowedRest = 0.03;   ///< of a misfit that certified effects explain
constexpr double kUnexplained = -9.2;   ///< ln of the chance that noise leaves as much
constexpr double kSpeedsDiffer = -9.2;  ///< ln of the chance of strengths so different
constexpr double kPart = 0.02;  ///< of what an effect explains: no matter where speeds differ
constexpr std::size_t kMostRefits = 12;
/// Another solver of the same ball differs by up to three of the deviations allowed for the
/// solver's error, and in the same way at all speeds: a square of a normal deviate counts by this
/// less.
constexpr double kSolverDoubt = 6.0;

const char* const kReading = "three-dimensional-reading";
constexpr std::array kReadingNames{"full", "bulk-E1", "bulk-Einf", "exact"};

struct Tested {
  Candidate candidate;
  Direction direction;
  double evidence = 0.0;
  bool testable = false;
};

struct Refit {
  const Tested* tested = nullptr;
  Studied studied;
  double gain = 0.0;
  double log_p = 0.0;
  double evidence = 0.0;
};

/// Every strength over its reach would change the records by less than noise does.
bool beyond_reach(const Tested& tested) {
  const Direction& direction = tested.direction;
  if (direction.freedom <= 0.0 || !std::isfinite(direction.gain) ||
      direction.information.rows() == 0) {
    return true;
  }
  const EffectParameter& p = tested.candidate.use.effect->about().parameters.front();
  const double scale = tested.candidate.use.values[0].prior_sd > 0.0
                           ? tested.candidate.use.values[0].prior_sd
                           : p.typical;
  const double information = direction.information.diagonal().maxCoeff();
  return !(information > 0.0) || scale / std::sqrt(information) > p.upper - p.lower;
}

/// chi2 that strengths of their own at every speed would gain over the common one.
std::pair<double, double> disagreement(const Studied& studied, const std::string& id,
                                       const ImpactRecords& records, std::size_t per_shot) {
  const ModelFit& fit = studied.fit;
  Eigen::VectorXd clear = Eigen::VectorXd::Zero(fit.residual.size());
  Eigen::MatrixXd rest = fit.information;
  std::vector<Eigen::Index> own;
  for (std::size_t i = 0; i < fit.theta.size(); ++i) {
    const FreeNumber& number = studied.composition.numbers()[i];
    const EffectUse& use = studied.composition.uses()[number.use];
    const EffectParameter& parameter = use.effect->about().parameters[number.parameter];
    if (use.id() != id || number.shot >= 0 || parameter.auxiliary()) {
      continue;
    }
    const auto column = static_cast<Eigen::Index>(i);
    own.push_back(column);
    clear += (fit.theta[i] - parameter.null_value / number.scale) * fit.jacobian.col(column);
    rest.row(column).setZero();
    rest.col(column).setZero();
    rest(column, column) = 1.0;
  }
  const auto groups = static_cast<double>(records.groups.size());
  if (own.empty() || groups < 2.0) {
    return {0.0, 1.0};
  }
  Eigen::VectorXd share = fit.jacobian.transpose() * clear;
  for (const Eigen::Index column : own) {
    share[column] = 0.0;
  }
  clear -= fit.jacobian * rest.ldlt().solve(share);
  double q = 0.0;
  const auto size = static_cast<Eigen::Index>(per_shot);
  for (const SpeedGroup& group : records.groups) {
    double information = 0.0;
    double pull = 0.0;
    for (const std::size_t n : group.shots) {
      const auto part = clear.segment(static_cast<Eigen::Index>(n) * size, size);
      information += part.squaredNorm();
      pull += part.dot(fit.residual.segment(static_cast<Eigen::Index>(n) * size, size));
    }
    q += information > 0.0 ? pull * pull / information : 0.0;
  }
  return {q, groups - 1.0};
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
        "the "
        "bridge without the ball";
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

  Diagnosis run(const Model& model) {
    options_.progress(fmt::format("impacts at {} speeds on {} and {} elements, then the fit",
                                  records().groups.size(), kFineBall, kMiddleBall));
    const Studied first = study_.fit(model);
    Studied current = first;
    while (diagnosis_.effects.size() < options_.most_effects && add_one(current)) {
    }
    conclude(first, current);
    return std::move(diagnosis_);
  }

 private:
  [[nodiscard]] const ImpactRecords& records() { return study_.residuals().records(); }

  std::vector<Tested> test_all(const Studied& current) {
    std::vector<Candidate> candidates = candidates_for(current, study_.campaign());
    std::vector<Tested> all(candidates.size());
    study_.executor().run(all.size(), [&](std::size_t i, std::size_t worker) {
      Tested& own = all[i];
      own.candidate = candidates[i];
      own.direction =
          direction_of(own.candidate, current, study_.campaign(), study_.residuals(), worker);
      own.testable = !beyond_reach(own);
      if (own.testable) {
        own.evidence = equivalent_square(log_gain_tail(
            own.direction.gain / kSolverDoubt, own.direction.freedom, own.candidate.one_sided));
      }
    });
    trials_ = 1.0;
    for (const Tested& own : all) {
      trials_ += own.testable ? 1.0 : 0.0;
    }
    return all;
  }

  [[nodiscard]] double with_search(double log_p) const {
    return std::min(0.0, log_p + std::log(trials_));
  }

  /// The best variant of each effect within the margin; of the ball's own effects all, for first
  /// order says little of them when much is missing.
  static std::vector<const Tested*> worth_refitting(const std::vector<Tested>& all) {
    std::map<std::string, const Tested*> best;
    for (const Tested& own : all) {
      if (!own.testable) {
        continue;
      }
      auto& held = best[own.candidate.id() + (own.candidate.use.per_shot ? " per shot" : "")];
      if (held == nullptr || own.evidence > held->evidence) {
        held = &own;
      }
    }
    std::vector<const Tested*> ranked;
    for (const auto& [id, own] : best) {
      ranked.push_back(own);
    }
    std::sort(ranked.begin(), ranked.end(),
              [](const Tested* a, const Tested* b) { return a->evidence > b->evidence; });
    std::vector<const Tested*> chosen;
    for (const Tested* own : ranked) {
      const double margin = std::max(25.0, 0.6 * ranked.front()->evidence);
      if (chosen.size() < kMostRefits && own->evidence > 0.3 &&
          own->evidence > ranked.front()->evidence - margin) {
        chosen.push_back(own);
      }
    }
    return chosen;
  }

  std::optional<Refit> refit(const Tested& tested, const Studied& current, std::size_t worker) {
    const Candidate& candidate = tested.candidate;
    const Model model = with(current.model, candidate, true);
    const Composition composition(model, study_.campaign());
    std::vector<double> start = carry(current.composition, current.fit.theta, composition);
    if (!candidate.frees_prior) {
      Eigen::Index k = 0;
      for (std::size_t i = 0; i < start.size(); ++i) {
        const FreeNumber& number = composition.numbers()[i];
        const EffectUse& use = composition.uses()[number.use];
        if (use.id() == candidate.id() &&
            !use.effect->about().parameters[number.parameter].auxiliary() &&
            k < tested.direction.step.size()) {
          start[i] = std::clamp(start[i] + tested.direction.step[k++], number.lower / number.scale,
                                number.upper / number.scale);
        }
      }
    }
    ModelFit fit = fit_model(composition, study_.residuals(), serial_on(worker), start);
    if (!std::isfinite(fit.objective())) {
      // First order led to a ball that the solver refuses: begin at null.
      fit = fit_model(composition, study_.residuals(), serial_on(worker),
                      carry(current.composition, current.fit.theta, composition));
    }
    if (!std::isfinite(fit.objective()) || !fit.covariance.allFinite()) {
      return std::nullopt;
    }
    const double used =
        static_cast<double>(fit.residual.size()) - fit.degrees_of_freedom(composition);
    const Misfit misfit = study_.misfit_of(fit.residual, used);
    Refit out{&tested, {fitted(model, composition, fit), composition, std::move(fit), misfit}};
    const double freedom = current.fit.degrees_of_freedom(current.composition) -
                           out.studied.fit.degrees_of_freedom(out.studied.composition);
    out.gain =
        (current.fit.objective() - out.studied.fit.objective()) / std::max(1.0, misfit.noise_scale);
    out.log_p =
        log_gain_tail(out.gain / kSolverDoubt, candidate.frees_prior ? 1.0 : std::round(freedom),
                      candidate.one_sided && freedom < 1.5);
    out.evidence = equivalent_square(out.log_p);
    if (!own_strengths_confirmed(out.studied, candidate.id(), study_.campaign())) {
      return std::nullopt;
    }
    return out;
  }

  std::vector<Refit> refit_all(const std::vector<Tested>& all, const Studied& current) {
    const std::vector<const Tested*> chosen = worth_refitting(all);
    std::vector<std::optional<Refit>> done(chosen.size());
    options_.progress(fmt::format("refitting {} rivals", chosen.size()));
    study_.executor().run(chosen.size(), [&](std::size_t i, std::size_t worker) {
      done[i] = refit(*chosen[i], current, worker);
    });
    std::vector<Refit> list;
    for (auto& own : done) {
      if (own) {
        list.push_back(std::move(*own));
      }
    }
    std::sort(list.begin(), list.end(),
              [](const Refit& a, const Refit& b) { return a.evidence > b.evidence; });
    return list;
  }

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

  bool certified(const Refit& refit, const Studied& current) {
    const std::string id = refit.tested->candidate.id();
    const auto [q, freedom] =
        disagreement(refit.studied, id, records(), study_.residuals().per_shot());
    const bool agrees =
        log_chi2_tail(q / kSolverDoubt, freedom) > kSpeedsDiffer || q < kPart * refit.gain;
    return with_search(refit.log_p) <= options_.log_alpha && agrees &&
           gain_on_shots(current, refit.studied) > 0.0 &&
           (records().groups.size() < 2 || gain_on_speeds(current, refit.studied) > 0.0);
  }

  bool add_one(Studied& current) {
    options_.progress(diagnosis_.effects.empty()
                          ? "testing every effect of the library"
                          : "testing what remains after " + diagnosis_.effects.back());
    const std::vector<Tested> all = test_all(current);
    if (diagnosis_.candidates.empty()) {
      list_candidates(all, current);
    }
    const std::vector<Refit> refits = refit_all(all, current);
    if (diagnosis_.effects.empty()) {
      note_refits(refits, current);
    }
    if (refits.empty()) {
      return false;
    }
    for (const Refit& refit : refits) {
      if (refit.evidence < refits.front().evidence - kTie) {
        break;
      }
      const std::string id = refit.tested->candidate.id();
      if (!certified(refit, current)) {
        set_verdict(id, "rejected");
        continue;
      }
      std::vector<std::string> ties;
      for (const Refit& rival : refits) {
        const std::string other = rival.tested->candidate.id();
        if (other != id && rival.evidence > refit.evidence - kTie) {
          ties.push_back(other);
        }
      }
      diagnosis_.effects.push_back(id);
      diagnosis_.tied_with[id] = ties;
      current = refit.studied;
      return true;
    }
    return false;
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
    const auto now = static_cast<std::size_t>(own->values[0].value + 0.5);
    std::array<double, kReadingNames.size()> objective{};
    study_.executor().run(kReadingNames.size(), [&](std::size_t r, std::size_t worker) {
      if (r != now) {
        Model model = first.model;
        model.find(kReading)->values[0].value = static_cast<double>(r);
        objective[r] = study_.refit(model, serial_on(worker)).fit.objective();
      }
    });
    std::size_t best = now;
    for (std::size_t r = 0; r < kReadingNames.size(); ++r) {
      if (r != now && std::isfinite(objective[r]) &&
          (best == now || objective[r] < objective[best])) {
        best = r;
      }
    }
    const double ahead = (objective[best] - current.fit.objective()) / kSolverDoubt;
    if (best == now || ahead > kTie) {
      return;
    }
    const std::string name = kReadingNames.at(best);
    if (diagnosis_.effects.empty()) {
      diagnosis_.notes.push_back("reading " + name + " of the law leaves less unexplained than " +
                                 kReadingNames.at(now) + ": choose it with `model new --reading`");
    } else if (ahead < -kTie) {
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
    diagnosis_.unexplained_log_p = log_chi2_tail(chi2 / kSolverDoubt, freedom);
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
      diagnosis_.verdict = DiagnosisVerdict::adequate;
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
    diagnosis_.notes.push_back(
        fmt::format("judged up to {:.3g} kHz{}; nothing within {:.2g} % of the force is claimed: "
                    "the mesh of {} "
                    "elements differs from {} by {:.2g} % rms",
                    1e-3 * window.cutoff_Hz,
                    window.to_far_end_only ? ", until the far end's reflection is back" : "",
                    100.0 * residuals.solver_sd(), kMiddleBall, kFineBall,
                    100.0 * residuals.mesh_difference()));
    if (const EffectUse* law = current.model.find("finite-strain-law")) {
      diagnosis_.notes.push_back(fmt::format(
          "finite-strain law: {:.2f} ± {:.2f} on the way from Kirchhoff's stress (0) to Cauchy's "
          "(1)",
          law->values[0].value, law->values[0].sd));
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
    for (const SpeedSummary& speed : study_.compare(current).speeds) {
      if (speed.restitution_measured > 0.0) {
        diagnosis_.notes.push_back(fmt::format(
            "restitution at {:.1f} m/s: {:.4f} foretold, {:.4f} measured", speed.speed_m_per_s,
            speed.restitution_foretold, speed.restitution_measured));
      }
    }
  }

  void set_verdict(const std::string& id, const std::string& verdict) {
    for (CandidateResult& result : diagnosis_.candidates) {
      if (result.effect == id) {
        result.verdict = verdict;
      }
    }
  }

  void list_candidates(const std::vector<Tested>& all, const Studied& current) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Tested& own = all[i];
      const std::string id = own.candidate.id();
      CandidateResult result;
      const EffectParameter& parameter = own.candidate.use.effect->about().parameters.front();
      result.effect = id;
      result.parameter = parameter.name;
      result.unit = parameter.unit;
      result.verdict = own.testable ? "not needed" : "untestable";
      result.detectable = result.identifiable = INFINITY;
      if (own.testable) {
        const double prior_sd = own.candidate.use.values[0].prior_sd;
        const double scale =
            own.candidate.frees_prior && prior_sd > 0.0 ? prior_sd : parameter.typical;
        result.gain = own.direction.gain;
        result.log_p = with_search(log_gain_tail(own.direction.gain / kSolverDoubt,
                                                 own.direction.freedom, own.candidate.one_sided));
        result.strength = parameter.null_value + own.direction.step[0] * scale;
        result.sd = scale / std::sqrt(own.direction.information(0, 0));
        result.detectable = kDetected * std::sqrt(kSolverDoubt) * result.sd;
        set_identifiable(all, i, current, result);
      }
      const auto known = std::find_if(diagnosis_.candidates.begin(), diagnosis_.candidates.end(),
                                      [&](const auto& c) { return c.effect == id; });
      if (known == diagnosis_.candidates.end()) {
        diagnosis_.candidates.push_back(std::move(result));
      } else if (result.gain > known->gain) {
        *known = std::move(result);
      }
    }
  }

  static void set_identifiable(const std::vector<Tested>& all, std::size_t i,
                               const Studied& current, CandidateResult& result) {
    const Direction& own = all[i].direction;
    result.identifiable = result.detectable;
    if (own.information.rows() != 1) {
      return;
    }
    double closest = 0.0;
    for (const Tested& other : all) {
      if (!other.testable || other.candidate.id() == all[i].candidate.id() ||
          other.direction.information.rows() != 1) {
        continue;
      }
      double cross = own.columns.col(0).dot(other.direction.columns.col(0));
      if (current.fit.covariance.size() > 0) {
        cross -=
            own.model_share.col(0).dot(current.fit.covariance * other.direction.model_share.col(0));
      }
      cross /= std::sqrt(own.information(0, 0) * other.direction.information(0, 0));
      if (cross * cross > closest) {
        closest = std::min(1.0, cross * cross);
        result.nearest_rival = other.candidate.id();
      }
    }
    result.identifiable =
        std::max(result.detectable, kToldApart * std::sqrt(kSolverDoubt) * result.sd /
                                        std::sqrt(std::max(1e-12, 1.0 - closest)));
  }

  void note_refits(const std::vector<Refit>& refits, const Studied& current) {
    for (const Refit& refit : refits) {
      for (CandidateResult& result : diagnosis_.candidates) {
        if (result.effect == refit.tested->candidate.id()) {
          result.gain = refit.gain;
          result.log_p = with_search(refit.log_p);
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
  double trials_ = 1.0;
  bool overruled_ = false;  ///< by another reading of the law
};

}  // namespace

Diagnosis diagnose_impacts(ImpactStudy& study, const Model& model,
                           const DiagnosisOptions& options) {
  return Diagnostician(study, options).run(model);
}

std::vector<std::string> what_records_hold(ImpactStudy& study, const Studied& studied) {
  std::vector<std::string> lines;
  for (const char* part : {"core", "cover"}) {
    Model model = studied.model;
    for (EffectUse& use : model.effects) {
      const bool own = use.id() == std::string("three-element-") + part;
      for (std::size_t p = 0; p < use.values.size(); ++p) {
        use.values[p].free = own && p < 3;
        use.values[p].prior_sd = own && p < 3 ? 0.02 * use.values[p].value : 0.0;
      }
      use.prior_correlation.clear();
    }
    const Composition composition(model, study.campaign());
    std::vector<std::size_t> own;
    std::vector<double> size;
    for (std::size_t i = 0; i < composition.numbers().size(); ++i) {
      const FreeNumber& number = composition.numbers()[i];
      if (composition.uses()[number.use].id() == std::string("three-element-") + part) {
        own.push_back(i);
        size.push_back(number.start / number.scale);
      }
    }
    if (own.size() != 3) {
      continue;
    }
    const std::vector<double> theta = composition.start();
    const Eigen::VectorXd residual =
        study.residuals().evaluate(composition, theta, study.executor().first);
    Eigen::MatrixXd columns =
        derivatives(composition, study.residuals(), theta, residual, own, study.executor());
    for (Eigen::Index i = 0; i < 3; ++i) {
      columns.col(i) *= size[static_cast<std::size_t>(i)];  // by the logarithm of each
    }
    if (!columns.allFinite()) {
      continue;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(columns.transpose() * columns);
    constexpr double kKnown = 0.1;
    int known = 0;
    for (Eigen::Index i = 0; i < 3; ++i) {
      known += solver.eigenvalues()[i] * kKnown * kKnown > 1.0 ? 1 : 0;
    }
    const Eigen::VectorXd weakest = solver.eigenvectors().col(0);
    const double sd = 1.0 / std::sqrt(std::max(1e-12, solver.eigenvalues()[0]));
    lines.push_back(fmt::format(
        "{}: the records by themselves hold {} of its three numbers to a tenth; least known is "
        "{:+.2f} ln E1 {:+.2f} ln E2 {:+.2f} ln eta2, to a factor of {:.3g}",
        part, known, weakest[0], weakest[1], weakest[2], std::exp(std::min(sd, 10.0))));
  }
  return lines;
}

}  // namespace kolsky
