#include "processing/criticism/verdict/loud_pulses.hpp"

#include <algorithm>
#include <cmath>

#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/search/safeguards.hpp"

namespace kolsky {

namespace {

/// Quiet samples of all shots, as far as they tell of noise in the judged band.
double quiet_freedom(const Campaign& campaign, const JudgedBand& band) {
  double samples = 0.0;
  for (const CampaignShot& shot : campaign.shots) {
    samples += static_cast<double>(shot.quiet_samples);
  }
  return std::max(1.0, samples * 2.0 * band.limit_Hz * campaign.period_s);
}

/// Power along what an error of one gauge's readings does to the residuals of all, over noise's.
double power_at(const WhiteResiduals& residuals, const Eigen::VectorXd& white, std::size_t gauge) {
  const std::size_t shots = residuals.campaign().shots.size();
  const std::size_t bins = residuals.band().bins_judged;
  const auto others = static_cast<Eigen::Index>(residuals.others().size());
  double squares = 0.0;
  for (std::size_t k = 0; k < bins; ++k) {
    const Eigen::RowVectorXcd along =
        residuals.spread(k).row(static_cast<Eigen::Index>(gauge)).normalized();
    for (std::size_t n = 0; n < shots; ++n) {
      const std::size_t first = n * residuals.per_shot() + residuals.index(k, 0);
      Complex sum = 0.0;
      for (Eigen::Index i = 0; i < others; ++i) {
        const Eigen::Index at = static_cast<Eigen::Index>(first) + 2 * i;
        sum += along[i] * Complex(white[at], white[at + 1]);
      }
      squares += std::norm(sum);
    }
  }
  return squares / static_cast<double>(2 * shots * bins);
}

}  // namespace

std::vector<LoudPulses> loudness_of_pulses(Study& study, const Studied& studied) {
  const WhiteResiduals& residuals = study.residuals();
  const Studied quiet = study.beside_quiet(studied);
  const JudgedBand& band = residuals.band();
  const std::size_t gauges = study.campaign().gauges();
  const double freedom =
      2.0 * static_cast<double>(band.bins_judged * study.campaign().shots.size());
  std::vector<LoudPulses> list;
  for (std::size_t gauge = 0; gauge < gauges; ++gauge) {
    const double power = power_at(residuals, quiet.fit.residual, gauge);
    const double log_p = log_f_tail(power, freedom, quiet_freedom(study.campaign(), band)) +
                         std::log(static_cast<double>(gauges));
    list.push_back({gauge, power, log_p});
  }
  std::ranges::sort(list, {}, &LoudPulses::log_p);
  return list;
}

bool beyond_noise(const LoudPulses& pulses) {
  constexpr double kMuch = 1.2;
  return pulses.power > kMuch && pulses.log_p < kSure;
}

std::vector<std::size_t> loudest(const std::vector<LoudPulses>& pulses) {
  constexpr double kAsLoud = 0.5;
  std::vector<std::size_t> gauges;
  for (const LoudPulses& own : pulses) {
    if (own.power - 1.0 >= kAsLoud * (pulses.front().power - 1.0)) {
      gauges.push_back(own.gauge);
    }
  }
  return gauges;
}

}  // namespace kolsky
