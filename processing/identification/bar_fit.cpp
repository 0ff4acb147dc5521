#include "processing/identification/bar_fit.hpp"

#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "processing/base/error.hpp"
#include "processing/identification/bar_likelihood.hpp"

namespace kolsky {

namespace {

/// What Ceres minimises: the likelihood's residuals and, for each known unknown, its move itself
/// (its prior). Parameters: logarithms of the solid's, then the moves in their standard deviations.
struct Objective {
  BarLikelihood* likelihood;
  SolidKind solid;
  std::size_t solid_parameters;
  std::size_t moves;

  bool operator()(double const* const* blocks, double* residuals) const {
    const double* p = blocks[0];
    std::vector<double> parameters(solid_parameters);
    std::transform(p, p + solid_parameters, parameters.begin(),
                   [](double log) { return std::exp(log); });
    const auto compliance = make_solid(solid, parameters);
    const std::span<const double> moved(p + solid_parameters, moves);
    likelihood->evaluate(*compliance, moved, {residuals, likelihood->residuals()});
    std::copy(moved.begin(), moved.end(), residuals + likelihood->residuals());
    return true;
  }
};

/// Minimum, and the residuals' derivatives there.
struct Minimum {
  std::vector<double> parameters;
  double chi2 = 0.0;
  Eigen::MatrixXd jacobian;
};

Eigen::MatrixXd dense(const ceres::CRSMatrix& sparse) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(sparse.num_rows, sparse.num_cols);
  for (int row = 0; row < sparse.num_rows; ++row) {
    for (int i = sparse.rows[static_cast<std::size_t>(row)];
         i < sparse.rows[static_cast<std::size_t>(row) + 1]; ++i) {
      matrix(row, sparse.cols[static_cast<std::size_t>(i)]) =
          sparse.values[static_cast<std::size_t>(i)];
    }
  }
  return matrix;
}

Minimum minimise(const Objective& objective, std::vector<double> start) {
  using Cost = ceres::DynamicNumericDiffCostFunction<Objective, ceres::CENTRAL>;
  ceres::NumericDiffOptions steps;
  steps.relative_step_size = 1e-6;
  auto cost = std::make_unique<Cost>(new Objective(objective), ceres::TAKE_OWNERSHIP, steps);
  cost->AddParameterBlock(static_cast<int>(start.size()));
  cost->SetNumResiduals(static_cast<int>(objective.likelihood->residuals() + objective.moves));
  ceres::Problem problem;
  problem.AddResidualBlock(cost.release(), nullptr, start.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 50;
  options.function_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (summary.termination_type != ceres::CONVERGENCE) {
    throw InputError("fit", "does not converge: " + summary.message,
                     "try another family of solids or a narrower band");
  }
  Minimum minimum;
  minimum.chi2 = 2.0 * summary.final_cost;
  ceres::CRSMatrix jacobian;
  problem.Evaluate({}, nullptr, nullptr, nullptr, &jacobian);
  minimum.jacobian = dense(jacobian);
  minimum.parameters = std::move(start);
  return minimum;
}

}  // namespace

BarFit fit_bar(const std::vector<Shot>& shots, const BarFitOptions& options) {
  if (shots.empty()) {
    throw InputError("captures", "are none", "give at least one shot on the bar");
  }
  BarLikelihood likelihood(shots, options.theory, options.band_limit_Hz);
  const auto& family = parameters_of(options.solid);
  const auto& unknowns = likelihood.unknowns();
  std::vector<double> start;
  for (const SolidParameter& parameter : family) {
    start.push_back(std::log(parameter.start));
  }
  start.resize(family.size() + unknowns.size(), 0.0);
  const Minimum minimum =
      minimise({&likelihood, options.solid, family.size(), unknowns.size()}, std::move(start));

  BarFit fit;
  fit.solid = options.solid;
  fit.theory = options.theory;
  fit.band_limit_Hz = likelihood.band_limit_Hz();
  fit.degrees_of_freedom = likelihood.residuals() - family.size();
  fit.chi2_reduced = minimum.chi2 / static_cast<double>(fit.degrees_of_freedom);
  fit.log_evidence =
      -0.5 * (minimum.chi2 + static_cast<double>(family.size()) *
                                 std::log(static_cast<double>(likelihood.residuals())));
  const Eigen::MatrixXd inverse =
      (minimum.jacobian.transpose() * minimum.jacobian).inverse() * std::max(1.0, fit.chi2_reduced);
  fit.covariance.assign(family.size(), std::vector<double>(family.size()));
  for (std::size_t i = 0; i < family.size(); ++i) {
    const double value = std::exp(minimum.parameters[i]);
    for (std::size_t j = 0; j < family.size(); ++j) {
      fit.covariance[i][j] = inverse(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) *
                             value * std::exp(minimum.parameters[j]);
    }
    fit.parameters.push_back({family[i].name, value, std::sqrt(fit.covariance[i][i])});
  }
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(family.size() + i);
    fit.bench.push_back({unknowns[i].name, minimum.parameters[family.size() + i] * unknowns[i].sd,
                         std::sqrt(inverse(at, at)) * unknowns[i].sd});
  }
  return fit;
}

}  // namespace kolsky
