#include "processing/criticism/search/slow_waves.hpp"

#include <numbers>

#include "processing/reduction/pulse.hpp"

namespace kolsky {

SlowWaves slow_waves(const Studied& base, Study& study) {
  constexpr std::size_t kPerBin = 4;
  constexpr std::size_t kBins = 16;  ///< what is beyond the lowest leaks into them, too
  WhiteResiduals& residuals = study.residuals();
  const CampaignShot& shot = study.campaign().shots.front();
  const std::size_t gauges = study.campaign().gauges();
  SlowWaves out;
  out.bin_width_Hz = residuals.band().bin_width_Hz;
  for (std::size_t q = 1; q <= kPerBin * kBins; ++q) {
    out.frequency.push_back(static_cast<double>(q) / static_cast<double>(kPerBin));
  }
  const std::size_t count = out.frequency.size();
  const auto rows = static_cast<Eigen::Index>(residuals.per_shot());
  out.at.assign(gauges, std::vector<Eigen::MatrixXd>(count, Eigen::MatrixXd(rows, 2)));
  study.executor().run(count * gauges, [&](std::size_t i, std::size_t worker) {
    const std::size_t j = i / count;
    const std::size_t q = i % count;
    std::vector<std::vector<double>> records(gauges,
                                             std::vector<double>(shot.strain[j].size(), 0.0));
    for (const int part : {0, 1}) {
      records[j] = wave_of(out, shot, q, part);
      out.at[j][q].col(part) =
          residuals.whiten_records(base.composition, base.fit.theta, records, worker);
    }
  });
  return out;
}

std::vector<double> wave_of(const SlowWaves& waves, const CampaignShot& shot, std::size_t frequency,
                            int part) {
  const double w = 2.0 * std::numbers::pi * waves.frequency[frequency] * waves.bin_width_Hz;
  std::vector<double> record;
  for (const double t : shot.facts.time_s) {
    record.push_back(std::cos(w * t - 0.5 * std::numbers::pi * part));
  }
  const double baseline = quiet_before(record, shot.quiet_samples).baseline;
  for (double& value : record) {
    value -= baseline;
  }
  return record;
}

std::vector<SmoothPower> spectra_of_waves(const WhiteResiduals& residuals) {
  std::vector<SmoothPower> list;
  for (std::size_t j = 0; j < residuals.campaign().gauges(); ++j) {
    std::vector<double> power;
    for (std::size_t k = 0; k < residuals.band().bins_judged; ++k) {
      power.push_back(residuals.noise().power(j, k));
    }
    // A wave of unit amplitude has this power at its bin: it stands for those up to the next.
    const auto judged = static_cast<double>(residuals.band().judged);
    const double unit = 2.0 * power.back() / (judged * judged);
    const double last = power.back();
    for (double& value : power) {
      value /= last;
    }
    const SmoothPower smooth = smooth_power(power);
    list.push_back({unit * smooth.white, unit * smooth.pink, unit * smooth.walk});
  }
  return list;
}

}  // namespace kolsky
