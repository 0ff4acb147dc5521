#pragma once

#include <Eigen/Core>
#include <vector>

#include "processing/criticism/impact/impact_records.hpp"

namespace kolsky {

/// A group's calculated impact at its judged samples, gauge after gauge, and its rebound last, as
/// ImpactRecords measures them.
struct ImpactShape {
  Eigen::VectorXd reading;
  Eigen::VectorXd by_speed;  ///< V dm/dV
  Eigen::VectorXd by_time;   ///< dm/dt [1/s]
};

/// What the records may be off by.
struct ImpactDoubts {
  Eigen::MatrixXd noise;    ///< covariance of one shot's judged samples
  double speed_sd = 0.0;    ///< relative, of each shot by itself
  double rebound_sd = 0.0;  ///< relative, of each shot by itself
  double solver_sd = 0.0;   ///< of the force, relative: what the calculation may be off by
};

/// The covariance of a campaign of impacts and its root. With r_n the residuals of shot n,
///     S_g = N + sV^2 g g^T + sR^2 + arrival and offsets, free    by each shot of group g itself,
///     D_gh                                                       shared by groups g and h,
///     v_n v_m E_g                                                by shots n and m of group g,
/// v by how much a shot is faster than its group's mean.
/// D is what the calculation may be off by, in the shape of the force: half of its variance varies
/// slowly (60 us) and is much alike at neighbouring speeds, half of it is the ripple of a contact
/// that grows node by node (12 us), another at every speed. Of the restitution it may be off by
/// kRestitutionDoubt at all speeds alike. What is filed of the photo-sensors' distance moves all
/// speeds alike too. The ripple is another some per cent faster, so within a group it has a slope:
/// E = D's part of it over kRippleSpeeds^2.
class ImpactWhitening {
 public:
  /// Relative to the incident speed: by so much another code's restitution was seen to differ
  /// (docs/methods/impact-trials.md).
  static constexpr double kRestitutionDoubt = 0.002;
  /// In the logarithm of the speed: over so much another code's ripple keeps its sign
  /// (docs/methods/impact-trials.md).
  static constexpr double kRippleSpeeds = 0.05;

  ImpactWhitening(const ImpactRecords& records, const std::vector<ImpactShape>& shapes,
                  const ImpactDoubts& doubts);

  /// S_g^-1/2 (r_n - mean - q_n t) + q_n (S_g + |v|^2 E_g)^-1/2 t + K_g^-1/2 (C^-1/2 m)_g. m are
  /// the groups' means below each other, C their covariance diag(S_g / K_g) + D; t = sum q_n r_n
  /// with q = v / |v|. The sum of squares is the whole quadratic form.
  [[nodiscard]] Eigen::VectorXd white(const std::vector<Eigen::VectorXd>& residual) const;

  /// J^T w(m) as a matrix that takes m, an error of the groups' means, all shots of a group alike:
  /// how an error that the shots share pulls at the numbers of a fit. @param jacobian  of white
  /// residuals
  [[nodiscard]] Eigen::MatrixXd pulls(const Eigen::MatrixXd& jacobian) const;
  /// What white residuals, or derivatives of them, hold of the groups' means, each by itself
  /// with unit variance.
  [[nodiscard]] Eigen::MatrixXd means(const Eigen::MatrixXd& white) const;
  /// The groups' mean residuals below each other, of which white ones are made.
  [[nodiscard]] Eigen::VectorXd means_behind(const Eigen::VectorXd& white) const;
  /// Their covariance, C.
  [[nodiscard]] const Eigen::MatrixXd& of_means() const { return mean_covariance_; }
  /// The force's part of D as such means have it.
  [[nodiscard]] Eigen::MatrixXd white_force_doubt() const;
  /// Of D, what the calculation may be off by.
  [[nodiscard]] const Eigen::MatrixXd& solver() const { return solver_; }
  [[nodiscard]] const Eigen::MatrixXd& own(std::size_t group) const { return own_[group]; }
  /// D_gh
  [[nodiscard]] Eigen::MatrixXd shared(std::size_t g, std::size_t h) const;
  /// E_g
  [[nodiscard]] const Eigen::MatrixXd& slope(std::size_t group) const { return slopes_[group]; }
  /// |v|^2
  [[nodiscard]] double trend_square(std::size_t group) const { return trend_squares_[group]; }

 private:
  void set_own(const std::vector<ImpactShape>& shapes, const ImpactDoubts& doubts);
  void set_shared(const std::vector<ImpactShape>& shapes, const ImpactDoubts& doubts);
  void set_trends();

  const ImpactRecords& records_;
  Eigen::Index size_ = 0;               ///< of one shot's residuals
  std::vector<Eigen::MatrixXd> own_;    ///< by group
  std::vector<Eigen::MatrixXd> roots_;  ///< S^-1/2
  /// By group: v / |v|, zeros where its shots are equally fast.
  std::vector<Eigen::VectorXd> trends_;
  std::vector<double> trend_squares_;
  std::vector<Eigen::MatrixXd> slopes_;       ///< by group
  std::vector<Eigen::MatrixXd> trend_roots_;  ///< (S + |v|^2 E)^-1/2
  Eigen::MatrixXd shared_;
  Eigen::MatrixXd solver_;
  Eigen::MatrixXd mean_covariance_;  ///< C
  Eigen::MatrixXd mean_root_;        ///< C^-1/2
};

/// A symmetric matrix's power; eigenvalues that are nothing beside the largest are held there.
[[nodiscard]] Eigen::MatrixXd symmetric_power(const Eigen::MatrixXd& matrix, double power);

}  // namespace kolsky
