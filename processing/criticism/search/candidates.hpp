#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/fitting/study.hpp"

namespace kolsky {

/// One way to add one effect to a model: with its auxiliary parameters at one of their starts, for
/// all shots or each shot by itself. Or a filed number set free of its prior.
struct Candidate {
  EffectUse use;              ///< at null, auxiliaries set
  bool frees_prior = false;   ///< the model holds it already as a known unknown
  Signs signs = Signs::both;  ///< of its strength

  [[nodiscard]] std::string id() const { return use.id(); }
};

/// Every effect of the library that this campaign could show, in every variant, less those that the
/// model holds.
[[nodiscard]] std::vector<Candidate> candidates_for(const Studied& studied,
                                                    const Campaign& campaign);

/// What first-order theory says of a candidate beside the model: the residuals' derivatives by its
/// strengths, clear of whatever the model's own numbers could take up.
struct Direction {
  Eigen::MatrixXd columns;      ///< whitened residuals by strengths, in scales
  Eigen::MatrixXd model_share;  ///< J^T columns
  Eigen::MatrixXd information;  ///< after projection
  Eigen::MatrixXd unprojected;  ///< columns^T columns
  Eigen::VectorXd pull;         ///< -columns^T residual
  Eigen::VectorXd step;         ///< best strengths, in scales
  double gain = 0.0;            ///< of the objective
  double freedom = 1.0;
};

/// What a candidate's gain counts over where squares of deviates of what is calculated count over
/// `scale`. A filed number's distance from where the records have it is as uncertain as it was
/// filed, of which no error of a calculation makes more: only the records' own share is in doubt.
[[nodiscard]] double doubt_of_gain(const Candidate& candidate, const Direction& direction,
                                   double scale);

/// Whether a fit may move a candidate's auxiliary numbers or they stay where its variant has them.
enum class Auxiliaries { held, free };

/// The model with a candidate added (or its prior dropped).
[[nodiscard]] Model with(const Model& model, const Candidate& candidate, Auxiliaries auxiliaries);

/// Numbers of one composition carried into another: by effect, parameter and place; what is new
/// keeps its start.
[[nodiscard]] std::vector<double> carry(const Composition& from, const std::vector<double>& theta,
                                        const Composition& to);

/// Where one composition has what is a number of another.
/// @param taken  by number of `from`: what stands for others already
[[nodiscard]] std::optional<std::size_t> place_in(const Composition& from, const Composition& to,
                                                  std::size_t number,
                                                  const std::vector<bool>& taken);

[[nodiscard]] Direction direction_of(const Candidate& candidate, const Studied& studied,
                                     const Campaign& campaign, ShotResiduals& residuals,
                                     std::size_t worker);
[[nodiscard]] inline Direction direction_of(const Candidate& candidate, const Studied& studied,
                                            Study& study, std::size_t worker = 0) {
  return direction_of(candidate, studied, study.campaign(), study.residuals(), worker);
}

}  // namespace kolsky
