#include "processing/criticism/impact/impact_residuals.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "processing/criticism/impact/fine_grid.hpp"
#include "processing/impact/filter.hpp"
#include "processing/models/physics.hpp"

namespace kolsky {

namespace {

double mean_of_first(const std::vector<double>& values, std::size_t count) {
  const std::size_t most = std::min(count, values.size());
  return most == 0
             ? 0.0
             : std::accumulate(values.begin(), values.begin() + static_cast<long>(most), 0.0) /
                   static_cast<double>(most);
}

}  // namespace

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

/// A shot's record as gauges sensed it, less what effects add to it. The level before the pulse has
/// been taken off the record, and with it what they add there.
Eigen::VectorXd ImpactResiduals::measured(std::size_t shot, const RecordScene& record) const {
  const std::size_t samples = records_.window.samples;
  Eigen::VectorXd out = Eigen::Map<const Eigen::VectorXd>(records_.judged[shot].data(),
                                                          static_cast<Eigen::Index>(of_gauges()));
  for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
    const std::vector<double>& added = record.additions[j];
    const double level = mean_of_first(added, campaign_.shots[shot].quiet_samples);
    for (std::size_t k = 0; k < samples && !added.empty(); ++k) {
      const double place = records_.judged_s(shot, j, k) / campaign_.period_s;
      const auto i = std::min(static_cast<std::size_t>(std::lround(place)), added.size() - 1);
      out[static_cast<Eigen::Index>(j * samples + k)] -= added[i] - level;
    }
  }
  return out;
}

}  // namespace kolsky
