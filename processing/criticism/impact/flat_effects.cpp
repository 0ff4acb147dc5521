#include "processing/criticism/impact/flat_effects.hpp"

#include <algorithm>
#include <optional>

#include "processing/algebra/algebra.hpp"
#include "processing/criticism/search/candidates.hpp"

namespace kolsky {

namespace {

constexpr int kStrengths = 10;

/// Derivatives by the numbers that may still move: what stands at a bound has no way out.
struct Movable {
  Eigen::MatrixXd columns;
  Eigen::MatrixXd information;
};

Movable movable_of(const Studied& studied) {
  std::vector<Eigen::Index> free;
  const std::vector<FreeNumber>& numbers = studied.composition.numbers();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const double value = numbers[i].value_at(studied.fit.theta[i]);
    const double edge = 1e-6 * (numbers[i].upper - numbers[i].lower);
    if (value > numbers[i].lower + edge && value < numbers[i].upper - edge) {
      free.push_back(static_cast<Eigen::Index>(i));
    }
  }
  return {studied.fit.jacobian(Eigen::all, free), studied.fit.information(free, free)};
}

class Strengths {
 public:
  Strengths(ImpactStudy& study, const Studied& studied, const Candidate& candidate)
      : study_(study),
        studied_(studied),
        movable_(movable_of(studied)),
        composition_(with(studied.model, candidate, false), study.campaign()),
        theta_(carry(studied.composition, studied.fit.theta, composition_)) {
    for (std::size_t i = 0; i < composition_.numbers().size(); ++i) {
      if (composition_.uses()[composition_.numbers()[i].use].id() == candidate.id()) {
        own_ = i;
      }
    }
  }

  [[nodiscard]] bool has_one() const { return own_.has_value(); }
  [[nodiscard]] double largest() const { return composition_.numbers()[*own_].upper; }

  /// Of the whitened residuals.
  [[nodiscard]] Eigen::VectorXd change(double strength) {
    std::vector<double> theta = theta_;
    theta[*own_] = composition_.numbers()[*own_].theta_of(strength);
    return study_.residuals().evaluate(composition_, theta, study_.executor().first) -
           studied_.fit.residual;
  }
  /// Their squares clear of what the model's numbers take up.
  [[nodiscard]] double squares(const Eigen::VectorXd& change) const {
    const Eigen::VectorXd pull = movable_.columns.transpose() * change;
    return change.squaredNorm() - pull.dot(least_norm_solution(movable_.information, pull));
  }
  [[nodiscard]] double gain(const Eigen::VectorXd& change) const {
    return -2.0 * studied_.fit.residual.dot(change) - squares(change);
  }

 private:
  ImpactStudy& study_;
  const Studied& studied_;
  Movable movable_;
  Composition composition_;
  std::vector<double> theta_;
  std::optional<std::size_t> own_;
};

std::optional<FlatEffect> tried(ImpactStudy& study, const Studied& studied,
                                const Candidate& candidate, double excluded) {
  Strengths strengths(study, studied, candidate);
  if (!strengths.has_one() ||
      !(strengths.squares(strengths.change(strengths.largest())) > excluded)) {
    return std::nullopt;
  }
  FlatEffect flat{candidate.id(), candidate.use.effect->about().parameters.front().unit};
  for (int k = 1; k <= kStrengths; ++k) {
    const double strength = strengths.largest() * k / kStrengths;
    const double gain = strengths.gain(strengths.change(strength));
    if (gain > flat.gain) {
      flat.gain = gain;
      flat.nearest = strength;
    }
    if (gain > -excluded) {
      flat.not_excluded = strength;
    }
  }
  return flat;
}

}  // namespace

std::vector<FlatEffect> flat_effects(ImpactStudy& study, const Studied& studied,
                                     const std::vector<std::string>& untested, double excluded) {
  std::vector<FlatEffect> list;
  for (const Candidate& candidate : candidates_for(studied, study.campaign())) {
    const bool asked = std::ranges::find(untested, candidate.id()) != untested.end();
    const EffectAbout& about = candidate.use.effect->about();
    if (!asked || candidate.frees_prior || candidate.use.per_shot || about.parameters.size() != 1) {
      continue;
    }
    if (auto flat = tried(study, studied, candidate, excluded)) {
      list.push_back(*std::move(flat));
    }
  }
  return list;
}

}  // namespace kolsky
