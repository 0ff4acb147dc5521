#include "processing/criticism/experiment/next_experiment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>

#include "processing/algebra/algebra.hpp"
#include "processing/criticism/experiment/changed_campaign.hpp"
#include "processing/criticism/search/candidates.hpp"

namespace kolsky {

namespace {

/// A rival is told apart by 7.5 squares of deviations; that much is then there nine times in ten.
constexpr double kToldApart = 16.0;
constexpr double kMostShots = 60.0;
constexpr std::uint64_t kSeed = 1;

/// The model at a campaign as if it were fitted there: nothing is moved.
Studied standing(Study& study, const Model& model) {
  Composition composition(model, study.campaign());
  ModelFit fit;
  fit.theta = composition.start();
  study.residuals().freeze(composition, fit.theta);
  fit.residual = study.residuals().evaluate(composition, fit.theta);
  std::vector<std::size_t> all(fit.theta.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  fit.jacobian =
      derivatives(composition, study.residuals(), fit.theta, fit.residual, all, study.executor());
  fit.information = fit.jacobian.transpose() * fit.jacobian + composition.prior_precision();
  fit.covariance = symmetric_inverse(fit.information);
  return {model, std::move(composition), std::move(fit), {}};
}

/// Where an effect's strengths stand among a composition's numbers, and how far they are from null.
struct Strengths {
  std::vector<Eigen::Index> places;
  Eigen::VectorXd values;
};

Strengths strengths_of(const Studied& studied, const std::string& id) {
  Strengths own;
  std::vector<double> values;
  for (std::size_t i = 0; i < studied.fit.theta.size(); ++i) {
    const FreeNumber& number = studied.composition.numbers()[i];
    const EffectUse& use = studied.composition.uses()[number.use];
    const EffectParameter& parameter = use.effect->about().parameters[number.parameter];
    if (use.id() == id && !parameter.auxiliary()) {
      own.places.push_back(static_cast<Eigen::Index>(i));
      values.push_back(studied.fit.theta[i] - number.theta_of(parameter.null_value));
    }
  }
  own.values =
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  return own;
}

/// The square of the deviations at which an effect stands with a rival free beside it.
double stands_beside(const Studied& studied, const Strengths& own, const Direction& rival) {
  const Eigen::MatrixXd& covariance = studied.fit.covariance;
  Eigen::MatrixXd open = covariance(own.places, own.places);
  if (rival.freedom > 0.0) {
    constexpr double kAbsorbed = 1e-9;
    const Eigen::MatrixXd taken = (covariance * rival.model_share)(own.places, Eigen::all);
    for (Eigen::Index i = 0; i < rival.information.rows(); ++i) {
      if (rival.information(i, i) <= kAbsorbed * rival.unprojected(i, i)) {
        return 0.0;  // what is fitted takes it up, the effect too
      }
    }
    open += taken * symmetric_inverse(rival.information) * taken.transpose();
  }
  return own.values.dot(solve_symmetric(open, own.values));
}

/// The least over the rivals and over all their variants.
double least_beside(Study& study, const Studied& studied, const std::string& effect,
                    const std::vector<std::string>& rivals) {
  const Strengths own = strengths_of(studied, effect);
  std::vector<Candidate> candidates = candidates_for(studied, study.campaign());
  std::erase_if(candidates, [&](const Candidate& candidate) {
    return candidate.use.per_shot || std::ranges::count(rivals, candidate.id()) == 0;
  });
  if (own.places.empty() || candidates.empty()) {
    return 0.0;
  }
  std::vector<double> squares(candidates.size());
  study.executor().run(candidates.size(), [&](std::size_t i, std::size_t worker) {
    squares[i] = stands_beside(studied, own, direction_of(candidates[i], studied, study, worker));
  });
  return *std::ranges::min_element(squares);
}

/// A rival fitted in the effect's place, from where first order puts it; of its variants the one
/// that first order prefers.
double objective_of(Study& study, const Studied& bare, const std::string& rival) {
  std::vector<Candidate> candidates = candidates_for(bare, study.campaign());
  std::erase_if(candidates, [&](const Candidate& candidate) {
    return candidate.use.per_shot || candidate.id() != rival;
  });
  std::vector<Direction> directions(candidates.size());
  study.executor().run(candidates.size(), [&](std::size_t i, std::size_t worker) {
    directions[i] = direction_of(candidates[i], bare, study, worker);
  });
  const auto best = std::ranges::max_element(directions, {}, &Direction::gain);
  if (best == directions.end()) {
    return std::numeric_limits<double>::infinity();
  }
  const Candidate& candidate = candidates[static_cast<std::size_t>(best - directions.begin())];
  const Composition composition(with(bare.model, candidate, Auxiliaries::free), study.campaign());
  std::vector<double> start = carry(bare.composition, bare.fit.theta, composition);
  Eigen::Index strength = 0;
  for (std::size_t i = 0; i < start.size() && strength < best->step.size(); ++i) {
    const FreeNumber& number = composition.numbers()[i];
    const EffectUse& use = composition.uses()[number.use];
    if (use.id() == rival && !candidate.frees_prior &&
        !use.effect->about().parameters[number.parameter].auxiliary()) {
      start[i] = number.inside(start[i] + best->step[strength++]);
    }
  }
  return fit_model(composition, study.residuals(), study.executor(), start).objective();
}

/// By how much the nearest rival fits worse than the effect that is there, at its finite size.
double apart_by(Study& study, const Model& model, const std::string& effect,
                const std::vector<std::string>& rivals) {
  const Composition own(model, study.campaign());
  study.residuals().freeze(own, own.start());
  const ModelFit there = fit_model(own, study.residuals(), study.executor(), own.start());
  Model without = model;
  std::erase_if(without.effects, [&](const EffectUse& use) { return use.id() == effect; });
  Composition composition(without, study.campaign());
  ModelFit fit = fit_model(composition, study.residuals(), study.executor(),
                           carry(own, there.theta, composition));
  const Studied bare{without, std::move(composition), std::move(fit), {}};
  double least = bare.fit.objective() - there.objective();
  for (const std::string& rival : rivals) {
    least = std::min(least, objective_of(study, bare, rival) - there.objective());
  }
  return std::max(least, 0.0);
}

struct Prospect {
  std::string text;
  double square = 0.0;
};

/// Of everything that could be changed, and of nothing changed, what separates best. First order
/// chooses what is worth reckoning at the effect's finite size.
class Planning {
 public:
  Planning(Study& study, const Model& model) : study_(study), now_(study.refit(study.fit(model))) {
    today_ = {study.campaign(), source_waves(study, now_)};
  }

  [[nodiscard]] Prospect best(const std::string& effect, const std::vector<std::string>& rivals) {
    constexpr std::size_t kReckoned = 3;
    std::vector<Change> changes = changes_for(study_.campaign());
    std::vector<double> roughly;
    for (const Change& change : changes) {
      roughly.push_back(with_change(change, [&](Study& there) {
        return least_beside(there, standing(there, now_.model), effect, rivals);
      }));
    }
    std::vector<std::size_t> order(changes.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::greater{}, [&](std::size_t i) { return roughly[i]; });
    const auto finite = [&](Study& there) { return apart_by(there, now_.model, effect, rivals); };
    Prospect best{"", with_change({"", [](FutureShots&) {}}, finite)};
    for (std::size_t i = 0; i < std::min(kReckoned, order.size()); ++i) {
      const Change& change = changes[order[i]];
      const double square = with_change(change, finite);
      // What is in hand is not given up for little.
      constexpr double kWorthIt = 1.3;
      if (square > kWorthIt * best.square) {
        best = {change.text, square};
      }
    }
    return best;
  }

 private:
  template <typename Reckon>
  [[nodiscard]] double with_change(const Change& change, const Reckon& reckon) {
    FutureShots future = today_;
    change.make(future);
    foretell(future, now_.model, study_.campaign(), kSeed);
    Study there(future.campaign, 0.0, study_.executor());
    return reckon(there);
  }

  Study& study_;
  Studied now_;
  FutureShots today_;
};

/// What no model of the bench foretells, or would take too long a record to reckon with.
std::string beyond_reckoning(const std::vector<std::string>& ids) {
  const auto about = [&](const char* word) {
    return std::ranges::any_of(
        ids, [&](const std::string& id) { return id.find(word) != std::string::npos; });
  };
  if (about("drift") || about("hum")) {
    return "a pre-trigger of at least 20 ms";
  }
  return about(":") ? "the channels of the gauges concerned swapped for some shots"
                    : "a quieter bench: here no change that can be reckoned with separates them";
}

std::string proposal(const Prospect& best, std::size_t shots, const std::vector<std::string>& ids) {
  const auto now = static_cast<double>(shots);
  const double needed = std::ceil(now * kToldApart / best.square);
  if (!(best.square > 0.0) || needed > kMostShots) {
    return beyond_reckoning(ids);
  }
  if (best.text.empty()) {
    return fmt::format("{:.0f} shots like these", std::max(needed, 2.0 * now));
  }
  return needed > now ? fmt::format("{}, in {:.0f} shots", best.text, needed) : best.text;
}

}  // namespace

std::vector<NextExperiment> next_experiments(Study& study, const Diagnosis& diagnosis) {
  std::vector<NextExperiment> list;
  std::optional<Planning> planning;
  for (const std::string& id : diagnosis.effects) {
    const std::vector<std::string>& ties = diagnosis.tied_with.at(id);
    if (ties.empty()) {
      continue;
    }
    if (!planning) {
      planning.emplace(study, *diagnosis.model);
    }
    std::vector<std::string> all{id};
    all.insert(all.end(), ties.begin(), ties.end());
    const Prospect best = planning->best(id, ties);
    list.push_back(
        {proposal(best, study.campaign().shots.size(), all), all, std::sqrt(best.square)});
  }
  return list;
}

}  // namespace kolsky
