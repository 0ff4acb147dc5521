#include "processing/criticism/verdict/cancelling.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace kolsky {

namespace {

/// How far an effect's strengths are from where it does nothing, by number of the fit.
struct Strengths {
  std::string id;
  std::vector<Eigen::Index> numbers;
  std::vector<double> from_null;
};

Strengths strengths_of(const Studied& studied, std::size_t use) {
  const Composition& composition = studied.composition;
  const EffectUse& own = composition.uses()[use];
  const std::size_t strength = own.effect->about().strength;
  const double null_value = own.effect->about().parameters[strength].null_value;
  Strengths out{own.id(), {}, {}};
  for (const std::size_t i : composition.numbers_of(use)) {
    const FreeNumber& number = composition.numbers()[i];
    if (number.parameter == strength) {
      out.numbers.push_back(static_cast<Eigen::Index>(i));
      out.from_null.push_back(studied.fit.theta[i] - number.theta_of(null_value));
    }
  }
  return out;
}

double left_of_lesser(const Studied& studied, const Strengths& one, const Strengths& other) {
  std::vector<Eigen::Index> numbers = one.numbers;
  numbers.insert(numbers.end(), other.numbers.begin(), other.numbers.end());
  const Eigen::MatrixXd information = studied.fit.covariance(numbers, numbers).inverse();
  const auto size = static_cast<Eigen::Index>(numbers.size());
  const auto ones = static_cast<Eigen::Index>(one.numbers.size());
  Eigen::VectorXd of_one = Eigen::VectorXd::Zero(size);
  Eigen::VectorXd of_other = Eigen::VectorXd::Zero(size);
  std::copy(one.from_null.begin(), one.from_null.end(), of_one.begin());
  std::copy(other.from_null.begin(), other.from_null.end(), of_other.begin() + ones);
  const auto square = [&](const Eigen::VectorXd& v) { return v.dot(information * v); };
  const double lesser = std::min(square(of_one), square(of_other));
  return lesser > 0.0 ? std::sqrt(square(of_one + of_other) / lesser) : 1.0;
}

}  // namespace

std::optional<Cancelling> most_cancelling(const Studied& studied,
                                          const std::vector<std::string>& effects) {
  std::vector<Strengths> claimed;
  for (std::size_t u = 0; u < studied.composition.uses().size(); ++u) {
    if (std::ranges::count(effects, studied.composition.uses()[u].id()) > 0) {
      claimed.push_back(strengths_of(studied, u));
    }
  }
  std::optional<Cancelling> most;
  for (std::size_t i = 0; i < claimed.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double left = left_of_lesser(studied, claimed[i], claimed[j]);
      if (!claimed[i].numbers.empty() && !claimed[j].numbers.empty() &&
          (!most || left < most->left)) {
        most = Cancelling{claimed[j].id, claimed[i].id, left};
      }
    }
  }
  return most;
}

}  // namespace kolsky
