#include "processing/criticism/impact_residuals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "processing/base/error.hpp"
#include "processing/criticism/fine_grid.hpp"
#include "processing/impact/filter.hpp"
#include "processing/models/physics.hpp"

namespace kolsky {

namespace {

constexpr double kSolverFloor = 0.005;  ///< of the force: no mesh study sees all of it
constexpr double kSettled_s = 1e-11;
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

}  // namespace

ImpactResiduals::ImpactResiduals(const Campaign& campaign, bool whole, double cutoff_Hz,
                                 const Workers& executor)
    : campaign_(campaign),
      executor_(executor),
      records_(read_impact_records(campaign, whole, cutoff_Hz)),
      runs_(campaign.bench) {
  const ImpactWindow& window = records_.window;
  const double judged_s = window.period_s * static_cast<double>(window.samples);
  const auto samples =
      static_cast<std::size_t>((judged_s + 3.0 * kFineGridLead_s + 300e-6) / kRunStep_s);
  for (std::size_t worker = 0; worker < executor.workers; ++worker) {
    transforms_.push_back(std::make_unique<DampedTransform>(samples, kRunStep_s));
  }
  for (std::size_t k = 0; k < transforms_[0]->bins(); ++k) {
    path_.push_back(transforms_[0]->s(k));
  }
  const Bar& bar = campaign.bench.input;
  const double c0 = std::sqrt(*bar.youngs_modulus_Pa / bar.density_kg_m3);
  for (const CampaignShot& shot : campaign.shots) {
    touch_s_.push_back(shot.foot_s - campaign.bench.gauges[campaign.reference].position_m / c0);
  }
}

std::size_t ImpactResiduals::per_shot() const {
  return of_gauges() + 1;
}

std::vector<double> ImpactResiduals::times_s() const {
  std::vector<double> times;
  for (std::size_t k = 0; k < records_.window.samples; ++k) {
    times.push_back(static_cast<double>(k) * records_.window.period_s - records_.window.lead_s);
  }
  return times;
}

double ImpactResiduals::force_per_strain_N() const {
  return *campaign_.bench.input.youngs_modulus_Pa * campaign_.bench.input.area_m2();
}

BallRun ImpactResiduals::force(const BallScene& ball, std::size_t group, bool high) {
  const SpeedGroup& own = records_.groups[group];
  const double speed = high ? own.high_m_per_s : own.low_m_per_s;
  const Anchor& anchor = anchors_[group][high ? 1 : 0];
  const BallRun coarse = *runs_.run(ball, speed, kCoarseBall);
  return sum_of(sum_of(coarse, 1.0, anchor.fine_less_coarse), ball.cauchy_share, anchor.law);
}

std::vector<std::vector<Complex>> ImpactResiduals::transfers(const Composition& composition,
                                                             const std::vector<double>& theta,
                                                             std::size_t shot,
                                                             BallScene& ball) const {
  Scene scene(campaign_.bench, campaign_.shots[shot].facts, path_);
  shape(composition.applied(theta, shot), scene);
  ball = *scene.ball;
  std::vector<std::vector<Complex>> readings = transfers_of(scene, campaign_.reference).reading;
  const BarScene& bar = scene.bars.front();
  const double x0 = scene.gauges[campaign_.reference].position_m;
  for (auto& reading : readings) {
    for (std::size_t k = 0; k < path_.size(); ++k) {
      // From the struck end, per unit force.
      reading[k] *= std::exp(-bar.gamma_per_m[k] * x0) * bar.J_per_Pa[k] / bar.area_m2;
    }
  }
  return readings;
}

std::vector<std::vector<double>> ImpactResiduals::read(
    const BallRun& run, const std::vector<std::vector<Complex>>& transfer,
    std::size_t worker) const {
  DampedTransform& transform = *transforms_[worker];
  const auto before = static_cast<std::size_t>(std::lround(kFineGridLead_s / kRunStep_s));
  std::vector<double> force(before, 0.0);
  force.insert(force.end(), run.force_N.begin(), run.force_N.end());
  force.resize(std::min(force.size(), transform.length()));
  std::vector<Complex> spectrum(transform.bins());
  transform.forward(force, spectrum);
  std::vector<std::vector<double>> readings;
  std::vector<Complex> own(spectrum.size());
  for (const auto& gauge : transfer) {
    for (std::size_t k = 0; k < own.size(); ++k) {
      own[k] = spectrum[k] * gauge[k];
    }
    // What the damping multiplies at the very end is left away.
    std::vector<double> strain(transform.length() * 9 / 10);
    transform.inverse(own, strain);
    readings.push_back(std::move(strain));
  }
  return readings;
}

std::vector<std::vector<double>> ImpactResiduals::recorded(std::vector<std::vector<double>> strain,
                                                           double bridge_b) const {
  for (auto& own : strain) {
    for (double& e : own) {
      e *= 1.0 + bridge_b * e;
    }
    own = impact::low_passed(own, kRunStep_s, records_.window.cutoff_Hz);
  }
  return strain;
}

/// Memoryless maps and additions of a shot; nothing travels here.
RecordScene ImpactResiduals::record_of(const Composition& composition,
                                       const std::vector<double>& theta, std::size_t shot) const {
  Scene scene(campaign_.bench, campaign_.shots[shot].facts, {});
  if (composition.changes_records()) {
    for (const AppliedEffect& use : composition.applied(theta, shot)) {
      if (use.effect->about().stage == Stage::record) {
        use.effect->apply(scene, use.values, use.gauge);
      }
    }
  }
  return scene.record;
}

ImpactResiduals::Foretold ImpactResiduals::foretell(const Composition& composition,
                                                    const std::vector<double>& theta,
                                                    std::size_t worker) {
  Foretold out;
  const std::size_t gauges = campaign_.gauges();
  const std::size_t samples = records_.window.samples;
  const auto size = static_cast<Eigen::Index>(of_gauges());
  const std::size_t shots = campaign_.shots.size();
  out.reading.resize(shots);
  out.residual.resize(shots);
  out.arrival_s.resize(shots);
  out.rebound_m_per_s.resize(shots);
  std::vector<std::vector<Complex>> transfer;
  BallScene ball;
  std::size_t shaped = shots;
  for (std::size_t g = 0; g < records_.groups.size(); ++g) {
    const SpeedGroup& group = records_.groups[g];
    Readings readings;
    for (const std::size_t n : group.shots) {
      const bool first = shaped == shots || composition.differs_by_shot();
      if (first) {
        transfer = transfers(composition, theta, n, ball);
        shaped = n;
      }
      const RecordScene record = record_of(composition, theta, n);
      if (readings.low.empty() || composition.differs_by_shot()) {
        try {
          const BallRun low = force(ball, g, false);
          const BallRun high = force(ball, g, true);
          readings = {recorded(read(low, transfer, worker), record.bridge_b),
                      recorded(read(high, transfer, worker), record.bridge_b), low.rebound_m_per_s,
                      high.rebound_m_per_s};
        } catch (const InputError&) {
          out.sound = false;
          return out;
        }
      }
      const double share = (*campaign_.shots[n].facts.incident_speed_m_per_s - group.low_m_per_s) /
                           (group.high_m_per_s - group.low_m_per_s);
      std::vector<std::vector<double>> strain(gauges);
      for (std::size_t j = 0; j < gauges; ++j) {
        strain[j].resize(readings.low[j].size());
        for (std::size_t i = 0; i < strain[j].size(); ++i) {
          strain[j][i] = (1.0 - share) * readings.low[j][i] + share * readings.high[j][i];
        }
      }
      // The arrival where it fits best, by the noise alone.
      const Eigen::VectorXd record_n = measured(n, record);
      double touch_s = touch_s_[n];
      Eigen::VectorXd reading(size);
      Eigen::VectorXd slope(size);
      for (int iteration = 0; iteration < 12; ++iteration) {
        for (std::size_t j = 0; j < gauges; ++j) {
          for (std::size_t k = 0; k < samples; ++k) {
            const double time_s =
                records_.first_s[n] + static_cast<double>(k) * records_.window.period_s - touch_s;
            const Interpolated own = on_fine_grid(strain[j], time_s);
            reading[static_cast<Eigen::Index>(j * samples + k)] = own.value;
            slope[static_cast<Eigen::Index>(j * samples + k)] = own.slope_per_s;
          }
        }
        const Eigen::VectorXd weighted =
            noise_inverse_.size() == 0 ? slope : Eigen::VectorXd(noise_inverse_ * slope);
        constexpr double kLongestStep_s = 20e-6;
        const double step_s = std::clamp(-weighted.dot(record_n - reading) / weighted.dot(slope),
                                         -kLongestStep_s, kLongestStep_s);
        if (!std::isfinite(step_s) || std::abs(step_s) < kSettled_s) {
          break;
        }
        touch_s += step_s;
      }
      out.arrival_s[n] = touch_s;
      out.rebound_m_per_s[n] = (1.0 - share) * readings.rebound_low + share * readings.rebound_high;
      const double rebound = out.rebound_m_per_s[n] / records_.wave_speed_m_per_s;
      const auto& said = records_.rebound[n];
      out.reading[n].resize(size + 1);
      out.reading[n] << reading, rebound;
      out.residual[n].resize(size + 1);
      out.residual[n] << record_n - reading, said ? *said - rebound : 0.0;
    }
  }
  fill_unsaid_rebounds(out);
  return out;
}

/// A shot's record as gauges sensed it, less what effects add to it.
Eigen::VectorXd ImpactResiduals::measured(std::size_t shot, const RecordScene& record) const {
  const std::size_t samples = records_.window.samples;
  Eigen::VectorXd out = Eigen::Map<const Eigen::VectorXd>(records_.judged[shot].data(),
                                                          static_cast<Eigen::Index>(of_gauges()));
  for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
    const std::vector<double>& added = record.additions[j];
    for (std::size_t k = 0; k < samples && !added.empty(); ++k) {
      const double place =
          (records_.first_s[shot] + static_cast<double>(k) * records_.window.period_s) /
          campaign_.period_s;
      const auto i = std::min(static_cast<std::size_t>(std::lround(place)), added.size() - 1);
      out[static_cast<Eigen::Index>(j * samples + k)] -= added[i];
    }
  }
  return out;
}

/// A group's mean rebound is that of the shots that say one.
void ImpactResiduals::fill_unsaid_rebounds(Foretold& foretold) const {
  const auto last = static_cast<Eigen::Index>(of_gauges());
  for (std::size_t g = 0; g < records_.groups.size(); ++g) {
    const SpeedGroup& group = records_.groups[g];
    const std::size_t unsaid = records_.unsaid_rebounds(g);
    if (unsaid == 0 || unsaid == group.shots.size()) {
      continue;
    }
    double sum = 0.0;
    for (const std::size_t n : group.shots) {
      sum += records_.rebound[n] ? foretold.residual[n][last] : 0.0;
    }
    for (const std::size_t n : group.shots) {
      if (!records_.rebound[n]) {
        foretold.residual[n][last] = sum / static_cast<double>(group.shots.size() - unsaid);
      }
    }
  }
}

Eigen::VectorXd ImpactResiduals::evaluate(const Composition& composition,
                                          const std::vector<double>& theta, std::size_t worker) {
  const Foretold foretold = foretell(composition, theta, worker);
  const auto size = static_cast<Eigen::Index>(per_shot());
  const auto shots = static_cast<Eigen::Index>(campaign_.shots.size());
  if (!foretold.sound) {
    return Eigen::VectorXd::Constant(size * shots, std::numeric_limits<double>::quiet_NaN());
  }
  return whitening_->white(foretold.residual);
}

Eigen::VectorXd ImpactResiduals::evaluate_shot(const Composition& composition,
                                               const std::vector<double>& theta, std::size_t shot,
                                               std::size_t worker) {
  const auto size = static_cast<Eigen::Index>(per_shot());
  return evaluate(composition, theta, worker).segment(static_cast<Eigen::Index>(shot) * size, size);
}

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

void ImpactResiduals::anchor(const Composition& composition, const std::vector<double>& theta) {
  BallScene ball;
  static_cast<void>(transfers(composition, theta, 0, ball));
  struct Task {
    std::size_t group;
    bool high;
    std::size_t elements;
    bool cauchy;
  };
  std::vector<Task> tasks;
  for (const std::size_t elements : {kFineBall, kMiddleBall, kCoarseBall}) {
    for (std::size_t g = 0; g < records_.groups.size(); ++g) {
      for (const bool high : {false, true}) {
        tasks.push_back({g, high, elements, false});
        if (elements == kMiddleBall) {
          tasks.push_back({g, high, elements, true});
        }
      }
    }
  }
  const auto run = [&](const Task& task) {
    const SpeedGroup& group = records_.groups[task.group];
    return runs_.run(ball, task.high ? group.high_m_per_s : group.low_m_per_s, task.elements,
                     task.cauchy);
  };
  executor_.run(tasks.size(),
                [&](std::size_t i, std::size_t) { static_cast<void>(run(tasks[i])); });
  anchored_at_ = theta;
  anchors_.assign(records_.groups.size(), {});
  for (std::size_t g = 0; g < records_.groups.size(); ++g) {
    for (const bool high : {false, true}) {
      const BallRun fine = *run({g, high, kFineBall, false});
      const BallRun middle = *run({g, high, kMiddleBall, false});
      Anchor& own = anchors_[g][high ? 1 : 0];
      own.fine_less_coarse = sum_of(fine, -1.0, *run({g, high, kCoarseBall, false}));
      own.law = sum_of(*run({g, high, kMiddleBall, true}), -1.0, middle);
      own.mesh = sum_of(fine, -1.0, middle);
    }
  }
}

void ImpactResiduals::prepare(const Composition& composition, const std::vector<double>& theta) {
  anchor(composition, theta);
  const Foretold foretold = foretell(composition, theta, executor_.first);
  if (!foretold.sound) {
    throw InputError("model", "has a ball that the solver refuses", "bring its numbers nearer");
  }
  touch_s_ = foretold.arrival_s;
  set_whitening(foretold, composition, theta);
}

/// Low-passed readings of a group at the judged samples of the shot in its middle; no rebound.
Eigen::VectorXd ImpactResiduals::at_judged(std::size_t g, const Foretold& foretold,
                                           const std::vector<std::vector<double>>& fine) const {
  const SpeedGroup& group = records_.groups[g];
  const std::size_t n = group.shots[group.shots.size() / 2];
  Eigen::VectorXd judged = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(per_shot()));
  for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
    for (std::size_t k = 0; k < records_.window.samples; ++k) {
      const double time_s = records_.first_s[n] +
                            static_cast<double>(k) * records_.window.period_s -
                            foretold.arrival_s[n];
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
      const double time_s = records_.first_s[n] +
                            static_cast<double>(k) * records_.window.period_s -
                            foretold.arrival_s[n];
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
  // Twice what the mesh is seen to do, over all groups.
  std::vector<ImpactShape> shapes;
  const double judged_s =
      kFineGridLead_s + records_.window.period_s * static_cast<double>(records_.window.samples);
  const auto last = static_cast<std::size_t>(judged_s / kRunStep_s);
  const auto size = static_cast<Eigen::Index>(per_shot());
  mesh_ = Eigen::VectorXd::Zero(size * static_cast<Eigen::Index>(records_.groups.size()));
  double mesh_square = 0.0;
  double reading_square = 0.0;
  for (std::size_t g = 0; g < records_.groups.size(); ++g) {
    const SpeedGroup& group = records_.groups[g];
    const BallRun slower = force(ball, g, false);
    const BallRun faster = force(ball, g, true);
    const auto low = recorded(read(slower, transfer, executor_.first), 0.0);
    const auto high = recorded(read(faster, transfer, executor_.first), 0.0);
    const auto mesh = recorded(read(anchors_[g][0].mesh, transfer, executor_.first), 0.0);
    auto judged = mesh_.segment(static_cast<Eigen::Index>(g) * size, size);
    judged = at_judged(g, foretold, mesh);
    judged[size - 1] = anchors_[g][0].mesh.rebound_m_per_s / records_.wave_speed_m_per_s;
    shapes.push_back(shape_of(g, foretold, low, high));
    shapes.back().by_speed.tail(1).setConstant((faster.rebound_m_per_s - slower.rebound_m_per_s) /
                                               records_.wave_speed_m_per_s * group.speed_m_per_s /
                                               (group.high_m_per_s - group.low_m_per_s));
    for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
      for (std::size_t i = 0; i < std::min(last, low[j].size()); ++i) {
        mesh_square += mesh[j][i] * mesh[j][i];
        reading_square += low[j][i] * low[j][i];
      }
    }
  }
  mesh_difference_ = std::sqrt(mesh_square / reading_square);
  solver_sd_ = std::max(kSolverFloor, 2.0 * mesh_difference_);
  speed_sd_ = std::max(speed_sd_, records_.own_speed_sd);
  rebound_sd_ = std::max(rebound_sd_, filed_rebound_sd(records_));
  const Eigen::MatrixXd noise = noise_matrix();
  noise_inverse_ = symmetric_power(noise, -1.0);
  whitening_ = std::make_unique<ImpactWhitening>(
      records_, shapes, ImpactDoubts{noise, speed_sd_, rebound_sd_, solver_sd_});
  signal_energy_ = 0.0;
  for (const std::vector<double>& judged : records_.judged) {
    const Eigen::Map<const Eigen::VectorXd> y(judged.data(), noise.rows());
    signal_energy_ += y.dot(noise_inverse_ * y);
  }
}

Eigen::MatrixXd ImpactResiduals::doubt_of(const Eigen::MatrixXd& jacobian,
                                          const Eigen::MatrixXd& covariance) const {
  const Eigen::MatrixXd moves = covariance * whitening_->pulls(jacobian);
  const Eigen::VectorXd by_mesh = moves * mesh_;
  return (kSolverDoubt - 1.0) * moves * whitening_->solver() * moves.transpose() +
         by_mesh * by_mesh.transpose();
}

void ImpactResiduals::calibrate(const Composition& composition, const std::vector<double>& theta) {
  const Foretold foretold = foretell(composition, theta, executor_.first);
  // Scatter along V dm/dV, clear of arrival and offset, is the speeds'; the rest is noise.
  const auto size = static_cast<Eigen::Index>(of_gauges());
  double scatter = 0.0;
  double expected = 0.0;
  double freedom = 0.0;
  double rest = 0.0;
  double rest_freedom = 0.0;
  double rebounds = 0.0;
  for (std::size_t g = 0; g < records_.groups.size(); ++g) {
    const SpeedGroup& group = records_.groups[g];
    const auto count = static_cast<double>(group.shots.size());
    if (group.shots.size() < 2) {
      continue;
    }
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(size + 1);
    Eigen::VectorXd reading = Eigen::VectorXd::Zero(size);
    for (const std::size_t n : group.shots) {
      mean += foretold.residual[n] / count;
      reading += foretold.reading[n].head(size) / count;
    }
    // The force grows with the speed nearly in its own shape: arrivals and offsets are in `own`.
    const Eigen::MatrixXd inverse =
        symmetric_power(whitening_->own(g).topLeftCorner(size, size), -1.0);
    const Eigen::VectorXd direction = inverse * reading;
    const double information = reading.dot(direction);
    for (const std::size_t n : group.shots) {
      const Eigen::VectorXd off = foretold.residual[n] - mean;
      const double along = direction.dot(off.head(size)) / information;
      scatter += along * along;
      const Eigen::VectorXd left = off.head(size) - along * reading;
      rest += left.dot(inverse * left);
      rebounds += std::pow(off[size] / foretold.reading[n][size], 2);
    }
    expected += (count - 1.0) / information;
    freedom += count - 1.0;
    rest_freedom += (count - 1.0) * (static_cast<double>(size) - eliminated() - 1.0);
  }
  if (freedom < 1.0) {
    return;
  }
  const double scale = noise_scale_;
  noise_scale_ = scale * std::max(0.7, rest / rest_freedom);
  // Forces grow somewhat faster than speeds; what is found here is of the force.
  const double variance = std::max(0.0, (scatter - expected * noise_scale_ / scale) / freedom);
  constexpr double kForcePerSpeed = 1.15;
  speed_sd_ = std::sqrt(variance) / kForcePerSpeed;
  // Speeds that are filed wrongly scatter the rebounds as well; that is counted with the speeds.
  const double said = freedom - static_cast<double>(records_.unsaid_rebounds());
  rebound_sd_ =
      said >= 1.0 ? std::sqrt(std::max(0.0, rebounds / said - speed_sd_ * speed_sd_)) : 0.0;
  set_whitening(foretold, composition, theta);
}

}  // namespace kolsky
