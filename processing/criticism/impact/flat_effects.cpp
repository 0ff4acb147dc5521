#include "processing/criticism/impact/flat_effects.hpp"

#include <algorithm>
#include <cmath>

#include "processing/algebra/algebra.hpp"

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
  Strengths(ImpactStudy& study, const Studied& studied, const Candidate& candidate,
            std::size_t worker)
      : study_(study),
        studied_(studied),
        worker_(worker),
        movable_(movable_of(studied)),
        composition_(with(studied.model, candidate, Auxiliaries::held), study.campaign()),
        theta_(carry(studied.composition, studied.fit.theta, composition_)) {
    for (std::size_t i = 0; i < composition_.numbers().size(); ++i) {
      if (composition_.uses()[composition_.numbers()[i].use].id() == candidate.id()) {
        own_ = i;
      }
    }
  }

  [[nodiscard]] bool has_one() const { return own_.has_value(); }
  [[nodiscard]] double largest() const { return composition_.numbers()[*own_].upper; }
  /// From none, in the scale that a fit moves it in.
  [[nodiscard]] double step(double strength) const {
    return composition_.numbers()[*own_].theta_of(strength) - theta_[*own_];
  }

  /// Of the whitened residuals.
  [[nodiscard]] Eigen::VectorXd change(double strength) {
    std::vector<double> theta = theta_;
    theta[*own_] = composition_.numbers()[*own_].theta_of(strength);
    return study_.residuals().evaluate(composition_, theta, worker_) - studied_.fit.residual;
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
  std::size_t worker_;
  Movable movable_;
  Composition composition_;
  std::vector<double> theta_;
  std::optional<std::size_t> own_;
};

/// The line from none to a change.
Direction secant_of(const Studied& studied, const Eigen::VectorXd& change, double squares,
                    double step, double gain) {
  Direction direction;
  direction.columns = change / step;
  direction.model_share = studied.fit.jacobian.transpose() * direction.columns;
  direction.information = Eigen::MatrixXd::Constant(1, 1, squares / (step * step));
  direction.unprojected = direction.columns.transpose() * direction.columns;
  direction.pull = -direction.columns.transpose() * studied.fit.residual;
  direction.step = Eigen::VectorXd::Constant(1, gain > 0.0 ? step : 0.0);
  direction.gain = gain;
  direction.freedom = 1.0;
  return direction;
}

}  // namespace

double FlatEffect::nearest() const {
  return strengths[static_cast<std::size_t>(std::ranges::max_element(gains) - gains.begin())];
}

double FlatEffect::gain() const {
  return std::ranges::max(gains);
}

double FlatEffect::not_excluded(double excluded) const {
  double largest = 0.0;
  for (std::size_t k = 0; k < gains.size(); ++k) {
    largest = gains[k] > -excluded ? strengths[k] : largest;
  }
  return largest;
}

double FlatEffect::showing(double squares_wanted) const {
  std::size_t k = squares.size();
  while (k > 0 && squares[k - 1] > squares_wanted) {
    --k;
  }
  if (k == 0 || k == squares.size()) {
    return k == 0 ? 0.0 : INFINITY;
  }
  const double share = (squares_wanted - squares[k - 1]) / (squares[k] - squares[k - 1]);
  return strengths[k - 1] + share * (strengths[k] - strengths[k - 1]);
}

std::optional<FlatEffect> flat_effect(ImpactStudy& study, const Studied& studied,
                                      const Candidate& candidate, double shows,
                                      std::size_t worker) {
  const EffectAbout& about = candidate.use.effect->about();
  if (candidate.frees_prior || candidate.use.per_shot || about.parameters.size() != 1) {
    return std::nullopt;
  }
  Strengths strengths(study, studied, candidate, worker);
  if (!strengths.has_one()) {
    return std::nullopt;
  }
  Eigen::VectorXd change = strengths.change(strengths.largest());
  if (!(strengths.squares(change) > shows)) {
    return std::nullopt;
  }
  FlatEffect flat;
  flat.id = candidate.id();
  flat.unit = about.parameters.front().unit;
  bool shown = false;
  for (int k = 1; k <= kStrengths; ++k) {
    const double strength = strengths.largest() * k / kStrengths;
    change = strengths.change(strength);
    const double squares = strengths.squares(change);
    if (!std::isfinite(squares)) {
      break;  // the solver refuses
    }
    const double gain = strengths.gain(change);
    if (gain > flat.gain() || (!shown && !(flat.gain() > 0.0) && squares > shows)) {
      shown = true;
      flat.secant =
          secant_of(studied, change, squares, strengths.step(strength), std::max(0.0, gain));
    }
    flat.strengths.push_back(strength);
    flat.squares.push_back(squares);
    flat.gains.push_back(gain);
  }
  return flat;
}

void set_limits(const std::vector<FlatEffect>& flat, double scale,
                std::vector<CandidateResult>& table) {
  for (const FlatEffect& own : flat) {
    const auto row = std::ranges::find(table, own.id, &CandidateResult::effect);
    if (row == table.end()) {
      continue;
    }
    const double beside = row->identifiable / row->detectable;
    const double detected = kDetected * kDetected * scale;
    row->detectable = own.showing(detected);
    row->identifiable = own.showing(detected * beside * beside);
  }
}

}  // namespace kolsky
