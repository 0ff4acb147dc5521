#include "tests/generators/specimen_repeats.hpp"

#include <algorithm>
#include <functional>
#include <random>

#include "tests/generators/elastic_shpb.hpp"

namespace kolsky::testing {

namespace {

constexpr int kBits = 16;
constexpr double kRange = 0.005;

}  // namespace

SpecimenRepeats::SpecimenRepeats(const LinearShpb& model, const Filed& filed, std::size_t shots,
                                 double noise_rms, NoiseColour colour)
    : model_(model),
      filed_(filed),
      shots_(shots),
      noise_rms_(noise_rms),
      colour_(colour),
      records_(model.solve()) {}

Shot SpecimenRepeats::shot_of(const Bench& bench, unsigned seed) const {
  if (colour_ == NoiseColour::white) {
    return digitise(bench, records_, noise_rms_, kBits, kRange, seed);
  }
  std::mt19937_64 random(seed);
  std::vector<std::vector<double>> records = records_;
  for (std::vector<double>& record : records) {
    const std::vector<double> drawn =
        noise(colour_, noise_rms_, 1.0 / bench.sampling_frequency_Hz, record.size(), random);
    std::ranges::transform(record, drawn, record.begin(), std::plus{});
  }
  return digitise(bench, records, 0.0, kBits, kRange, seed);
}

SpecimenFit SpecimenRepeats::fit(unsigned repeat, const SpecimenFitOptions& options) const {
  std::mt19937 random(repeat * 7919U + 1U);
  std::normal_distribution<double> normal(0.0, 1.0);
  Bench bench = model_.bench();
  for (Gauge& gauge : bench.gauges) {
    gauge.strain_per_V = Measured{1.0 + filed_.gain_sd * normal(random), filed_.gain_sd};
    gauge.unit = "V";
    gauge.position_m = {gauge.position_m + filed_.position_m_sd * normal(random),
                        filed_.position_m_sd};
  }
  const double length_m = model_.specimen_length_m;
  bench.specimen->length_m = {length_m * (1.0 + filed_.specimen_length_sd * normal(random)),
                              length_m * filed_.specimen_length_sd};
  Material bars = paper_pmma();
  const auto misfile = [&](Measured& number, double truth, double relative_sd) {
    number = {truth * (1.0 + relative_sd * normal(random)), truth * relative_sd};
  };
  misfile(bars.E1_Pa(), model_.input.E1_Pa, filed_.bars_sd[0]);
  misfile(bars.E2_Pa(), model_.input.E2_Pa, filed_.bars_sd[1]);
  misfile(bars.eta2_Pa_s(), model_.input.eta2_Pa_s, filed_.bars_sd[2]);
  std::vector<Shot> shots;
  for (unsigned i = 0; i < shots_; ++i) {
    const auto seed = static_cast<unsigned>(random());
    shots.push_back(shot_of(bench, seed));
  }
  return fit_specimen(shots, BarPrior(bars), options);
}

std::array<double, 3> SpecimenRepeats::deviations(const SpecimenFit& fit) const {
  const std::array<double, 3> truth = {model_.specimen.E1_Pa, model_.specimen.E2_Pa,
                                       model_.specimen.eta2_Pa_s};
  std::array<double, 3> list{};
  for (std::size_t i = 0; i < list.size(); ++i) {
    list[i] = (fit.parameters[i].value - truth[i]) / fit.parameters[i].sd;
  }
  return list;
}

}  // namespace kolsky::testing
