#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "processing/criticism/search/refit.hpp"
#include "processing/criticism/search/search_ground.hpp"

namespace kolsky {

/// What refits of one search are worth beside each other, and against what noise alone would do.
class Rating {
 public:
  /// @param ground  outlives this
  /// @param trials  among how many independent candidates the best was sought
  Rating(const SearchGround& ground, double trials) : ground_(ground), trials_(trials) {}

  /// ln of the chance that the best of all candidates does as well on noise.
  [[nodiscard]] double with_search(double log_p) const;
  /// ln of the chance of what was refitted, sought among its own variants only.
  [[nodiscard]] double without_search(const Refit& refit) const;
  [[nodiscard]] double log_trials() const;
  /// Degrees of freedom by which noise is known in an effect's direction: what differs between the
  /// shots tells of it too, unless each shot has a strength of its own.
  [[nodiscard]] double known_of(const EffectUse& use) const;

  /// Rates rivals by one measure of the noise, that of the best: what they leave of each other's
  /// misfit must not count as noise. The best first.
  void rate_in_order(std::vector<Refit>& list) const;
  /// What would be named must gain as much where slow noise counts no more than it tells. Additions
  /// are judged by that noise already.
  void weigh_beside_slow_noise(std::vector<Refit>& list) const;

  /// And as much by what it makes of the pulses: what it makes of the reference gauge's noise gains
  /// by chance.
  void weigh_by_pulses(std::vector<Refit>& list) const;
  /// Nor may what coarse converters leave gain as much.
  void weigh_beside_rounding(std::vector<Refit>& list) const;
  /// ln of the chance of a refit's gain on noise, as it is where coarse converters leave more in
  /// its direction. @param noise  per residual
  [[nodiscard]] double beside_rounding(double log_p, const Refit& refit, double noise) const;

  /// Strengths of single shots that nothing confirms: slow noise, or something slow that the
  /// library lacks. Of several, what explains most stands beside what is rated from then on.
  void note_unconfirmed(const Refit& refit, double gain, double evidence);

 private:
  struct Unconfirmed {
    std::size_t candidate = 0;
    double evidence = 0.0;
    double gain = 0.0;
    double freedom = 0.0;
  };

  void rate(Refit& refit, double noise) const;
  [[nodiscard]] double times_by_rounding(const Refit& refit, double noise) const;
  [[nodiscard]] double chance_of(const Refit& refit, double gain) const;
  [[nodiscard]] double share_beside_unconfirmed(const Refit& refit, double evidence) const;
  [[nodiscard]] bool is_most_of_unconfirmed(const Refit& refit, double evidence) const;
  [[nodiscard]] const Candidate& candidate_of(const Refit& refit) const {
    return ground_.candidates[refit.candidate];
  }

  const SearchGround& ground_;
  double trials_;
  std::optional<Unconfirmed> unconfirmed_;
  mutable std::optional<Eigen::MatrixXd> drawn_;  ///< what coarse converters leave, if asked for
};

/// Gain of the objective over the noise that a refit leaves.
[[nodiscard]] double gain_over_own_noise(const Refit& refit, const SearchGround& ground);

}  // namespace kolsky
