#include "processing/reduction/separation_records.hpp"

#include <algorithm>

#include "processing/reduction/pulse.hpp"
#include "processing/reduction/stations.hpp"

namespace kolsky {

SeparationRecords::SeparationRecords(const Shot& shot, const std::string& bar,
                                     const std::function<std::size_t(const Gauge&)>& quiet_at)
    : least_quiet(shot.samples()) {
  const Bench& bench = shot.bench;
  for (std::size_t i = 0; i < bench.gauges.size(); ++i) {
    const Gauge& gauge = bench.gauges[i];
    if (gauge.bar != bar) {
      continue;
    }
    const std::size_t quiet = quiet_at(gauge);
    least_quiet = std::min(least_quiet, quiet);
    auto& strain = strains.emplace_back(shot.samples());
    read_station(shot, BarStation{.channels = {i}}, quiet, strain);
    noise_rms.push_back(quiet_before(strain, quiet).noise_rms);
    std::fill_n(strain.begin(), quiet, 0.0);
    gauges.push_back({.position_m = gauge.position_m, .values = {}});
    names.push_back(gauge.name);
  }
  // A converter of few bits makes no noise while nothing moves: then all count alike.
  const bool all_noisy = std::ranges::all_of(noise_rms, [](double rms) { return rms > 0.0; });
  for (std::size_t j = 0; j < gauges.size(); ++j) {
    gauges[j].values = strains[j];
    gauges[j].noise_rms = all_noisy ? noise_rms[j] : 0.0;
  }
}

void SeparationRecords::add_end(const Bar& bar, std::span<const double> stress_Pa) {
  gauges.push_back({.position_m = bar.length_m,
                    .values = stress_Pa,
                    .noise_rms = gauges.front().noise_rms,
                    .record = SeparationRecord::mean_stress_Pa});
}

}  // namespace kolsky
