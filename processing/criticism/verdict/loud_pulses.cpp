#include "processing/criticism/verdict/loud_pulses.hpp"

#include <algorithm>
#include <cmath>

#include "processing/criticism/fitting/statistics.hpp"

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

double power_at(const WhiteResiduals& residuals, const Eigen::VectorXd& white, std::size_t other) {
  const std::size_t shots = residuals.campaign().shots.size();
  const std::size_t bins = residuals.band().bins_judged;
  double squares = 0.0;
  for (std::size_t n = 0; n < shots; ++n) {
    for (std::size_t k = 0; k < bins; ++k) {
      const auto at =
          static_cast<Eigen::Index>(n * residuals.per_shot() + residuals.index(k, other));
      squares += white[at] * white[at] + white[at + 1] * white[at + 1];
    }
  }
  return squares / static_cast<double>(2 * shots * bins);
}

}  // namespace

std::vector<LoudPulses> loudness_of_pulses(Study& study, const Studied& studied) {
  const WhiteResiduals& residuals = study.residuals();
  const std::vector<std::size_t>& others = residuals.others();
  const Studied quiet = study.beside_quiet(studied);
  const JudgedBand& band = residuals.band();
  const double freedom =
      2.0 * static_cast<double>(band.bins_judged * study.campaign().shots.size());
  std::vector<LoudPulses> list;
  for (std::size_t i = 0; i < others.size(); ++i) {
    const double power = power_at(residuals, quiet.fit.residual, i);
    const double log_p = log_f_tail(power, freedom, quiet_freedom(study.campaign(), band)) +
                         std::log(static_cast<double>(others.size()));
    list.push_back({others[i], power, log_p});
  }
  std::ranges::sort(list, {}, &LoudPulses::log_p);
  return list;
}

bool beyond_noise(const LoudPulses& pulses) {
  constexpr double kSure = -11.5;  // 1e-5
  constexpr double kMuch = 1.2;
  return pulses.power > kMuch && pulses.log_p < kSure;
}

bool at_one_gauge(const std::vector<LoudPulses>& pulses) {
  constexpr double kOver = 2.0;
  return pulses.size() > 1 && beyond_noise(pulses[0]) &&
         pulses[0].power - 1.0 > kOver * std::max(0.0, pulses[1].power - 1.0);
}

}  // namespace kolsky
