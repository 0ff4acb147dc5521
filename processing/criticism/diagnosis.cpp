#include "processing/criticism/diagnosis.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "processing/criticism/held_out.hpp"
#include "processing/criticism/next_experiment.hpp"
#include "processing/criticism/own_strengths.hpp"
#include "processing/criticism/shot_strengths.hpp"
#include "processing/criticism/statistics.hpp"
#include "processing/criticism/unexplained.hpp"

namespace kolsky {

namespace {

/// Beside the best, rivals this close in evidence (squares of normal deviates) are not told apart:
/// the true one stays in the set in 99.7 of 100 cases.
constexpr double kTie = 7.5;
constexpr double kLostByChance = 4.0;        ///< chi2 on held-out shots
constexpr double kAllowedRest = 0.01;        ///< of a misfit that certified effects explain
constexpr double kUnexplained = -6.9;        ///< ln of the chance that noise leaves as much
constexpr double kUnexplainedBeside = -4.6;  ///< the same beside certified effects

HeldOut held_out(const Studied& before, const Studied& after, Study& study) {
  const std::size_t per_shot = study.residuals().per_shot();
  const auto mean = [&](const Studied& studied) {
    const std::vector<double> squares = held_out_squares(studied, per_shot);
    return std::accumulate(squares.begin(), squares.end(), 0.0) /
           static_cast<double>(squares.size() * per_shot);
  };
  return {mean(before), mean(after),
          study.campaign().shots.size() > 1 ? after.misfit.noise_scale : 1.0};
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
    Studied first = study_.fit(model);
    diagnosis_.before = first.misfit;
    Studied current = first;
    while (diagnosis_.effects.size() < options_.most_effects && add_one(current)) {
    }
    if (diagnosis_.effects.size() > 1) {
      drop_unneeded(current);
    }
    conclude(first, current);
    return std::move(diagnosis_);
  }

 private:
  bool add_one(Studied& current) {
    options_.progress(diagnosis_.effects.empty()
                          ? "testing every effect of the library"
                          : "testing what remains after " + diagnosis_.effects.back());
    Search search(study_, current, start_);
    if (diagnosis_.candidates.empty()) {
      diagnosis_.candidates = first_order_table(
          {search.candidates(), search.directions(), current, search.log_trials()});
    }
    const std::vector<Refit> refits = search.refits();
    if (diagnosis_.effects.empty()) {
      note_refits(search, refits, current, study_.residuals().per_shot(), diagnosis_.candidates);
    }
    if (refits.empty() || search.with_search(refits.front().log_p) > options_.log_alpha) {
      return false;
    }
    const std::size_t per_shot = study_.residuals().per_shot();
    for (const Refit& refit : refits) {
      if (refit.evidence < refits.front().evidence - kTie) {
        break;
      }
      const std::string id = search.candidates()[refit.candidate].id();
      const auto [gain, better] = certification(current, refit.studied, per_shot);
      const std::size_t shots = study_.campaign().shots.size();
      const bool agrees = shots_agree(refit.studied, refit.gain, id, study_.campaign(), per_shot);
      // A filed number that was held by its deviation is found by the other shots whether it is
      // set free or not: nothing is gained on a held-out shot, and nothing may be lost.
      // Products of what each shot and each gauge has of its own are foretold by each other.
      const bool foretells = search.candidates()[refit.candidate].frees_prior
                                 ? gain > -kLostByChance
                                 : refit.products || (gain > 0.0 && 2 * better > shots);
      if (!foretells || !agrees || search.with_search(refit.log_p) > options_.log_alpha) {
        set_verdict(id, "rejected");
        continue;
      }
      std::vector<std::string> ties;
      for (const Refit& rival : refits) {
        const std::string other = search.candidates()[rival.candidate].id();
        if (other != id && rival.evidence > refit.evidence - kTie) {
          ties.push_back(other);
        }
      }
      // The noise shows better now.
      study_.residuals().freeze(refit.studied.composition, refit.studied.fit.theta);
      Studied next = study_.refit(refit.studied);
      study_.residuals().calibrate(next.fit.residual);
      next = study_.refit(next);
      diagnosis_.effects.push_back(id);
      start_ = with(start_, search.candidates()[refit.candidate], true);
      diagnosis_.tied_with[id] = ties;
      current = std::move(next);
      return true;
    }
    return false;
  }

  /// Backward: what later effects have made superfluous goes.
  void drop_unneeded(Studied& current) {
    for (std::size_t i = 0; i + 1 < diagnosis_.effects.size();) {
      const std::string id = diagnosis_.effects[i];
      Model without = current.model;
      std::erase_if(without.effects, [&](const EffectUse& use) { return use.id() == id; });
      const Composition composition(without, study_.campaign());
      ModelFit fit = fit_model(composition, study_.residuals(), study_.executor(),
                               carry(current.composition, current.fit.theta, composition));
      const double noise = noise_of(current.misfit, study_.campaign().shots.size());
      const double loss = (fit.objective() - current.fit.objective()) / noise;
      if (equivalent_square(log_gain_tail(loss, 1.0, false)) < 16.0 ||
          !own_strengths_confirmed(current, id, study_.campaign())) {
        const Misfit misfit =
            misfit_of(study_.residuals(), fit.residual, fit.degrees_of_freedom(composition));
        Model after = fitted(without, composition, fit);
        current = {std::move(after), composition, std::move(fit), misfit};
        diagnosis_.tied_with.erase(id);
        diagnosis_.effects.erase(diagnosis_.effects.begin() + static_cast<std::ptrdiff_t>(i));
        set_verdict(id, "not needed");
      } else {
        ++i;
      }
    }
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
    // That something is there is certain once an effect is certified.
    const double threshold = diagnosis_.effects.empty() ? kUnexplained : kUnexplainedBeside;
    const bool rest = diagnosis_.unexplained_log_p < threshold &&
                      left.excess > kAllowedRest * std::max(0.0, explained);
    const bool tied = std::any_of(diagnosis_.tied_with.begin(), diagnosis_.tied_with.end(),
                                  [](const auto& own) { return !own.second.empty(); });
    if (rest) {
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
      diagnosis_.verdict = tied ? DiagnosisVerdict::tied : DiagnosisVerdict::named;
    }
    for (const std::string& id : diagnosis_.effects) {
      set_verdict(id, diagnosis_.tied_with[id].empty() ? "named" : "tied");
      for (CandidateResult& result : diagnosis_.candidates) {
        if (result.effect == id) {
          set_strength(current, id, result);
        }
      }
    }
    for (const auto& [id, ties] : diagnosis_.tied_with) {
      for (const std::string& other : ties) {
        set_verdict(other, "tied");
      }
      if (!ties.empty()) {
        diagnosis_.next_experiment.push_back(next_experiment(id, ties, study_.campaign().bench));
      }
    }
    if (study_.campaign().shots.size() < 2) {
      diagnosis_.notes.emplace_back(
          "one shot: nothing was held out over shots; repeat the shot to certify");
    }
  }

  void set_verdict(const std::string& id, const std::string& verdict) {
    for (CandidateResult& result : diagnosis_.candidates) {
      if (result.effect == id) {
        result.verdict = verdict;
      }
    }
  }

  Study& study_;
  const DiagnosisOptions& options_;
  Model start_;  ///< unfitted, with the effects found so far
  Diagnosis diagnosis_;
};

}  // namespace

Diagnosis diagnose(Study& study, const Model& model, const DiagnosisOptions& options) {
  return Diagnostician(study, options).run(model);
}

}  // namespace kolsky
