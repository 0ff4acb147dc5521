#pragma once

#include <Eigen/Core>
#include <memory>
#include <utility>
#include <vector>

#include "processing/base/workers.hpp"
#include "processing/criticism/fitting/shot_residuals.hpp"
#include "processing/criticism/impact/ball_runs.hpp"
#include "processing/criticism/impact/impact_energy.hpp"
#include "processing/criticism/impact/impact_records.hpp"
#include "processing/criticism/impact/impact_whitening.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

/// Another code of the same ball departs from this one smoothly, as effects do, and so mimics them
/// more than what is allowed for its size says: how far, campaigns without any effect show that
/// another code made on meshes of its own (docs/methods/impact-trials.md). A square of a normal
/// deviate counts over this, at least, and the solver's share of a number's variance is this many
/// times what was allowed for.
inline constexpr double kSolverDoubt = 6.0;
/// Squares of normal deviates, over kSolverDoubt: by so much one explanation stands before another.
inline constexpr double kStandsBefore = 7.5;

/// Whitened residuals of impacts: the records and the rebound speeds less what the ball's solver
/// and the bar foretell, at every shot's own speed. Nothing of the source is free but its arrival.
///
/// A shot's residual is r_n = y_n - m(theta, V_n, t_n), t_n where it fits best, its rebound's last.
/// Its covariance is ImpactWhitening's: noise as before the pulse (scaled by what repeats scatter),
/// speeds, arrival and offsets of each shot by itself; what the calculation may be off by, twice
/// what the middle mesh differs from the fine one and at least a floor, is shared by all.
///
/// Three meshes: m = fine(theta_0) + coarse(theta) - coarse(theta_0), theta_0 as prepared. The fine
/// ones are at the ends of a group's speeds, for the slope between them; the coarse ones in the
/// middle, and what theta changes there grows with the speed as a ball's force does: within the per
/// cent or two of a group that is good to a hundredth of the change. A search may go by the coarse
/// mesh; what is said in the end may not: numbers that do nearly the same to a ball (friction, the
/// law's form, a stiffening) are told apart by what the mesh does to each of them, which leads fits
/// astray and makes deviations a third of what they are (Moves).
class ImpactResiduals : public ShotResiduals {
 public:
  /// @param runs  impacts on this bench that others calculate too; none: its own
  ImpactResiduals(const Campaign& campaign, JudgedStretch stretch, double cutoff_Hz,
                  const Workers& executor, const BallMeshes& meshes = {},
                  std::shared_ptr<BallRuns> runs = nullptr);

  /// Takes from this model the fine forces, the arrivals and the whitener.
  /// @throws InputError what the solver refuses there
  void prepare(const Composition& composition, const std::vector<double>& theta);
  /// Takes the fine forces from here and leaves the whitener as it is: far from where they were
  /// taken, what the coarse mesh does is not what the fine one does.
  /// @param by  the middle mesh, seven times as quick, with what the fine one differed by where it
  ///            was calculated last
  enum class AnchorBy { fine, middle };
  void anchor(const Composition& composition, const std::vector<double>& theta,
              AnchorBy by = AnchorBy::fine);
  /// By which mesh forces change with theta from now on, until the fine ones are taken anew. By the
  /// middle one what the law's form does to them changes, too: held as it was, or by the coarse
  /// mesh, it led fits along the law by some tens of chi2. Along the coarse one: what a step gains
  /// is the middle mesh's, where it leads to the coarse one's, at an eighth of a derivative's cost.
  enum class Moves { coarse, middle, middle_along_coarse };
  void move_by(Moves mesh, const Composition& composition);
  /// Where the fine forces were taken last.
  [[nodiscard]] const std::vector<double>& anchored_at() const { return anchored_at_; }
  /// Of the core or the cover where the fine forces were taken last, at the highest speed: the
  /// share that is strained beyond what the law of a solid that softens allows.
  [[nodiscard]] double falling_share() const { return anchors_.back().high.fine.falling_share; }
  /// There, of the core: the share beyond a strain of 0.1.
  [[nodiscard]] double strained_share() const { return anchors_.back().high.fine.strained_share; }
  /// Allows for this share of what the force's calculation is commonly off by, and for twice what
  /// the meshes show at least.
  void allow(double share, const Composition& composition, const std::vector<double>& theta);
  [[nodiscard]] double solver_share() const { return solver_share_; }
  [[nodiscard]] const ImpactWhitening& whitening() const { return *whitening_; }
  /// Corrects noise and speeds' deviation by how shots of one speed scatter about their mean.
  void calibrate(const Composition& composition, const std::vector<double>& theta);

  [[nodiscard]] Eigen::VectorXd evaluate(const Composition& composition,
                                         const std::vector<double>& theta,
                                         std::size_t worker) override;
  [[nodiscard]] Eigen::VectorXd evaluate_on(const Workers& executor, const Composition& composition,
                                            const std::vector<double>& theta) override;
  [[nodiscard]] Eigen::VectorXd evaluate_shot(const Composition& composition,
                                              const std::vector<double>& theta, std::size_t shot,
                                              std::size_t worker) override;
  [[nodiscard]] bool has_quick_differences() const override {
    return moves_ == Moves::middle_along_coarse;
  }
  [[nodiscard]] Eigen::VectorXd evaluate_for_differences(const Composition& composition,
                                                         const std::vector<double>& theta,
                                                         std::size_t worker) override;
  [[nodiscard]] std::size_t per_shot() const override;
  /// A node that touches or leaves moves all residuals by 0.002 to 0.005 of a deviation: over a
  /// step of 0.002 that is as much as a cover's modulus does, over this one a tenth and less.
  [[nodiscard]] double least_difference() const override { return 0.05; }
  [[nodiscard]] bool shots_hang_together() const override { return true; }

  /// What is foretold of every shot at its judged samples, aligned, and its residual.
  struct Foretold {
    std::vector<Eigen::VectorXd> reading;   ///< by shot: gauge after gauge, then its rebound
    std::vector<Eigen::VectorXd> residual;  ///< by shot, not whitened; unsaid rebounds: as fellows'
    std::vector<double> arrival_s;          ///< of the first touch, from the record's start
    std::vector<double> rebound_m_per_s;    ///< by shot
    bool sound = true;                      ///< false where the solver refused
  };
  [[nodiscard]] Foretold foretell(const Composition& composition, const std::vector<double>& theta,
                                  std::size_t worker);

  /// What gauges would say of one shot, at its record's samples, smoothed well above the judged
  /// band: strain, with what effects do to records, on the middle mesh, which no fit stands on.
  struct Sensed {
    std::vector<std::vector<double>> strain;  ///< by gauge
    double rebound_m_per_s = 0.0;
  };
  /// @param arrival_s  of the first touch, from the record's start
  /// @param faster     than filed, relative
  /// @throws InputError what the solver refuses
  [[nodiscard]] Sensed sensed(const Composition& composition, const std::vector<double>& theta,
                              std::size_t shot, double arrival_s, double faster,
                              std::size_t worker);

  [[nodiscard]] const BallMeshes& meshes() const { return meshes_; }
  [[nodiscard]] const ImpactRecords& records() const { return records_; }
  [[nodiscard]] const Campaign& campaign() const { return campaign_; }
  /// Covariance of one shot by itself, and what all shots of a group share of the solver's error.
  [[nodiscard]] Eigen::MatrixXd covariance(std::size_t group) const {
    return whitening_->own(group) + whitening_->shared(group, group);
  }
  /// Residuals of a shot that its own arrival and offsets take up.
  [[nodiscard]] double eliminated() const { return 1.0 + static_cast<double>(campaign_.gauges()); }
  /// Residuals of a shot that are of its gauges; the one behind them is of its rebound.
  [[nodiscard]] std::size_t of_gauges() const {
    return records_.window.samples * campaign_.gauges();
  }
  [[nodiscard]] const ImpactEnergy& energy() const { return *energy_; }
  [[nodiscard]] double speed_sd() const { return speed_sd_; }  ///< relative
  /// Of a rebound speed, relative: what is filed, or how they scatter where that is more.
  [[nodiscard]] double rebound_sd() const { return rebound_sd_; }
  [[nodiscard]] double noise_scale() const { return noise_scale_; }
  /// Relative size of what the calculation may be off by.
  [[nodiscard]] double solver_sd() const { return solver_sd_; }
  /// Rms of the middle mesh's difference from the fine one as residuals hold it, at the judged
  /// samples and shifted to fit, over the rms of the record.
  [[nodiscard]] double mesh_difference() const { return mesh_difference_; }
  /// What the calculation may be off by moves the numbers of a fit by so much: a covariance, in
  /// scales. kSolverDoubt times what is allowed for it less the once that the fit counts already,
  /// and what the middle mesh's difference from the fine one would do, whole.
  /// @param jacobian    of white residuals
  /// @param covariance  of the fit
  [[nodiscard]] Eigen::MatrixXd doubt_of(const Eigen::MatrixXd& jacobian,
                                         const Eigen::MatrixXd& covariance) const;
  /// Times of a gauge's judged samples from the arrival at the reference gauge.
  [[nodiscard]] std::vector<double> times_s() const;
  /// Strain at a gauge times this is the force there, at low frequencies.
  [[nodiscard]] double force_per_strain_N() const;

 private:
  /// What gauges read of one impact, on a fine grid from `kFineGridLead_s` before the first touch.
  struct Reading {
    std::vector<std::vector<double>> strain;  ///< by gauge
    double rebound_m_per_s = 0.0;
  };
  /// The same of a group's two calculated impacts.
  struct Readings {
    std::vector<std::vector<double>> low, high;  ///< by gauge
    double rebound_low = 0.0;
    double rebound_high = 0.0;
    [[nodiscard]] Reading at(double share) const;
  };
  struct Anchor {
    double speed_m_per_s = 0.0;
    BallRun fine;        ///< at the prepared numbers
    BallRun law;         ///< Cauchy's less Kirchhoff's
    BallRun mesh;        ///< fine less middle
    BallRun coarse;      ///< at the group's mean speed
    BallRun middle;      ///< there, where forces change by it
    BallRun middle_law;  ///< the law by it, there
  };
  /// At the ends of a group's speeds.
  struct Anchors {
    Anchor low;
    Anchor high;
  };

  [[nodiscard]] RecordScene record_of(const Composition& composition,
                                      const std::vector<double>& theta, std::size_t shot) const;
  [[nodiscard]] Foretold foretold_by(Moves mesh, const Composition& composition,
                                     const std::vector<double>& theta, std::size_t worker);
  [[nodiscard]] Eigen::VectorXd white(const Foretold& foretold) const;
  [[nodiscard]] BallRun force(Moves mesh, const BallScene& ball, std::size_t group,
                              const Anchor& anchor);
  void run_ahead(const Workers& executor, const BallScene& ball);
  [[nodiscard]] BallRun law_by(const BallScene& ball, double speed_m_per_s, std::size_t elements);
  [[nodiscard]] std::vector<std::vector<Complex>> transfers(const Composition& composition,
                                                            const std::vector<double>& theta,
                                                            std::size_t shot,
                                                            BallScene& ball) const;
  [[nodiscard]] std::vector<std::vector<double>> read(
      const BallRun& run, const std::vector<std::vector<Complex>>& transfer,
      std::size_t worker) const;
  [[nodiscard]] std::vector<std::vector<double>> recorded(std::vector<std::vector<double>> strain,
                                                          double bridge_b) const;
  [[nodiscard]] Readings readings_of(Moves mesh, const BallScene& ball, std::size_t group,
                                     const std::vector<std::vector<Complex>>& transfer,
                                     double bridge_b, std::size_t worker);
  [[nodiscard]] double share_of(std::size_t shot) const;
  void foretell_shot(std::size_t n, const Reading& strain, const Eigen::VectorXd& record,
                     Foretold& out) const;
  [[nodiscard]] double aligned(std::size_t n, const Reading& strain, const Eigen::VectorXd& record,
                               Eigen::VectorXd& reading) const;
  void set_whitening(const Foretold& foretold, const Composition& composition,
                     const std::vector<double>& theta);
  [[nodiscard]] Eigen::VectorXd at_judged(std::size_t group, const Foretold& foretold,
                                          const std::vector<std::vector<double>>& fine) const;
  [[nodiscard]] ImpactShape shape_of(std::size_t group, const Foretold& foretold,
                                     const std::vector<std::vector<double>>& low,
                                     const std::vector<std::vector<double>>& high) const;
  [[nodiscard]] Eigen::VectorXd measured(std::size_t shot, const RecordScene& record) const;
  /// Squares, over all shots that have fellows of their speed.
  struct ShotScatter {
    double of_speed = 0.0;           ///< relative to the force
    double expected_of_speed = 0.0;  ///< of noise alone
    double of_rebound = 0.0;         ///< relative
    double freedom = 0.0;            ///< of these
    double rest = 0.0;               ///< over the noise as it is known
    double rest_freedom = 0.0;
  };
  [[nodiscard]] Eigen::MatrixXd drifts() const;
  [[nodiscard]] ShotScatter scatter(const Foretold& foretold,
                                    const Eigen::MatrixXd& clear_of) const;
  [[nodiscard]] ShotScatter scatter_of_noise(const Foretold& foretold) const;
  [[nodiscard]] std::pair<std::vector<Eigen::VectorXd>, double> scatter_of(
      std::size_t g, const std::vector<Eigen::VectorXd>& residual) const;
  void fill_unsaid_rebounds(Foretold& foretold) const;
  [[nodiscard]] Eigen::MatrixXd noise_matrix() const;

  const Campaign& campaign_;
  Workers executor_;
  BallMeshes meshes_;
  Moves moves_ = Moves::coarse;
  ImpactRecords records_;
  std::shared_ptr<BallRuns> runs_;
  std::vector<Anchors> anchors_;  ///< by group
  std::vector<double> anchored_at_;
  std::unique_ptr<ImpactWhitening> whitening_;
  std::unique_ptr<ImpactEnergy> energy_;
  Eigen::VectorXd mesh_;  ///< fine less middle, as the groups' mean residuals hold it
  Eigen::MatrixXd noise_inverse_;
  std::vector<Complex> path_;
  std::vector<double> touch_s_;  ///< by shot: where the search for the arrival begins
  std::vector<std::unique_ptr<DampedTransform>> transforms_;  ///< by worker
  double noise_scale_ = 1.0;
  double speed_sd_ = 0.0;
  double rebound_sd_ = 0.0;
  double solver_share_ = 1.0;
  double solver_sd_ = 0.0;
  double mesh_difference_ = 0.0;
};

}  // namespace kolsky
