#include "processing/criticism/impact/impact_residuals.hpp"

#include <algorithm>
#include <cmath>

#include "processing/algebra/algebra.hpp"
#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/impact/fine_grid.hpp"

namespace kolsky {

namespace {

constexpr double kSolverFloor = 0.005;   ///< of the force: no mesh study sees all of it
constexpr double kFinestRebound = 1e-4;  ///< relative: no two beams tell speeds better

/// Mean square of the filed deviations of the rebound speeds, relative.
double filed_rebound_sd(const ImpactRecords& records) {
  double squares = 0.0;
  double count = 0.0;
  for (const auto& rebound : records.rebound) {
    if (rebound) {
      squares += std::pow(rebound->sd / rebound->value, 2);
      count += 1.0;
    }
  }
  return std::max(kFinestRebound, std::sqrt(squares / std::max(1.0, count)));
}

/// What an error of a reading leaves in residuals: a shift in time is taken up as the reading is
/// moved to where it fits best.
Eigen::VectorXd not_of_arrival(const Eigen::VectorXd& error, const Eigen::VectorXd& by_time,
                               const Eigen::MatrixXd& noise_inverse) {
  const Eigen::VectorXd weighted = noise_inverse * by_time;
  return error - by_time * (weighted.dot(error) / weighted.dot(by_time));
}

}  // namespace

Eigen::MatrixXd ImpactResiduals::noise_matrix() const {
  const std::size_t samples = records_.window.samples;
  Eigen::MatrixXd noise = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(of_gauges()),
                                                static_cast<Eigen::Index>(of_gauges()));
  for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
    const std::vector<double>& own = records_.noise[j];
    for (std::size_t a = 0; a < samples; ++a) {
      for (std::size_t b = 0; b < samples; ++b) {
        const std::size_t lag = a > b ? a - b : b - a;
        if (lag < own.size()) {
          noise(static_cast<Eigen::Index>(j * samples + a),
                static_cast<Eigen::Index>(j * samples + b)) = noise_scale_ * own[lag];
        }
      }
    }
  }
  return noise;
}

/// Low-passed readings of a group at the judged samples of the shot in its middle; no rebound.
Eigen::VectorXd ImpactResiduals::at_judged(std::size_t g, const Foretold& foretold,
                                           const std::vector<std::vector<double>>& fine) const {
  const SpeedGroup& group = records_.groups[g];
  const std::size_t n = group.shots[group.shots.size() / 2];
  Eigen::VectorXd judged = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(per_shot()));
  for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
    for (std::size_t k = 0; k < records_.window.samples; ++k) {
      const double time_s = records_.judged_s(n, j, k) - foretold.arrival_s[n];
      judged[static_cast<Eigen::Index>(j * records_.window.samples + k)] =
          on_fine_grid(fine[j], time_s).value;
    }
  }
  return judged;
}

/// What one shot in the middle of a group foretells, from the group's two calculated impacts.
ImpactShape ImpactResiduals::shape_of(std::size_t g, const Foretold& foretold,
                                      const std::vector<std::vector<double>>& low,
                                      const std::vector<std::vector<double>>& high) const {
  const SpeedGroup& group = records_.groups[g];
  const std::size_t n = group.shots[group.shots.size() / 2];
  const auto gauges = static_cast<Eigen::Index>(of_gauges());
  const double per_speed = group.speed_m_per_s / (group.high_m_per_s - group.low_m_per_s);
  ImpactShape shape{foretold.reading[n], Eigen::VectorXd::Zero(gauges + 1),
                    Eigen::VectorXd::Zero(gauges + 1)};
  for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
    for (std::size_t k = 0; k < records_.window.samples; ++k) {
      const auto i = static_cast<Eigen::Index>(j * records_.window.samples + k);
      const double time_s = records_.judged_s(n, j, k) - foretold.arrival_s[n];
      const Interpolated a = on_fine_grid(low[j], time_s);
      shape.by_speed[i] = (on_fine_grid(high[j], time_s).value - a.value) * per_speed;
      shape.by_time[i] = a.slope_per_s;
    }
  }
  return shape;
}

void ImpactResiduals::set_whitening(const Foretold& foretold, const Composition& composition,
                                    const std::vector<double>& theta) {
  BallScene ball;
  const auto transfer = transfers(composition, theta, 0, ball);
  const Eigen::MatrixXd noise = noise_matrix();
  noise_inverse_ = symmetric_power(noise, -1.0);
  std::vector<ImpactShape> shapes;
  const auto gauges = static_cast<Eigen::Index>(of_gauges());
  const auto size = static_cast<Eigen::Index>(per_shot());
  mesh_ = Eigen::VectorXd::Zero(size * static_cast<Eigen::Index>(records_.groups.size()));
  double mesh_square = 0.0;
  double reading_square = 0.0;
  for (std::size_t g = 0; g < records_.groups.size(); ++g) {
    const SpeedGroup& group = records_.groups[g];
    const BallRun slower = force(moves_, ball, g, anchors_[g].low);
    const BallRun faster = force(moves_, ball, g, anchors_[g].high);
    const auto low = recorded(read(slower, transfer, executor_.first), 0.0);
    const auto high = recorded(read(faster, transfer, executor_.first), 0.0);
    const auto mesh = recorded(read(anchors_[g].low.mesh, transfer, executor_.first), 0.0);
    shapes.push_back(shape_of(g, foretold, low, high));
    shapes.back().by_speed.tail(1).setConstant((faster.rebound_m_per_s - slower.rebound_m_per_s) /
                                               records_.wave_speed_m_per_s * group.speed_m_per_s /
                                               (group.high_m_per_s - group.low_m_per_s));
    auto judged = mesh_.segment(static_cast<Eigen::Index>(g) * size, size);
    judged = at_judged(g, foretold, mesh);
    judged.head(gauges) =
        not_of_arrival(judged.head(gauges), shapes.back().by_time.head(gauges), noise_inverse_);
    judged[size - 1] = anchors_[g].low.mesh.rebound_m_per_s / records_.wave_speed_m_per_s;
    mesh_square += judged.head(gauges).squaredNorm();
    reading_square += shapes.back().reading.head(gauges).squaredNorm();
  }
  mesh_difference_ = std::sqrt(mesh_square / reading_square);
  // Twice what the mesh is seen to do, over all groups.
  solver_sd_ = std::max(solver_share_ * kSolverFloor, 2.0 * mesh_difference_);
  speed_sd_ = std::max(speed_sd_, records_.own_speed_sd);
  rebound_sd_ = std::max(rebound_sd_, filed_rebound_sd(records_));
  whitening_ = std::make_unique<ImpactWhitening>(
      records_, shapes, ImpactDoubts{noise, speed_sd_, rebound_sd_, solver_sd_});
  energy_ = std::make_unique<ImpactEnergy>(records_, shapes, noise, noise_inverse_, speed_sd_);
}

void ImpactResiduals::allow(double share, const Composition& composition,
                            const std::vector<double>& theta) {
  solver_share_ = share;
  set_whitening(foretell(composition, theta, executor_.first), composition, theta);
}

Eigen::MatrixXd ImpactResiduals::doubt_of(const Eigen::MatrixXd& jacobian,
                                          const Eigen::MatrixXd& covariance) const {
  const Eigen::MatrixXd moves = covariance * whitening_->pulls(jacobian);
  const Eigen::VectorXd by_mesh = moves * mesh_;
  return (kSolverDoubt - 1.0) * moves * whitening_->solver() * moves.transpose() +
         by_mesh * by_mesh.transpose();
}

/// How the residuals of one speed's shots differ, and how many of them are free in that. What grows
/// along their speeds repeats, as a model's misfit does; two shots do not tell it from noise.
std::pair<std::vector<Eigen::VectorXd>, double> ImpactResiduals::scatter_of(
    std::size_t g, const std::vector<Eigen::VectorXd>& residual) const {
  const SpeedGroup& group = records_.groups[g];
  const auto count = static_cast<double>(group.shots.size());
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(residual[group.shots[0]].size());
  for (const std::size_t n : group.shots) {
    mean += residual[n] / count;
  }
  Eigen::VectorXd trend = Eigen::VectorXd::Zero(mean.size());
  double squares = 0.0;
  for (std::size_t i = 0; i < group.shots.size(); ++i) {
    trend += group.faster[i] * (residual[group.shots[i]] - mean);
    squares += group.faster[i] * group.faster[i];
  }
  const bool told = group.shots.size() > 2 && squares > 0.0;
  std::vector<Eigen::VectorXd> offs;
  offs.reserve(group.shots.size());
  for (std::size_t i = 0; i < group.shots.size(); ++i) {
    offs.emplace_back(residual[group.shots[i]] - mean);
    if (told) {
      offs.back() -= trend * (group.faster[i] / squares);
    }
  }
  return {std::move(offs), count - (told ? 2.0 : 1.0)};
}

/// What drifts by itself in each shot, as much as its own offsets leave of it: rows of one shot's
/// judged samples, a column for each gauge.
Eigen::MatrixXd ImpactResiduals::drifts() const {
  const std::size_t samples = records_.window.samples;
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(of_gauges()),
                                                  static_cast<Eigen::Index>(campaign_.gauges()));
  for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
    for (std::size_t k = 0; k < samples; ++k) {
      columns(static_cast<Eigen::Index>(j * samples + k), static_cast<Eigen::Index>(j)) =
          static_cast<double>(k) / static_cast<double>(samples);
    }
  }
  return columns;
}

/// How shots of one speed scatter about their mean: along V dm/dV, clear of arrival and offset, by
/// their speeds; the rest is noise.
/// @param clear_of  what else each shot may have of its own; columns
ImpactResiduals::ShotScatter ImpactResiduals::scatter(const Foretold& foretold,
                                                      const Eigen::MatrixXd& clear_of) const {
  const auto size = static_cast<Eigen::Index>(of_gauges());
  ShotScatter out;
  for (std::size_t g = 0; g < records_.groups.size(); ++g) {
    const SpeedGroup& group = records_.groups[g];
    const auto count = static_cast<double>(group.shots.size());
    if (group.shots.size() < 2) {
      continue;
    }
    Eigen::VectorXd reading = Eigen::VectorXd::Zero(size);
    for (const std::size_t n : group.shots) {
      reading += foretold.reading[n].head(size) / count;
    }
    const auto [offs, left_free] = scatter_of(g, foretold.residual);
    // The force grows with the speed nearly in its own shape: arrivals and offsets are in `own`.
    Eigen::MatrixXd covariance = whitening_->own(g).topLeftCorner(size, size);
    if (const bool trend_is_left = left_free + 1.0 >= count; trend_is_left) {
      // The trend is in what is left, and in it what the solver's ripple does along the speeds.
      covariance += whitening_->trend_square(g) * whitening_->slope(g).topLeftCorner(size, size);
    }
    Eigen::MatrixXd inverse = symmetric_power(covariance, -1.0);
    if (clear_of.cols() > 0) {
      const Eigen::MatrixXd weighted = inverse * clear_of;
      inverse -= weighted * inverse_of(clear_of.transpose() * weighted) * weighted.transpose();
    }
    const Eigen::VectorXd direction = inverse * reading;
    const double information = reading.dot(direction);
    for (std::size_t i = 0; i < offs.size(); ++i) {
      const Eigen::VectorXd& off = offs[i];
      const double along = direction.dot(off.head(size)) / information;
      out.of_speed += along * along;
      const Eigen::VectorXd left = off.head(size) - along * reading;
      out.rest += left.dot(inverse * left);
      out.of_rebound += std::pow(off[size] / foretold.reading[group.shots[i]][size], 2);
    }
    out.expected_of_speed += left_free / information;
    out.freedom += left_free;
    out.rest_freedom += left_free * (static_cast<double>(size) - eliminated() - 1.0 -
                                     static_cast<double>(clear_of.cols()));
  }
  return out;
}

/// What drifts in each shot by itself is no noise: a model may lack it. Where it stands out of the
/// rest of the scatter, that is the noise.
ImpactResiduals::ShotScatter ImpactResiduals::scatter_of_noise(const Foretold& foretold) const {
  constexpr double kSurely = -20.0;  ///< ln of a chance
  constexpr double kMuch = 0.5;      ///< of the scatter
  const ShotScatter whole = scatter(foretold, {});
  ShotScatter clear = scatter(foretold, drifts());
  const double drifting = whole.rest_freedom - clear.rest_freedom;
  if (!(drifting > 0.0 && clear.rest_freedom > 0.0)) {
    return whole;
  }
  const double noise = clear.rest / clear.rest_freedom;
  const double f = (whole.rest - clear.rest) / drifting / noise;
  const bool drifting_apart = noise < kMuch * whole.rest / whole.rest_freedom &&
                              log_f_tail(f, drifting, clear.rest_freedom) < kSurely;
  return drifting_apart ? clear : whole;
}

void ImpactResiduals::calibrate(const Composition& composition, const std::vector<double>& theta) {
  const Foretold foretold = foretell(composition, theta, executor_.first);
  const ShotScatter shots = scatter_of_noise(foretold);
  if (shots.freedom < 1.0) {
    return;
  }
  const double scale = noise_scale_;
  constexpr double kLeast = 0.7;  ///< of what the quiet says, however often it is corrected
  noise_scale_ = std::max(kLeast, scale * shots.rest / shots.rest_freedom);
  // Forces grow somewhat faster than speeds; what is found here is of the force.
  const double variance = std::max(
      0.0, (shots.of_speed - shots.expected_of_speed * noise_scale_ / scale) / shots.freedom);
  constexpr double kForcePerSpeed = 1.15;
  speed_sd_ = std::sqrt(variance) / kForcePerSpeed;
  // Speeds that are filed wrongly scatter the rebounds as well; that is counted with the speeds.
  const double said = shots.freedom - static_cast<double>(records_.unsaid_rebounds());
  rebound_sd_ =
      said >= 1.0 ? std::sqrt(std::max(0.0, shots.of_rebound / said - speed_sd_ * speed_sd_)) : 0.0;
  set_whitening(foretold, composition, theta);
}

}  // namespace kolsky
