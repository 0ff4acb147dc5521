#include "processing/criticism/verdict/distinction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "processing/algebra/algebra.hpp"
#include "processing/criticism/search/candidate_table.hpp"

namespace kolsky {

namespace {

constexpr double kToldApart = 5.0;  ///< sigma beside a rival
/// Less of a direction than this is rounding.
constexpr double kNothing = 1e-6;

/// (information)^-1/2 over the part that is there at all.
Eigen::MatrixXd whitener_of(const Direction& direction) {
  const SymmetricEigen solver(direction.information);
  const double least = kNothing * direction.unprojected.diagonal().maxCoeff();
  Eigen::VectorXd scale = solver.eigenvalues();
  for (Eigen::Index i = 0; i < scale.size(); ++i) {
    scale[i] = scale[i] > least && scale[i] > 0.0 ? 1.0 / std::sqrt(scale[i]) : 0.0;
  }
  return solver.eigenvectors() * scale.asDiagonal();
}

/// The largest cosine between a strength's direction of one effect and any of the other's.
double cosine(const Direction& a, const Direction& b, const Eigen::MatrixXd& covariance) {
  const Eigen::MatrixXd shared =
      a.columns.transpose() * b.columns - a.model_share.transpose() * covariance * b.model_share;
  const Eigen::MatrixXd own = whitener_of(a).transpose() * shared * whitener_of(b);
  return std::min(1.0, singular_values(own).values[0]);
}

bool there(const Direction& direction) {
  return direction.information.rows() > 0 && direction.freedom > 0.0 &&
         direction.columns.squaredNorm() > 0.0;
}

}  // namespace

std::vector<Distinction> distinctions(Study& study, const Studied& studied,
                                      const std::vector<std::string>& ids) {
  std::vector<Candidate> candidates = candidates_for(studied, study.campaign());
  std::erase_if(candidates, [](const Candidate& own) { return own.use.per_shot; });
  std::vector<Direction> directions(candidates.size());
  study.executor().run(candidates.size(), [&](std::size_t i, std::size_t worker) {
    directions[i] = direction_of(candidates[i], studied, study, worker);
  });
  std::map<std::string, std::size_t> best;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const std::string& name = candidates[i].use.effect->about().id;
    if (std::find(ids.begin(), ids.end(), name) == ids.end()) {
      continue;
    }
    const auto [at, fresh] = best.emplace(candidates[i].id(), i);
    if (!fresh && there(directions[i]) &&
        (!there(directions[at->second]) ||
         directions[i].information(0, 0) > directions[at->second].information(0, 0))) {
      at->second = i;
    }
  }
  std::vector<Distinction> list;
  for (const auto& [id, i] : best) {
    const Direction& own = directions[i];
    const EffectParameter& parameter = candidates[i].use.effect->about().parameters.front();
    const double scale = scale_of(candidates[i].use.values.front(), parameter);
    Distinction distinction{id, parameter.name, parameter.unit, 1.0, 0.0, 0.0, {}};
    distinction.detectable = distinction.identifiable = std::numeric_limits<double>::infinity();
    if (there(own)) {
      distinction.absorbed_share = 1.0 - own.information(0, 0) / own.unprojected(0, 0);
      const double sd = 1.0 / std::sqrt(own.information(0, 0));
      distinction.detectable = scale * root(kDetected * sd, parameter.power);
      std::map<std::string, double> nearest;
      for (std::size_t k = 0; k < candidates.size(); ++k) {
        if (candidates[k].id() != id && there(directions[k])) {
          double& known = nearest[candidates[k].id()];
          known = std::max(known, cosine(own, directions[k], studied.fit.covariance));
        }
      }
      for (const auto& [rival, value] : nearest) {
        distinction.rivals.push_back({rival, value});
      }
      std::stable_sort(distinction.rivals.begin(), distinction.rivals.end(),
                       [](const auto& a, const auto& b) { return a.cosine > b.cosine; });
      const double closest = distinction.rivals.empty() ? 0.0 : distinction.rivals.front().cosine;
      distinction.identifiable = std::max(
          distinction.detectable,
          scale * root(kToldApart * sd / std::sqrt(std::max(1e-12, 1.0 - closest * closest)),
                       parameter.power));
      distinction.detectable = within_reach(candidates[i], distinction.detectable);
      distinction.identifiable = within_reach(candidates[i], distinction.identifiable);
    }
    list.push_back(std::move(distinction));
  }
  return list;
}

}  // namespace kolsky
