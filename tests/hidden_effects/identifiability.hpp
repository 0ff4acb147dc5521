#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "tests/hidden_effects/prober.hpp"

namespace kolsky::scoring {

/// How well a bench could tell effects, computed from the generator alone.
struct Identifiable {
  Candidate candidate;
  double detect = 0.0;       ///< strength (from null) at which it stands at 6 sigma
  double smallest = 0.0;     ///< also 5 sigma after projecting out each rival
  std::string closest;       ///< the rival that decides
  double rival_share = 0.0;  ///< of the 6 sigma, what is left after the closest rival

  /// Whether the effect is there or not, at one strength, rather than more or less.
  [[nodiscard]] bool all_or_nothing() const;
  [[nodiscard]] bool possible() const;
  /// Rivals cannot be told from it at any reasonable size.
  [[nodiscard]] bool seen_but_tied() const;
};

/// Every library effect (and the withheld ones, which are no rivals) on this campaign's bench and
/// shots: whitened, with sources, offsets, moduli and known unknowns projected out.
class Identifiability {
 public:
  explicit Identifiability(const testing::Campaign& campaign);

  [[nodiscard]] const std::vector<Identifiable>& effects() const { return effects_; }
  /// Strength at which a withheld effect still stands at `sigmas` after the best two of the
  /// library.
  [[nodiscard]] double withheld_size(const Identifiable& effect, double sigmas) const;

 private:
  struct Bench;
  void judge();

  std::vector<Candidate> candidates_;
  std::vector<Identifiable> effects_;
  Eigen::MatrixXd products_;  // of the candidates, nuisances taken out
};

}  // namespace kolsky::scoring
