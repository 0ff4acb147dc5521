#include "processing/criticism/verdict/wander.hpp"

#include <algorithm>

#include "processing/models/scene.hpp"

namespace kolsky {

namespace {

/// A gauge's signal where it stands out of its noise: elsewhere it is noise, which a distortion
/// that grows in time would make the most of where no pulse is.
std::vector<double> standing_out(std::vector<double> signal, const CampaignShot& shot,
                                 std::size_t gauge) {
  // Deviations of the quiet's noise. With fewer, noise of twice the quiet's deviation in 4000
  // samples makes up a direction of its own, sqrt(4000) 2^3 / kOut^2 deviations strong, along which
  // it finds itself.
  constexpr double kOut = 16.0;
  double power = 0.0;
  for (std::size_t n = 0; n < shot.quiet_samples; ++n) {
    power += shot.strain[gauge][n] * shot.strain[gauge][n];
  }
  power *= kOut * kOut / static_cast<double>(std::max<std::size_t>(1, shot.quiet_samples));
  for (double& value : signal) {
    const double square = value * value;
    value *= square > 0.0 ? square / (square + power) : 0.0;
  }
  return signal;
}

}  // namespace

Wander::Wander(WhiteResiduals& residuals)
    : Effect({
          .id = "wander",
          .stage = Stage::record,
          .definition = "reading x (1 + a u + b u^2) + d reading/dt (c u + d u^2), u = t / record",
          .reference = "",
          .kinds = {BenchKind::bar, BenchKind::shpb},
          .parameters = {{"gain", "-", 0.0, -1.0, 1.0, 1e-3, {}},
                         {"gain_square", "-", 0.0, -1.0, 1.0, 1e-3, {}},
                         {"clock", "s", 0.0, -1e-4, 1e-4, 1e-7, {}},
                         {"clock_square", "s", 0.0, -1e-4, 1e-4, 1e-7, {}}},
          .per_gauge = true,
          .base = true,
      }),
      period_s_(residuals.campaign().period_s) {
  for (std::size_t n = 0; n < residuals.campaign().shots.size(); ++n) {
    std::vector<std::vector<double>> of_shot;
    for (std::size_t j = 0; j < residuals.campaign().gauges(); ++j) {
      of_shot.push_back(standing_out(residuals.signal(n, j), residuals.campaign().shots[n], j));
    }
    signal_.push_back(std::move(of_shot));
  }
}

void Wander::apply(Scene& scene, std::span<const double> values, std::size_t gauge) const {
  const std::vector<double>& signal = signal_[scene.facts->shot][gauge];
  const std::vector<double>& time_s = scene.facts->time_s;
  std::vector<double>& addition = scene.record.additions[gauge];
  addition.resize(signal.size());
  for (std::size_t n = 1; n + 1 < signal.size(); ++n) {
    const double u = std::max(0.0, time_s[n]) / time_s.back();
    const double rate_per_s = (signal[n + 1] - signal[n - 1]) / (2.0 * period_s_);
    addition[n] +=
        u * ((values[0] + values[1] * u) * signal[n] + (values[2] + values[3] * u) * rate_per_s);
  }
}

}  // namespace kolsky
