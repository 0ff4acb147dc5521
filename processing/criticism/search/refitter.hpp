#pragma once

#include <optional>
#include <vector>

#include "processing/criticism/search/refit.hpp"
#include "processing/criticism/search/search_ground.hpp"

namespace kolsky {

/// Fits a model with a candidate added, from wherever that may have to begin.
class Refitter {
 public:
  /// @param ground  outlives this
  /// @param start   the model before anything was fitted
  Refitter(const SearchGround& ground, const Model& start);

  /// @param candidate  of the ground
  [[nodiscard]] Refit refit(std::size_t candidate, std::size_t worker) const;
  /// From where it is, by derivatives of its own.
  [[nodiscard]] Refit refit_closely(Refit rough, std::size_t worker) const;

 private:
  [[nodiscard]] bool begins_afresh(const Candidate& candidate) const;
  [[nodiscard]] std::vector<double> begin_near(const Candidate& candidate,
                                               const Direction& direction,
                                               const Composition& composition,
                                               std::size_t worker) const;
  [[nodiscard]] static std::vector<std::vector<double>> large_sizes(
      const Candidate& candidate, const Composition& composition, const std::vector<double>& from);
  [[nodiscard]] std::vector<double> fits_best(std::vector<std::vector<double>> starts,
                                              const Composition& composition,
                                              std::size_t worker) const;
  [[nodiscard]] std::optional<Eigen::MatrixXd> chord_of(const Candidate& candidate,
                                                        const Direction& direction,
                                                        const Composition& composition) const;
  [[nodiscard]] ModelFit begun_from(const Composition& composition, std::vector<double> theta,
                                    const Eigen::MatrixXd* chord, std::size_t worker) const;
  void from_large_sizes(std::size_t index, const Composition& composition, std::size_t worker,
                        ModelFit& fit) const;
  void from_other_starts(std::size_t index, const Composition& composition, std::size_t worker,
                         ModelFit& fit) const;
  [[nodiscard]] Refit described(std::size_t index, const Model& model, Composition composition,
                                ModelFit fit, std::size_t worker) const;

  const SearchGround& ground_;
  Model afresh_;  ///< before anything was fitted: where fits begin again
};

}  // namespace kolsky
