#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "processing/criticism/impact/impact_notes.hpp"

#include "processing/algebra/algebra.hpp"
#include "processing/impact/impact.hpp"

namespace kolsky {

namespace {

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
    const SymmetricEigen solver(columns.transpose() * columns);
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

}  // namespace

std::vector<std::string> not_constrained(ImpactStudy& study, const Studied& studied) {
  std::vector<std::string> lines = what_records_hold(study, studied);
  const double strained = study.residuals().strained_share();
  if (strained > impact::kStrainedShareToTell) {
    lines.insert(lines.begin(),
                 "at the highest speed " + impact::strained_words(strained, "the core"));
  }
  return lines;
}

}  // namespace kolsky
