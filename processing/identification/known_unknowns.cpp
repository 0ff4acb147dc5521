#include "processing/identification/known_unknowns.hpp"

#include <cmath>

namespace kolsky {

std::vector<KnownUnknown> known_unknowns(const Bench& bench, const BarRecords& records) {
  using Of = KnownUnknown::Of;
  std::vector<KnownUnknown> list;
  for (std::size_t j = 0; j < records.channel.size(); ++j) {
    const Gauge& gauge = bench.gauges[records.channel[j]];
    if (const double sd = records.returned ? 0.0 : gain_sd(gauge); sd > 0.0) {
      list.push_back({"gauge-factor:" + gauge.name, Of::gain, j, sd});
    }
    if (gauge.position_m.sd > 0.0) {
      list.push_back({"gauge-position:" + gauge.name, Of::position, j, gauge.position_m.sd});
    }
    if (gauge.delay_s.sd > 0.0 && !records.returned) {
      list.push_back({"channel-delay:" + gauge.name, Of::delay, j, gauge.delay_s.sd});
    }
  }
  if (bench.input.length_m.sd > 0.0) {
    list.push_back({"bar-length", Of::length, 0, bench.input.length_m.sd});
  }
  if (bench.input.density_kg_m3.sd > 0.0) {
    list.push_back({"density", Of::density, 0, relative_sd(bench.input.density_kg_m3)});
  }
  if (bench.input.diameter_m.sd > 0.0) {
    list.push_back({"diameter", Of::diameter, 0, relative_sd(bench.input.diameter_m)});
  }
  if (bench.input.poisson_ratio.sd > 0.0) {
    list.push_back({"poisson-ratio", Of::poisson_ratio, 0, relative_sd(bench.input.poisson_ratio)});
  }
  return list;
}

MovedBench::MovedBench(const Bar& filed, const BarRecords& records,
                       const std::vector<KnownUnknown>& unknowns, std::span<const double> moves)
    : bar(filed),
      position_m(records.position_m),
      gain(records.position_m.size(), 1.0),
      delay_s(records.position_m.size(), 0.0) {
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    const KnownUnknown& u = unknowns[i];
    const double move = moves[i] * u.sd;
    switch (u.of) {
      case KnownUnknown::Of::gain:
        gain[u.gauge] *= 1.0 + move;
        break;
      case KnownUnknown::Of::position:
        position_m[u.gauge] += move;
        break;
      case KnownUnknown::Of::delay:
        delay_s[u.gauge] += move;
        break;
      case KnownUnknown::Of::length:
        bar.length_m.value += move;
        break;
      case KnownUnknown::Of::density:
        bar.density_kg_m3.value *= 1.0 + move;
        break;
      case KnownUnknown::Of::diameter:
        bar.diameter_m.value *= 1.0 + move;
        if (bar.side_m) {
          bar.side_m->value *= 1.0 + move;
        }
        break;
      case KnownUnknown::Of::poisson_ratio:
        bar.poisson_ratio.value *= 1.0 + move;
        break;
    }
  }
}

}  // namespace kolsky
