#include "processing/criticism/impact/impact_residuals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "processing/base/error.hpp"
#include "processing/criticism/impact/fine_grid.hpp"

namespace kolsky {

namespace {

constexpr double kSettled_s = 1e-11;

}  // namespace

ImpactResiduals::ImpactResiduals(const Campaign& campaign, JudgedStretch stretch, double cutoff_Hz,
                                 const Workers& executor, const BallMeshes& meshes,
                                 std::shared_ptr<BallRuns> runs)
    : campaign_(campaign),
      executor_(executor),
      meshes_(meshes),
      records_(read_impact_records(campaign, stretch, cutoff_Hz)),
      runs_(runs ? std::move(runs) : std::make_shared<BallRuns>(campaign.bench)) {
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

ImpactResiduals::Foretold ImpactResiduals::foretell(const Composition& composition,
                                                    const std::vector<double>& theta,
                                                    std::size_t worker) {
  return foretold_by(moves_, composition, theta, worker);
}

ImpactResiduals::Foretold ImpactResiduals::foretold_by(Moves mesh, const Composition& composition,
                                                       const std::vector<double>& theta,
                                                       std::size_t worker) {
  Foretold out;
  const std::size_t shots = campaign_.shots.size();
  out.reading.resize(shots);
  out.residual.resize(shots);
  out.arrival_s.resize(shots);
  out.rebound_m_per_s.resize(shots);
  std::vector<std::vector<Complex>> transfer;
  BallScene ball;
  for (std::size_t g = 0; g < records_.groups.size(); ++g) {
    const SpeedGroup& group = records_.groups[g];
    Readings readings;
    for (const std::size_t n : group.shots) {
      if (transfer.empty() || composition.differs_by_shot()) {
        transfer = transfers(composition, theta, n, ball);
      }
      const RecordScene record = record_of(composition, theta, n);
      if (readings.low.empty() || composition.differs_by_shot()) {
        try {
          readings = readings_of(mesh, ball, g, transfer, record.bridge_b, worker);
        } catch (const InputError&) {
          out.sound = false;
          return out;
        }
      }
      foretell_shot(n, readings.at(share_of(n)), measured(n, record), out);
    }
  }
  fill_unsaid_rebounds(out);
  return out;
}

ImpactResiduals::Readings ImpactResiduals::readings_of(
    Moves mesh, const BallScene& ball, std::size_t group,
    const std::vector<std::vector<Complex>>& transfer, double bridge_b, std::size_t worker) {
  const BallRun low = force(mesh, ball, group, anchors_[group].low);
  const BallRun high = force(mesh, ball, group, anchors_[group].high);
  return {recorded(read(low, transfer, worker), bridge_b),
          recorded(read(high, transfer, worker), bridge_b), low.rebound_m_per_s,
          high.rebound_m_per_s};
}

ImpactResiduals::Reading ImpactResiduals::Readings::at(double share) const {
  Reading between{low, (1.0 - share) * rebound_low + share * rebound_high};
  for (std::size_t j = 0; j < low.size(); ++j) {
    for (std::size_t i = 0; i < low[j].size(); ++i) {
      between.strain[j][i] = (1.0 - share) * low[j][i] + share * high[j][i];
    }
  }
  return between;
}

/// How far a shot's speed is from its group's lower one to the upper one.
double ImpactResiduals::share_of(std::size_t shot) const {
  const SpeedGroup& group = records_.groups[records_.group_of[shot]];
  return (*campaign_.shots[shot].facts.incident_speed_m_per_s - group.low_m_per_s) /
         (group.high_m_per_s - group.low_m_per_s);
}

void ImpactResiduals::foretell_shot(std::size_t n, const Reading& strain,
                                    const Eigen::VectorXd& record, Foretold& out) const {
  const auto size = static_cast<Eigen::Index>(of_gauges());
  Eigen::VectorXd reading(size);
  out.arrival_s[n] = aligned(n, strain, record, reading);
  out.rebound_m_per_s[n] = strain.rebound_m_per_s;
  const double rebound = strain.rebound_m_per_s / records_.wave_speed_m_per_s;
  const auto& said = records_.rebound[n];
  out.reading[n].resize(size + 1);
  out.reading[n] << reading, rebound;
  out.residual[n].resize(size + 1);
  out.residual[n] << record - reading, said ? *said - rebound : 0.0;
}

/// Moves a reading to where it fits a shot's record best, by the noise alone.
/// @return time of the first touch
double ImpactResiduals::aligned(std::size_t n, const Reading& strain, const Eigen::VectorXd& record,
                                Eigen::VectorXd& reading) const {
  constexpr int kMostSteps = 12;
  constexpr double kLongestStep_s = 20e-6;
  const std::size_t samples = records_.window.samples;
  double touch_s = touch_s_[n];
  Eigen::VectorXd slope(reading.size());
  for (int iteration = 0; iteration < kMostSteps; ++iteration) {
    for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
      for (std::size_t k = 0; k < samples; ++k) {
        const Interpolated own =
            on_fine_grid(strain.strain[j], records_.judged_s(n, j, k) - touch_s);
        reading[static_cast<Eigen::Index>(j * samples + k)] = own.value;
        slope[static_cast<Eigen::Index>(j * samples + k)] = own.slope_per_s;
      }
    }
    const Eigen::VectorXd weighted =
        noise_inverse_.size() == 0 ? slope : Eigen::VectorXd(noise_inverse_ * slope);
    const double step_s = std::clamp(-weighted.dot(record - reading) / weighted.dot(slope),
                                     -kLongestStep_s, kLongestStep_s);
    if (!std::isfinite(step_s) || std::abs(step_s) < kSettled_s) {
      break;
    }
    touch_s += step_s;
  }
  return touch_s;
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

Eigen::VectorXd ImpactResiduals::white(const Foretold& foretold) const {
  if (!foretold.sound) {
    const std::size_t all = per_shot() * campaign_.shots.size();
    return Eigen::VectorXd::Constant(static_cast<Eigen::Index>(all),
                                     std::numeric_limits<double>::quiet_NaN());
  }
  return whitening_->white(foretold.residual);
}

Eigen::VectorXd ImpactResiduals::evaluate(const Composition& composition,
                                          const std::vector<double>& theta, std::size_t worker) {
  return white(foretell(composition, theta, worker));
}

Eigen::VectorXd ImpactResiduals::evaluate_for_differences(const Composition& composition,
                                                          const std::vector<double>& theta,
                                                          std::size_t worker) {
  const Moves mesh = has_quick_differences() ? Moves::coarse : moves_;
  return white(foretold_by(mesh, composition, theta, worker));
}

/// Nearly all of it are the impacts.
Eigen::VectorXd ImpactResiduals::evaluate_on(const Workers& executor,
                                             const Composition& composition,
                                             const std::vector<double>& theta) {
  BallScene ball;
  static_cast<void>(transfers(composition, theta, 0, ball));
  run_ahead(executor, ball);
  return evaluate(composition, theta, executor.first);
}

Eigen::VectorXd ImpactResiduals::evaluate_shot(const Composition& composition,
                                               const std::vector<double>& theta, std::size_t shot,
                                               std::size_t worker) {
  const auto size = static_cast<Eigen::Index>(per_shot());
  return evaluate(composition, theta, worker).segment(static_cast<Eigen::Index>(shot) * size, size);
}

}  // namespace kolsky
