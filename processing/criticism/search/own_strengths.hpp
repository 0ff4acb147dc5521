#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/criticism/fitting/study.hpp"
#include "processing/criticism/search/product_test.hpp"

namespace kolsky {

/// Whether a claim is made, is made of what slow noise is known not to do, or was made before and
/// is looked at again.
enum class Claim { fresh, beyond_slow_noise, standing };

/// Whether strengths that every shot has of its own are more than slow noise that they followed. No
/// other shot can confirm them, so something else has to:
///   a drift must show in the samples before the pulse, too, with the same slopes;
///   a hum has one phase in a shot, whatever the gauge: its amplitudes by shot and gauge are
///   products of a complex number per shot and a real one per gauge, nearer than noise comes to it
///   (of few gauges that says little by itself, and less is asked for where slow noise does not
///   gain as much) and than one noisy gauge explains; one that is alike at all gauges must show
///   before the pulse, too, as a drift must.
/// True for effects without strengths of their own.
[[nodiscard]] bool own_strengths_confirmed(const Studied& studied, const std::string& id,
                                           const Campaign& campaign, Claim claim);

/// Whether slow noise does so much so rarely that its chance confirms strengths of each shot's own
/// instead (`SlowNoise`).
[[nodiscard]] bool slow_noise_excluded(double log_chance, Claim claim);

/// Strengths that every shot has of its own: by parameter, then shot, then gauge, as a composition
/// has them.
struct OwnStrengths {
  std::vector<Eigen::Index> places;  ///< among a fit's numbers
  Eigen::VectorXd found;             ///< in scales
  Eigen::MatrixXd information;       ///< inverse of their covariance, priors included
};
[[nodiscard]] OwnStrengths own_strengths_in(const Studied& studied, const std::string& id);

/// How near a hum's amplitudes by shot and gauge are to products. @return nothing for other effects
[[nodiscard]] std::optional<ProductTest> product_test_of(const Studied& studied,
                                                         const std::string& id,
                                                         const Campaign& campaign);

}  // namespace kolsky
