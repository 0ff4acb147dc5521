#pragma once

#include <Eigen/Cholesky>
#include <string>
#include <tuple>
#include <vector>

#include "tests/hidden_effects/prober.hpp"

namespace kolsky::scoring {

/// A stretch of one gauge's record in one shot, as a comparison divides it; seconds from the
/// record's first sample. It fades in and out around its ends, over so long.
struct Stretch {
  std::string gauge;
  std::string window;
  std::size_t shot = 0;  ///< from 0
  double start_s = 0.0;
  double end_s = 0.0;
  double fade_in_s = 0.0;
  double fade_out_s = 0.0;
  bool quiet = false;  ///< before the pulse
};

/// All places that a comparison reports on: every stretch in every band.
struct Places {
  std::vector<std::pair<double, double>> bands_Hz;
  std::vector<Stretch> stretches;
};

/// Gauge, window, shot and band.
using Place = std::tuple<std::string, std::string, std::size_t, std::size_t>;

/// What a hidden effect leaves in one place.
struct PlaceTruth {
  Place place;
  double excess = 0.0;   ///< energy over what noise has per degree of freedom
  double freedom = 0.0;  ///< of the noise there
  bool touched = false;  ///< whether the effect changes this gauge's records at all
  bool trace = false;    ///< less than a thousandth of what its shot's records have in excess
  /// Whether a test of this place alone, at 5 %, finds the excess in four cases of five, and it is
  /// no trace: what a missing wave makes sources and moduli do to the rest of a record.
  [[nodiscard]] bool fails() const;
};

/// The excess that a chi-square test at 5 % finds in four cases of five.
[[nodiscard]] double findable_excess(double freedom);

/// Where a model without an effect fails, from the generator alone: the change of the noise-free
/// records, whitened with the noise drawn; sources, offsets, moduli and known unknowns at their
/// best; then its energy in each place.
class FailingPlaces {
 public:
  /// @param bare  the campaign with nothing hidden; outlives this
  explicit FailingPlaces(const testing::Campaign& bare);

  /// @param hidden  the same with an effect
  [[nodiscard]] std::vector<PlaceTruth> of(const testing::Campaign& hidden, const Places& places);

 private:
  using Records = std::vector<std::vector<double>>;

  /// What can be fitted, to first order about one campaign.
  struct FirstOrder {
    /// @param about  outlives this
    explicit FirstOrder(const testing::Campaign& about);

    [[nodiscard]] testing::Readings left_of(testing::Readings change) const;
    /// Gradient of minus half the objective. @param places  of the nuisances, from the bare
    /// campaign
    [[nodiscard]] Eigen::VectorXd pull_of(const testing::Readings& left,
                                          const Eigen::VectorXd& places) const;
    [[nodiscard]] double objective(const testing::Readings& left,
                                   const Eigen::VectorXd& places) const;

    /// Levenberg and Marquardt's. @param damping  of the information's diagonal; 0: Gauss's and
    /// Newton's
    [[nodiscard]] Eigen::VectorXd step(const Eigen::VectorXd& pull, double damping) const;

    Prober prober;
    SourceFreedom freedom;
    std::vector<Direction> nuisances;  ///< what sources and offsets leave of them
    Eigen::MatrixXd information;       ///< of the nuisances, priors in it
  };
  /// Where a fit has come to.
  struct Fit {
    Eigen::VectorXd places;
    testing::Readings left;
  };

  /// Of hidden records, with the nuisances at their best.
  [[nodiscard]] testing::Readings left_by_fit(const testing::Campaign& hidden);
  /// As near as derivatives from one campaign lead. @return by how much the objective fell
  double approach(FirstOrder& about, const testing::Campaign& hidden, Fit& fit) const;
  [[nodiscard]] testing::Campaign bare_at(const Eigen::VectorXd& places) const;

  const testing::Campaign& bare_;
  FirstOrder about_bare_;
  std::vector<Records> noise_;  ///< draws, less what sources and offsets take up
};

}  // namespace kolsky::scoring
