#include "processing/identification/foretold_shots.hpp"

#include "processing/identification/bar_judge.hpp"

namespace kolsky {

std::vector<ForetoldShot> foretell(const std::vector<Shot>& shots, const BarFit& fit) {
  const auto solid = make_solid(fit.solid, values_of(fit.parameters));
  const BarData data(shots, fit.band_limit_Hz, {.solid = solid.get()});
  BarJudge judge(data);
  const BarModel model(data.bench(), data.records().front(), {fit.theory, fit.solid, fit.far_end});
  const auto transfers = model.transfers(fit.at, data.path(), false);
  const BarData::Places& places = data.places();
  const double period_s = data.records().front().period_s * places.samples_per_place;
  std::vector<ForetoldShot> list;
  BarData::Spectrum product(data.path().size());
  const auto judged = [&](const BarData::Spectrum& spectrum) {
    const auto record = judge.in_time(spectrum).subspan(places.judged_begin);
    return std::vector<double>(record.begin(), record.end());
  };
  for (std::size_t i = 0; i < data.shots(); ++i) {
    ForetoldShot& shot = list.emplace_back();
    shot.id = shots[i].id;
    for (std::size_t n = places.judged_begin; n < places.judged_end; ++n) {
      shot.time_s.push_back((static_cast<double>(n) - places.records_begin) * period_s);
    }
    for (std::size_t j = 1; j < data.gauges(); ++j) {
      for (std::size_t k = 0; k < product.size(); ++k) {
        product[k] = transfers.g[j - 1][k] * data.spectrum(i, 0)[k];
      }
      shot.gauges.push_back({data.bench().gauges[data.records()[i].channel[j]].name,
                             judged(data.spectrum(i, j)), judged(product)});
    }
  }
  return list;
}

}  // namespace kolsky
