#include <algorithm>

#include "processing/criticism/impact/fine_grid.hpp"
#include "processing/criticism/impact/impact_residuals.hpp"
#include "processing/impact/filter.hpp"

namespace kolsky {

namespace {

constexpr double kBeyond = 4.0;  ///< smoothed so far above the judged band

}  // namespace

ImpactResiduals::Sensed ImpactResiduals::sensed(const Composition& composition,
                                                const std::vector<double>& theta, std::size_t shot,
                                                double arrival_s, double faster,
                                                std::size_t worker) {
  BallScene ball;
  const auto transfer = transfers(composition, theta, shot, ball);
  const RecordScene record = record_of(composition, theta, shot);
  const std::size_t g = records_.group_of[shot];
  const SpeedGroup& group = records_.groups[g];
  const auto run = [&](const Anchor& anchor) {
    return sum_of(*runs_->run(ball, anchor.speed_m_per_s, meshes_.middle), ball.cauchy_share,
                  anchor.law);
  };
  const BallRun low = run(anchors_[g].low);
  const BallRun high = run(anchors_[g].high);
  const CampaignShot& own = campaign_.shots[shot];
  const double share = (*own.facts.incident_speed_m_per_s * (1.0 + faster) - group.low_m_per_s) /
                       (group.high_m_per_s - group.low_m_per_s);
  const auto slow = read(low, transfer, worker);
  const auto fast = read(high, transfer, worker);
  Sensed out;
  out.rebound_m_per_s = (1.0 - share) * low.rebound_m_per_s + share * high.rebound_m_per_s;
  for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
    std::vector<double> fine(slow[j].size());
    for (std::size_t i = 0; i < fine.size(); ++i) {
      const double strain = (1.0 - share) * slow[j][i] + share * fast[j][i];
      fine[i] = strain * (1.0 + record.bridge_b * strain);
    }
    fine = impact::low_passed(fine, kRunStep_s, kBeyond * records_.window.cutoff_Hz);
    std::vector<double> strain(own.strain[j].size());
    const std::vector<double>& added = record.additions[j];
    for (std::size_t i = 0; i < strain.size(); ++i) {
      const double time_s = static_cast<double>(i) * campaign_.period_s - arrival_s;
      strain[i] = on_fine_grid(fine, time_s).value + (i < added.size() ? added[i] : 0.0);
    }
    out.strain.push_back(std::move(strain));
  }
  return out;
}

}  // namespace kolsky
