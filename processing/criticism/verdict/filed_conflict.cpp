#include "processing/criticism/verdict/filed_conflict.hpp"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "processing/criticism/fitting/statistics.hpp"

namespace kolsky {

FiledConflict conflict_with_filed(const Studied& studied) {
  const ModelFit& fit = studied.fit;
  const std::vector<FreeNumber>& numbers = studied.composition.numbers();
  FiledConflict conflict;
  std::vector<Eigen::Index> filed;
  std::vector<double> away;  // in scales
  for (std::size_t i = 0; i < fit.theta.size(); ++i) {
    const FreeNumber& own = numbers[i];
    const Effect& effect = *studied.composition.uses()[own.use].effect;
    if (!effect.about().base || !(own.prior_sd > 0.0)) {
      continue;
    }
    filed.push_back(static_cast<Eigen::Index>(i));
    away.push_back(fit.theta[i] - own.theta_of(own.prior_mean));
    const double deviations = (own.value_at(fit.theta[i]) - own.prior_mean) / own.prior_sd;
    if (std::abs(deviations) >= std::abs(conflict.deviations)) {
      conflict.deviations = deviations;
      conflict.furthest = effect.about().id + " " + effect.about().parameters[own.parameter].name;
    }
  }
  if (filed.empty()) {
    return conflict;
  }
  const Eigen::MatrixXd precision = studied.composition.prior_precision()(filed, filed);
  const Eigen::VectorXd off =
      Eigen::Map<const Eigen::VectorXd>(away.data(), static_cast<Eigen::Index>(away.size()));
  conflict.log_p = log_chi2_tail(off.dot(precision * off), static_cast<double>(filed.size()));
  return conflict;
}

std::string filed_text(const FiledConflict& conflict) {
  return fmt::format(
      "{} would be {:+.1f} of its filed deviations off (by chance {:.1g}): it is not as filed, or "
      "took up what the model lacks; measure it again, or file how well it is known",
      conflict.furthest, conflict.deviations, std::exp(conflict.log_p));
}

std::string filed_note(const FiledConflict& conflict, bool claims) {
  return fmt::format(
      "{}the records contradict what is filed of the materials (by chance {:.1g}): {} would be "
      "{:+.1f} of its filed deviations off; either that is filed wrongly, or something is missing "
      "that {}, and the materials took it up",
      claims ? "with what came nearest in the model " : "", std::exp(conflict.log_p),
      conflict.furthest, conflict.deviations,
      claims ? "it is not" : "nothing tested here explains");
}

}  // namespace kolsky
