#include "processing/criticism/impact_residuals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "processing/base/error.hpp"
#include "processing/impact/filter.hpp"
#include "processing/models/physics.hpp"

namespace kolsky {

namespace {

constexpr double kBefore_s = 150e-6;       ///< of the fine grid, before the first touch
constexpr double kSolverFloor = 0.005;     ///< of the force: no mesh study sees all of it
constexpr double kRippleMemory_s = 12e-6;  ///< of a contact that grows node by node
constexpr double kSolverMemory_s = 60e-6;  ///< over which a solver's error keeps its sign
constexpr double kArrivalFree_s = 5e-6;
constexpr double kSettled_s = 1e-11;

Eigen::MatrixXd symmetric_power(const Eigen::MatrixXd& matrix, double power) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  const double least = 1e-14 * solver.eigenvalues().maxCoeff();
  return solver.eigenvectors() *
         solver.eigenvalues().cwiseMax(least).array().pow(power).matrix().asDiagonal() *
         solver.eigenvectors().transpose();
}

/// Third-order interpolation on the fine grid and its derivative by time.
struct Interpolated {
  double value = 0.0;
  double slope_per_s = 0.0;
};

Interpolated at(const std::vector<double>& grid, double time_s) {
  const double place = (time_s + kBefore_s) / kRunStep_s;
  const auto last = static_cast<double>(grid.size()) - 3.0;
  const double held = std::clamp(place, 1.0, last);
  const auto n = static_cast<std::size_t>(held);
  const double u = held - static_cast<double>(n);
  const double a = grid[n - 1];
  const double b = grid[n];
  const double c = grid[n + 1];
  const double d = grid[n + 2];
  const double c1 = c - a / 3.0 - b / 2.0 - d / 6.0;
  const double c2 = (a + c) / 2.0 - b;
  const double c3 = (d - a) / 6.0 + (b - c) / 2.0;
  return {b + u * (c1 + u * (c2 + u * c3)), (c1 + u * (2.0 * c2 + 3.0 * u * c3)) / kRunStep_s};
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
  const auto samples = static_cast<std::size_t>((judged_s + 3.0 * kBefore_s + 300e-6) / kRunStep_s);
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
  return records_.window.samples * campaign_.gauges();
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
  const auto before = static_cast<std::size_t>(std::lround(kBefore_s / kRunStep_s));
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

ImpactResiduals::Foretold ImpactResiduals::foretell(const Composition& composition,
                                                    const std::vector<double>& theta,
                                                    std::size_t worker) {
  Foretold out;
  const std::size_t gauges = campaign_.gauges();
  const std::size_t samples = records_.window.samples;
  const auto size = static_cast<Eigen::Index>(per_shot());
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
      // Memoryless maps and additions of this shot; nothing travels here.
      Scene record(campaign_.bench, campaign_.shots[n].facts, {});
      if (composition.changes_records()) {
        for (const AppliedEffect& use : composition.applied(theta, n)) {
          if (use.effect->about().stage == Stage::record) {
            use.effect->apply(record, use.values, use.gauge);
          }
        }
      }
      if (readings.low.empty() || composition.differs_by_shot()) {
        try {
          const BallRun low = force(ball, g, false);
          const BallRun high = force(ball, g, true);
          readings = {recorded(read(low, transfer, worker), record.record.bridge_b),
                      recorded(read(high, transfer, worker), record.record.bridge_b),
                      low.rebound_m_per_s, high.rebound_m_per_s};
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
      Eigen::VectorXd measured = Eigen::Map<const Eigen::VectorXd>(records_.judged[n].data(), size);
      for (std::size_t j = 0; j < gauges; ++j) {
        const std::vector<double>& added = record.record.additions[j];
        for (std::size_t k = 0; k < samples && !added.empty(); ++k) {
          const double place =
              (records_.first_s[n] + static_cast<double>(k) * records_.window.period_s) /
              campaign_.period_s;
          const auto i = std::min(static_cast<std::size_t>(std::lround(place)), added.size() - 1);
          measured[static_cast<Eigen::Index>(j * samples + k)] -= added[i];
        }
      }
      double touch_s = touch_s_[n];
      Eigen::VectorXd reading(size);
      Eigen::VectorXd slope(size);
      for (int iteration = 0; iteration < 12; ++iteration) {
        for (std::size_t j = 0; j < gauges; ++j) {
          for (std::size_t k = 0; k < samples; ++k) {
            const double time_s =
                records_.first_s[n] + static_cast<double>(k) * records_.window.period_s - touch_s;
            const Interpolated own = at(strain[j], time_s);
            reading[static_cast<Eigen::Index>(j * samples + k)] = own.value;
            slope[static_cast<Eigen::Index>(j * samples + k)] = own.slope_per_s;
          }
        }
        const Eigen::VectorXd weighted =
            whiteners_.empty() ? slope : Eigen::VectorXd(whiteners_[g].noise_inverse * slope);
        constexpr double kLongestStep_s = 20e-6;
        const double step_s = std::clamp(-weighted.dot(measured - reading) / weighted.dot(slope),
                                         -kLongestStep_s, kLongestStep_s);
        if (!std::isfinite(step_s) || std::abs(step_s) < kSettled_s) {
          break;
        }
        touch_s += step_s;
      }
      out.reading[n] = reading;
      out.residual[n] = measured - reading;
      out.arrival_s[n] = touch_s;
      out.rebound_m_per_s[n] = (1.0 - share) * readings.rebound_low + share * readings.rebound_high;
    }
  }
  return out;
}

Eigen::VectorXd ImpactResiduals::evaluate(const Composition& composition,
                                          const std::vector<double>& theta, std::size_t worker) {
  const Foretold foretold = foretell(composition, theta, worker);
  const auto size = static_cast<Eigen::Index>(per_shot());
  const auto shots = static_cast<Eigen::Index>(campaign_.shots.size());
  if (!foretold.sound) {
    return Eigen::VectorXd::Constant(size * shots, std::numeric_limits<double>::quiet_NaN());
  }
  Eigen::VectorXd white(size * shots);
  for (std::size_t g = 0; g < records_.groups.size(); ++g) {
    const SpeedGroup& group = records_.groups[g];
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(size);
    for (const std::size_t n : group.shots) {
      mean += foretold.residual[n] / static_cast<double>(group.shots.size());
    }
    const Eigen::VectorXd shared = whiteners_[g].mean_root * mean;
    for (const std::size_t n : group.shots) {
      white.segment(static_cast<Eigen::Index>(n) * size, size) =
          whiteners_[g].own_root * (foretold.residual[n] - mean) + shared;
    }
  }
  return white;
}

Eigen::VectorXd ImpactResiduals::evaluate_shot(const Composition& composition,
                                               const std::vector<double>& theta, std::size_t shot,
                                               std::size_t worker) {
  const auto size = static_cast<Eigen::Index>(per_shot());
  return evaluate(composition, theta, worker).segment(static_cast<Eigen::Index>(shot) * size, size);
}

Eigen::MatrixXd ImpactResiduals::noise_matrix() const {
  const std::size_t samples = records_.window.samples;
  Eigen::MatrixXd noise = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(per_shot()),
                                                static_cast<Eigen::Index>(per_shot()));
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

void ImpactResiduals::prepare(const Composition& composition, const std::vector<double>& theta) {
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
  anchors_.assign(records_.groups.size(), {});
  for (std::size_t g = 0; g < records_.groups.size(); ++g) {
    for (const bool high : {false, true}) {
      const BallRun fine = *run({g, high, kFineBall, false});
      const BallRun middle = *run({g, high, kMiddleBall, false});
      Anchor& anchor = anchors_[g][high ? 1 : 0];
      anchor.fine_less_coarse = sum_of(fine, -1.0, *run({g, high, kCoarseBall, false}));
      anchor.law = sum_of(*run({g, high, kMiddleBall, true}), -1.0, middle);
      anchor.mesh = sum_of(fine, -1.0, middle);
    }
  }
  const Foretold foretold = foretell(composition, theta, executor_.first);
  if (!foretold.sound) {
    throw InputError("model", "has a ball that the solver refuses", "bring its numbers nearer");
  }
  touch_s_ = foretold.arrival_s;
  set_whiteners(foretold, composition, theta);
}

void ImpactResiduals::set_whiteners(const Foretold& foretold, const Composition& composition,
                                    const std::vector<double>& theta) {
  const std::size_t gauges = campaign_.gauges();
  const std::size_t samples = records_.window.samples;
  const auto size = static_cast<Eigen::Index>(per_shot());
  BallScene ball;
  const auto transfer = transfers(composition, theta, 0, ball);
  const Eigen::MatrixXd noise = noise_matrix();
  const Eigen::MatrixXd noise_inverse = symmetric_power(noise, -1.0);
  // Twice what the mesh is seen to do, over all groups.
  std::vector<Eigen::VectorXd> strained;  // by group: mean reading
  std::vector<Eigen::VectorXd> by_speed;  // V dm/dV
  std::vector<Eigen::VectorXd> by_time;
  double mesh_square = 0.0;
  double reading_square = 0.0;
  for (std::size_t g = 0; g < records_.groups.size(); ++g) {
    const SpeedGroup& group = records_.groups[g];
    const std::size_t n = group.shots[group.shots.size() / 2];
    const auto low = recorded(read(force(ball, g, false), transfer, executor_.first), 0.0);
    const auto high = recorded(read(force(ball, g, true), transfer, executor_.first), 0.0);
    const auto mesh = recorded(read(anchors_[g][0].mesh, transfer, executor_.first), 0.0);
    Eigen::VectorXd speed(size);
    Eigen::VectorXd slope(size);
    for (std::size_t j = 0; j < gauges; ++j) {
      for (std::size_t k = 0; k < samples; ++k) {
        const auto i = static_cast<Eigen::Index>(j * samples + k);
        const double time_s = records_.first_s[n] +
                              static_cast<double>(k) * records_.window.period_s -
                              foretold.arrival_s[n];
        const Interpolated a = at(low[j], time_s);
        const Interpolated b = at(high[j], time_s);
        speed[i] =
            (b.value - a.value) / (group.high_m_per_s - group.low_m_per_s) * group.speed_m_per_s;
        slope[i] = a.slope_per_s;
        const double off = at(mesh[j], time_s).value;
        mesh_square += off * off;
        reading_square += a.value * a.value;
      }
    }
    by_speed.push_back(std::move(speed));
    by_time.push_back(std::move(slope));
    strained.push_back(foretold.reading[n]);
  }
  mesh_difference_ = std::sqrt(mesh_square / reading_square);
  solver_sd_ = std::max(kSolverFloor, 2.0 * mesh_difference_);
  double filed = 0.0;
  for (const CampaignShot& shot : campaign_.shots) {
    filed =
        std::max(filed, shot.facts.incident_speed_sd_m_per_s / *shot.facts.incident_speed_m_per_s);
  }
  speed_sd_ = std::max(speed_sd_, filed);
  whiteners_.assign(records_.groups.size(), {});
  signal_energy_ = 0.0;
  for (std::size_t g = 0; g < records_.groups.size(); ++g) {
    Whitener& w = whiteners_[g];
    w.own = noise + speed_sd_ * speed_sd_ * by_speed[g] * by_speed[g].transpose() +
            kArrivalFree_s * kArrivalFree_s * by_time[g] * by_time[g].transpose();
    w.shared = Eigen::MatrixXd::Zero(size, size);
    const double peak = strained[g].cwiseAbs().maxCoeff();
    for (std::size_t j = 0; j < gauges; ++j) {
      const auto first = static_cast<Eigen::Index>(j * samples);
      const auto count = static_cast<Eigen::Index>(samples);
      // An offset of its own: what quiet samples before the pulse leave open, and more.
      w.own.block(first, first, count, count).array() += 100.0 * noise(first, first);
    }
    for (Eigen::Index a = 0; a < size; ++a) {
      for (Eigen::Index b = 0; b < size; ++b) {
        const auto column = [&](Eigen::Index i) {
          return static_cast<double>(static_cast<std::size_t>(i) % samples);
        };
        // The same size twice: slowly varying, and from sample to sample.
        const double quick = (column(a) - column(b)) * records_.window.period_s / kRippleMemory_s;
        const double apart = (column(a) - column(b)) * records_.window.period_s / kSolverMemory_s;
        const auto size_at = [&](Eigen::Index i) {
          const double e = std::abs(strained[g][i]);
          // Where the contact is made and broken forces are small and times matter.
          return solver_sd_ * (e > 1e-3 * peak ? e + 0.05 * peak : 0.0);
        };
        w.shared(a, b) = size_at(a) * size_at(b) *
                         (std::exp(-0.5 * apart * apart) + std::exp(-0.5 * quick * quick));
      }
    }
    w.own_root = symmetric_power(w.own, -0.5);
    w.mean_root = symmetric_power(
        w.own + static_cast<double>(records_.groups[g].shots.size()) * w.shared, -0.5);
    w.noise_inverse = noise_inverse;
    for (const std::size_t n : records_.groups[g].shots) {
      const Eigen::Map<const Eigen::VectorXd> y(records_.judged[n].data(), size);
      signal_energy_ += y.dot(noise_inverse * y);
    }
  }
}

void ImpactResiduals::calibrate(const Composition& composition, const std::vector<double>& theta) {
  Foretold foretold = foretell(composition, theta, executor_.first);
  // Scatter along V dm/dV, clear of arrival and offset, is the speeds'; the rest is noise.
  BallScene ball;
  const auto transfer = transfers(composition, theta, 0, ball);
  const auto size = static_cast<Eigen::Index>(per_shot());
  double scatter = 0.0;
  double expected = 0.0;
  double freedom = 0.0;
  double rest = 0.0;
  double rest_freedom = 0.0;
  const double scale = noise_scale_;
  const double filed = speed_sd_;
  for (std::size_t g = 0; g < records_.groups.size(); ++g) {
    const SpeedGroup& group = records_.groups[g];
    const auto count = static_cast<double>(group.shots.size());
    if (group.shots.size() < 2) {
      continue;
    }
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(size);
    Eigen::VectorXd reading = Eigen::VectorXd::Zero(size);
    for (const std::size_t n : group.shots) {
      mean += foretold.residual[n] / count;
      reading += foretold.reading[n] / count;
    }
    // The force grows with the speed nearly in its own shape: arrivals and offsets are in `own`.
    const Eigen::MatrixXd inverse = symmetric_power(whiteners_[g].own, -1.0);
    const Eigen::VectorXd direction = inverse * reading;
    const double information = reading.dot(direction);
    for (const std::size_t n : group.shots) {
      const Eigen::VectorXd off = foretold.residual[n] - mean;
      const double along = direction.dot(off) / information;
      scatter += along * along;
      const Eigen::VectorXd left = off - along * reading;
      rest += left.dot(inverse * left);
    }
    expected += (count - 1.0) / information;
    freedom += count - 1.0;
    rest_freedom += (count - 1.0) * (static_cast<double>(size) - eliminated() - 1.0);
  }
  if (freedom < 1.0) {
    return;
  }
  noise_scale_ = scale * std::max(0.7, rest / rest_freedom);
  // Forces grow somewhat faster than speeds; what is found here is of the force.
  const double variance = std::max(0.0, (scatter - expected * noise_scale_ / scale) / freedom);
  constexpr double kForcePerSpeed = 1.15;
  speed_sd_ = std::max(filed, std::sqrt(variance) / kForcePerSpeed);
  set_whiteners(foretold, composition, theta);
}

}  // namespace kolsky
