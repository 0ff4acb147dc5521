#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "processing/criticism/fitting/study.hpp"
#include "processing/criticism/impact/impact_residuals.hpp"

namespace kolsky {

/// The window of a tile that is a shot's rebound speed, of no gauge.
inline constexpr const char* kRebound = "rebound";

/// ln of the chance from which on what repeats is called unexplained.
inline constexpr double kUnexplained = -9.2;

/// What a model of an impact leaves unexplained in a stretch of a gauge's record of one shot, or of
/// its rebound speed.
struct ImpactTile {
  std::size_t gauge = 0;
  std::size_t shot = 0;
  std::string window;   ///< "before", "loading", "unloading", "after", or kRebound
  double low_Hz = 0.0;  ///< of the band
  double high_Hz = 0.0;
  double chi2 = 0.0;  ///< by noise, speed's deviation and the solver's error
  double freedom = 0.0;
  double sigma = 0.0;            ///< rms in units of those: 1 under the true model
  double percent_of_peak = 0.0;  ///< rms of the deviation; of a rebound: of its speed
  double share = 0.0;            ///< of the excess over all tiles
  double log_p = 0.0;
  bool significant = false;  ///< false discovery held at 0.5 %
};

/// A group of shots of one speed, as people look at it.
struct SpeedSummary {
  double speed_m_per_s = 0.0;
  std::size_t shots = 0;
  double rms_percent = 0.0;      ///< of the mean residual, of the record's peak
  double noise_percent = 0.0;    ///< what noise and speeds alone leave there
  double peak_measured_N = 0.0;  ///< of the low-passed mean
  double peak_foretold_N = 0.0;
  double restitution_foretold = 0.0;
  double restitution_measured = 0.0;  ///< mean; 0: no rebound speed in the captures
  double chi2_reduced = 0.0;          ///< of the mean, the solver's error within its bounds
  std::vector<double> measured_N;     ///< mean force at the first gauge, at times_s()
  std::vector<double> foretold_N;
};

struct ImpactComparison {
  Misfit misfit;
  std::vector<ImpactTile> tiles;
  std::vector<SpeedSummary> speeds;
};

/// Where the part of a misfit that repeats stands to what the calculation may be off by. `compare`,
/// the daemon's light and a diagnosis go by this.
enum class Allowance {
  kept,      ///< noise and what is allowed for the calculation leave as much
  mimicked,  ///< an error of its kind may still look like that (kSolverDoubt)
  exceeded,  ///< the model fails
};

/// "kept", "mimicked", "exceeded"
[[nodiscard]] std::string name_of(Allowance allowance);

/// How much of the records a model asks for: with end-reflection the whole.
[[nodiscard]] JudgedStretch judged_stretch(const Model& model);

/// Whether something filed is some two of its deviations off: the fit may be in another minimum
/// than the truth is in.
[[nodiscard]] bool strained(const Composition& composition, const std::vector<double>& theta);
/// The same numbers, but all that is filed as it is filed.
[[nodiscard]] std::vector<double> as_filed(const Composition& composition,
                                           std::vector<double> theta);

/// A campaign of impacts under study.
class ImpactStudy {
 public:
  /// @param meshes  other than these cost more or say less; the documented figures are of these
  /// @param runs    impacts on this bench that other studies calculate too
  ImpactStudy(const Campaign& campaign, JudgedStretch stretch, double cutoff_Hz, Workers executor,
              const BallMeshes& meshes = {}, std::shared_ptr<BallRuns> runs = nullptr)
      : campaign_(campaign),
        executor_(std::move(executor)),
        residuals_(campaign, stretch, cutoff_Hz, executor_, meshes, std::move(runs)) {}

  /// Where else the last fit's model might stand, and by how much its objective is more there.
  struct SecondMinimum {
    std::vector<double> theta;
    double friction = 0.0;
    double behind = 0.0;
  };

  /// From where the model is, auxiliary parameters without a strength yet at the best of their
  /// starts, friction as filed and from little of it, noise and speeds' deviation
  /// corrected by the shots' scatter.
  [[nodiscard]] Studied fit(const Model& begun);
  /// With the noise and the fine forces as they are by now.
  [[nodiscard]] Studied refit(const Model& model, const Workers& executor,
                              Settle settle = Settle::fully);
  /// The same, from where the model is and from where another fit left what both hold.
  [[nodiscard]] Studied refit_near(const Model& model, const Studied& other);
  /// Fitted to its end from where a search has led, and where that strains what is filed or leaves
  /// more than noise from where it is filed, too: for want of what was added since, the search may
  /// have begun in a minimum that is none any more. The whitener stays.
  /// @param settle  roughly: as far as a search goes on from it
  [[nodiscard]] Studied settled(const Studied& studied, Settle settle = Settle::fully);
  /// What was settled roughly, to its end.
  [[nodiscard]] Studied polished(const Studied& settled);
  /// As a search by the coarse mesh sees it: that mesh's own minimum nearby, where what it is off
  /// by is not a rival's gain.
  [[nodiscard]] Studied by_coarse_mesh(const Studied& studied);
  /// With the solver's error allowed for by this share of the usual, and settled roughly again.
  [[nodiscard]] Studied allowing(double share, const Studied& studied);
  [[nodiscard]] Studied as_it_is(const Model& model);
  [[nodiscard]] ImpactComparison compare(const Studied& studied);

  /// A fit's model and misfit, its deviations with what the calculation may be off by.
  [[nodiscard]] Studied finish(const Model& model, Composition composition, ModelFit fit) const;
  /// Misfit of white residuals. @param used  degrees of freedom that fitted numbers took
  [[nodiscard]] Misfit misfit_of(const Eigen::VectorXd& white, double used) const;
  /// chi2 of the groups' means and its degrees of freedom: what repeats.
  [[nodiscard]] std::pair<double, double> repeated(const Eigen::VectorXd& white) const;

  /// Degrees of freedom of what differs between shots of one speed.
  [[nodiscard]] double scatter_freedom() const { return known() - repeated_freedom(); }

  /// Of the groups' mean rebound speeds by themselves: among many samples of the force a few
  /// restitutions that are off would go under.
  [[nodiscard]] std::pair<double, double> repeated_of_rebounds(const Eigen::VectorXd& white) const;

  /// ln of the chance that noise and the calculation's error, for all it is known to mimic
  /// (kSolverDoubt), leave as much that repeats: of all or of the rebounds, whichever is less. What
  /// restitutions of codes differ by is known, and nothing that they mimic: it is allowed for once.
  [[nodiscard]] double unexplained_log_p(const Eigen::VectorXd& white) const;
  /// Whether they may.
  [[nodiscard]] bool within_calculation(const Eigen::VectorXd& white) const;
  [[nodiscard]] Allowance allowance(const Studied& studied) const;

  [[nodiscard]] const std::optional<SecondMinimum>& second_minimum() const {
    return second_minimum_;
  }
  [[nodiscard]] ImpactResiduals& residuals() { return residuals_; }
  [[nodiscard]] const Campaign& campaign() const { return campaign_; }
  [[nodiscard]] const Workers& executor() const { return executor_; }

 private:
  /// Residuals of all shots less what their arrivals and offsets take up, and of the groups' means.
  [[nodiscard]] double known() const;
  [[nodiscard]] double repeated_freedom() const;
  /// Whether a fit strains what is filed or leaves more than noise: then something may be missing
  /// for want of which it is where it is.
  [[nodiscard]] bool astray(const Composition& composition, const ModelFit& fit) const;
  /// @param chord  derivatives from nearby, by the mesh that is gone by here; none: made here
  [[nodiscard]] ModelFit to_the_end(const Composition& composition, std::vector<double> theta,
                                    const Eigen::MatrixXd* chord, Settle settle);
  [[nodiscard]] std::vector<double> anchor_near(const Composition& composition,
                                                std::vector<double> theta,
                                                ImpactResiduals::AnchorBy by);
  void stand_at(const Composition& composition, ModelFit& fit);
  [[nodiscard]] ModelFit or_with_little_friction(const Model& model, const Composition& composition,
                                                 ModelFit fit);

  const Campaign& campaign_;
  Workers executor_;
  ImpactResiduals residuals_;
  std::optional<SecondMinimum> second_minimum_;
};

/// Sum of squared white residuals of every group of shots with the shared numbers fitted to the
/// other groups, to first order around the common fit: speeds the fit never saw.
[[nodiscard]] std::vector<double> held_out_speeds(const Studied& studied,
                                                  const ImpactRecords& records,
                                                  std::size_t per_shot);

}  // namespace kolsky
