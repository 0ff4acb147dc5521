#include "processing/criticism/search/amplitude_over_shots.hpp"

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "processing/algebra/algebra.hpp"

namespace kolsky {

namespace {

/// Where a fit has an oscillation's parts: by shot, cosine and sine of each gauge in turn.
std::vector<std::vector<Eigen::Index>> places_by_shot(const Studied& studied,
                                                      const std::string& id) {
  // In the order of the composition: by parameter, then shot, then gauge.
  std::array<std::vector<Eigen::Index>, 2> places;
  std::ptrdiff_t last_shot = 0;
  for (std::size_t i = 0; i < studied.fit.theta.size(); ++i) {
    const FreeNumber& number = studied.composition.numbers()[i];
    if (number.parameter < 2 && studied.composition.uses()[number.use].id() == id) {
      places[number.parameter].push_back(static_cast<Eigen::Index>(i));
      last_shot = number.shot;
    }
  }
  if (places[0].empty() || places[0].size() != places[1].size() || last_shot < 0) {
    return {};
  }
  const auto shots = static_cast<std::size_t>(last_shot + 1);
  const std::size_t gauges = places[0].size() / shots;
  std::vector<std::vector<Eigen::Index>> list(shots);
  for (std::size_t place = 0; place < shots * gauges; ++place) {
    list[place / gauges].push_back(places[0][place]);
    list[place / gauges].push_back(places[1][place]);
  }
  return list;
}

/// Mean square one.
Eigen::VectorXd shares_of(const Studied& studied,
                          const std::vector<std::vector<Eigen::Index>>& shots) {
  const auto gauges = static_cast<Eigen::Index>(shots.front().size() / 2);
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(gauges, gauges);
  for (const auto& shot : shots) {
    for (std::size_t part = 0; part < 2; ++part) {
      Eigen::VectorXd own(gauges);
      for (Eigen::Index j = 0; j < gauges; ++j) {
        own[j] = studied.fit
                     .theta[static_cast<std::size_t>(shot[2 * static_cast<std::size_t>(j) + part])];
      }
      square += own * own.transpose();
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(square);
  return std::sqrt(static_cast<double>(gauges)) * solver.eigenvectors().col(gauges - 1);
}

/// What one shot says of parts that every gauge holds in its share, the prior's share of what is
/// known of them taken off: it is one about nothing, so that it pulls at nothing.
QuadratureParts parts_of(const Studied& studied, const std::vector<Eigen::Index>& at,
                         const Eigen::VectorXd& shares) {
  Eigen::MatrixXd in_shares(static_cast<Eigen::Index>(at.size()), 2);
  Eigen::VectorXd found(in_shares.rows());
  for (Eigen::Index i = 0; i < in_shares.rows(); ++i) {
    in_shares.row(i) = shares[i / 2] * Eigen::RowVector2d::Unit(i % 2);
    found[i] = studied.fit.theta[static_cast<std::size_t>(at[static_cast<std::size_t>(i)])];
  }
  const Eigen::MatrixXd covariance = studied.fit.covariance(at, at);
  Eigen::MatrixXd information = inverse_of(covariance);
  QuadratureParts parts;
  parts.pull = in_shares.transpose() * information * found;
  const FreeNumber& number = studied.composition.numbers()[static_cast<std::size_t>(at.front())];
  if (number.prior_sd > 0.0) {
    information.diagonal().array() -=
        number.scale * number.scale / (number.prior_sd * number.prior_sd);
  }
  parts.information = in_shares.transpose() * information * in_shares;
  return parts;
}

}  // namespace

Amplitude amplitude_over_shots(const Studied& studied, const std::string& id) {
  const std::vector<std::vector<Eigen::Index>> shots = places_by_shot(studied, id);
  if (shots.empty()) {
    return {};
  }
  const auto gauges = static_cast<Eigen::Index>(shots.front().size() / 2);
  std::vector<Eigen::VectorXd> tried{Eigen::VectorXd::Ones(gauges)};
  if (gauges > 1) {
    tried.push_back(shares_of(studied, shots));
  }
  Amplitude best;
  for (const Eigen::VectorXd& shares : tried) {
    std::vector<QuadratureParts> parts;
    for (const auto& shot : shots) {
      parts.push_back(parts_of(studied, shot, shares));
    }
    const Amplitude own = common_amplitude(parts);
    if (own.sd > 0.0 && own.value * best.sd >= best.value * own.sd) {
      best = own;
    }
  }
  const double scale =
      studied.composition.numbers()[static_cast<std::size_t>(shots.front().front())].scale;
  return {scale * best.value, scale * best.sd};
}

}  // namespace kolsky
