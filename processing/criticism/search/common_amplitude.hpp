#pragma once

#include <Eigen/Core>
#include <vector>

namespace kolsky {

/// What the records of one shot say of an oscillation's cosine and sine parts, without a prior: the
/// likelihood is exp(pull . parts - parts . information parts / 2).
struct QuadratureParts {
  Eigen::Vector2d pull = Eigen::Vector2d::Zero();
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
};

struct Amplitude {
  double value = 0.0;
  double sd = 0.0;
};

/// The amplitude that is likeliest to be that of all shots, each of a phase of its own that may be
/// any. Records shorter than a period show one part of two: a mean of the shots' own amplitudes
/// would be small by what they do not show.
[[nodiscard]] Amplitude common_amplitude(const std::vector<QuadratureParts>& shots);

/// Of shots whose parts are those of one amplitude, whatever each shot's phase: ln of the
/// likelihood over that without any, the amplitude at its best and the phases integrated over.
[[nodiscard]] double log_likelihood_of_common_amplitude(const std::vector<QuadratureParts>& shots);

/// The same of shots whose strengths are drawn around none with one deviation, that at its best.
/// @param pull, information  of each shot's strength
[[nodiscard]] double log_likelihood_of_drawn_strengths(const Eigen::VectorXd& pull,
                                                       const Eigen::VectorXd& information);

}  // namespace kolsky
