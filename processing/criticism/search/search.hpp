#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "processing/criticism/search/candidates.hpp"
#include "processing/criticism/search/product_test.hpp"
#include "processing/criticism/search/safeguards.hpp"
#include "processing/criticism/search/slow_noise.hpp"

namespace kolsky {

/// Degrees of freedom from which on noise counts as known exactly: Student's t is normal there.
inline constexpr double kKnownWell = 1e4;

/// ln of the chance that slow noise does as much as an addition of each shot's own.
struct SlowChance {
  double alone = 0.0;
  double with_others = 0.0;  ///< where the same at other gauges is there, too

  [[nodiscard]] double least() const { return std::min(alone, with_others); }
};

/// A candidate refitted in full beside the model.
struct Refit {
  std::size_t candidate = 0;
  Studied studied;
  double freedom = 1.0;
  bool one_sided = false;
  double chi2_in_base_noise = 0.0;  ///< its residuals whitened as those without the candidate
  double scatter = 1.0;             ///< how much more than noise the shots differ in its direction
  /// That strengths which every shot and gauge has of its own are products all the same.
  std::optional<ProductTest> products = std::nullopt;
  /// Where that is what confirms them.
  std::optional<SlowChance> slow = std::nullopt;
  double noise = 1.0;       ///< what the objective has of it per residual: of all refits the best's
  double over_noise = 0.0;  ///< gain of the objective, over the noise
  double beside = 1.0;      ///< share of it beside something slow that nothing confirms
  double gain = 0.0;        ///< the same over the shots' scatter, too
  double evidence = 0.0;    ///< as a square of a normal deviate, the search not counted
  double doubt = 1.0;       ///< the scatter, where the evidence is that over the noise alone
  double known = kKnownWell;  ///< degrees of freedom by which the noise is known that weighs it
  double log_p = 0.0;
  /// ln of the chance of a rival's gain: by how much its shots scatter it is no less of one.
  double rival_log_p = 0.0;
  /// With derivatives of the model without the candidate: cheap, and near enough for what is far
  /// behind.
  bool rough = false;
};

/// By how much one refit stands before another, as a square of a normal deviate. Noise that is
/// greater in the direction of either than its spectrum says makes the difference weigh less, and
/// so does noise that is known roughly.
[[nodiscard]] double lead(const Refit& ahead, const Refit& behind);

/// One search for what a fitted model lacks: every candidate tested at first order, those near the
/// best refitted in full.
class Search {
 public:
  /// @param base   the model as fitted; outlives this
  /// @param start  the same before anything was fitted
  Search(Study& study, const Studied& base, const Model& start, const Safeguards& safeguards = {});

  [[nodiscard]] const std::vector<Candidate>& candidates() const { return candidates_; }
  /// Of the candidates, one each.
  [[nodiscard]] const std::vector<Direction>& directions() const { return directions_; }

  /// ln of the chance that the best of all candidates does as well on noise.
  [[nodiscard]] double with_search(double log_p) const;

  [[nodiscard]] double log_trials() const;
  /// ln of the chance of what was refitted, sought among its own variants only.
  [[nodiscard]] double without_search(const Refit& refit) const;
  /// By candidate: degrees of freedom by which noise is known in its direction.
  [[nodiscard]] std::vector<double> known() const;

  /// The candidates worth it, refitted; the best first.
  [[nodiscard]] std::vector<Refit> refits();

  /// What was refitted and is no explanation.
  struct Dismissed {
    std::string verdict;  ///< "unconfirmed" or "rejected"
    double gain = 0.0;    ///< over the noise; first order may have promised far more
    double chance = 0.0;  ///< ln of that of its gain on noise, the search not counted
  };
  [[nodiscard]] const std::map<std::string, Dismissed>& dismissed() const { return dismissed_; }

 private:
  [[nodiscard]] bool far_off() const;
  [[nodiscard]] bool begins_afresh(const Candidate& candidate) const;
  [[nodiscard]] ModelFit begun_from(const Composition& composition, std::vector<double> theta,
                                    const Eigen::MatrixXd* chord, std::size_t worker) const;
  void from_large_sizes(std::size_t index, const Composition& composition, std::size_t worker,
                        ModelFit& fit);
  void from_other_starts(std::size_t index, const Composition& composition, std::size_t worker,
                         ModelFit& fit);
  [[nodiscard]] bool beyond_the_record(const Studied& studied, const Refit& refit) const;
  [[nodiscard]] double evidence_of(const Direction& direction, const Candidate& candidate) const;
  [[nodiscard]] std::vector<std::size_t> worth_refitting();
  void add_beyond_slow_noise(std::vector<std::size_t>& chosen);
  void add_relatives(const std::vector<std::pair<double, std::size_t>>& ranked,
                     std::vector<std::size_t>& chosen) const;
  [[nodiscard]] std::vector<double> begin_near(const Candidate& candidate,
                                               const Direction& direction,
                                               const Composition& composition,
                                               std::size_t worker) const;
  [[nodiscard]] static std::vector<std::vector<double>> large_sizes(
      const Candidate& candidate, const Composition& composition, const std::vector<double>& from);
  [[nodiscard]] std::vector<double> begin_large(const Candidate& candidate,
                                                const Composition& composition,
                                                const std::vector<double>& from,
                                                std::size_t worker) const;
  [[nodiscard]] std::optional<Eigen::MatrixXd> chord_of(const Candidate& candidate,
                                                        const Direction& direction,
                                                        const Composition& composition) const;
  [[nodiscard]] std::optional<Refit> refit(std::size_t index, std::size_t worker);
  [[nodiscard]] Refit described(std::size_t index, const Model& model, Composition composition,
                                ModelFit fit, std::size_t worker);
  void refine(std::vector<Refit>& list);
  [[nodiscard]] bool admissible(Refit& refit);
  [[nodiscard]] bool confirmed(Refit& refit);
  [[nodiscard]] SlowChance slow_chance(std::size_t candidate);
  [[nodiscard]] std::vector<SlowNoise::Addition> at_other_gauges(const Candidate& own) const;
  [[nodiscard]] bool stands_out(const Refit& refit) const;
  [[nodiscard]] bool fits_the_signal(const Refit& refit) const;
  void weigh_beside_slow_noise(std::vector<Refit>& list) const;
  void rate_in_order(std::vector<Refit>& list) const;
  void rate(std::vector<Refit>& list) const;
  void dismiss(const Refit& refit);
  [[nodiscard]] double share_beside_unconfirmed(const Refit& refit, double evidence) const;
  [[nodiscard]] double known_of(const EffectUse& use) const;
  [[nodiscard]] double chance_of(const Refit& refit, double gain) const;

  Study& study_;
  const Studied& base_;
  Safeguards safeguards_;
  std::vector<Candidate> candidates_;
  std::vector<Direction> directions_;
  Model afresh_;                ///< before anything was fitted: where fits begin again
  bool may_be_astray_ = false;  ///< the model as fitted
  double trials_ = 1.0;
  std::optional<SlowNoise> slow_noise_;             ///< once it is asked for
  std::map<std::size_t, SlowChance> slow_chances_;  ///< by candidate
  /// Strengths of single shots that explain most of all and that nothing confirms: slow noise, or
  /// something slow that the library lacks.
  struct Unconfirmed {
    std::size_t candidate = 0;
    double evidence = 0.0;
    double gain = 0.0;
    double freedom = 0.0;
  };
  std::optional<Unconfirmed> unconfirmed_;
  std::map<std::string, Dismissed> dismissed_;
};

}  // namespace kolsky
