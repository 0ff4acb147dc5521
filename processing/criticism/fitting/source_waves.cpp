#include "processing/criticism/fitting/source_waves.hpp"

#include <cmath>
#include <numbers>
#include <span>

#include "processing/models/transfers.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

namespace {

constexpr double kBeyond = 2.0;    ///< smoothing sets in so far above the judged band
constexpr double kGate_s = 10e-6;  ///< before the foot, over which the wave sets in

/// A Gaussian of frequency, made flat to sixth order: what is sent through a model must be whole in
/// the judged band. Its transform holds for complex s as it stands.
Complex smoothing(Complex s) {
  const Complex x = 0.5 * s * s;
  return std::exp(x) * (1.0 - x + 0.5 * x * x);
}

/// What smoothing sends ahead of a record's start comes back at the transform's end, grown by the
/// damping: it must not be the record's.
std::size_t padded(std::size_t samples) {
  return samples + samples / 4;
}

/// Zero until a little before the foot.
double gate(double time_s) {
  if (time_s >= 0.0) {
    return 1.0;
  }
  const double place = 1.0 + time_s / kGate_s;
  return place <= 0.0 ? 0.0 : 0.5 * (1.0 - std::cos(std::numbers::pi * place));
}

std::vector<Complex> path_of(const DampedTransform& transform) {
  std::vector<Complex> path;
  for (std::size_t k = 0; k < transform.bins(); ++k) {
    path.push_back(transform.s(k));
  }
  return path;
}

std::vector<Complex> spectrum_of(DampedTransform& transform, const std::vector<double>& record) {
  std::vector<Complex> spectrum(transform.bins());
  transform.forward(record, spectrum);
  return spectrum;
}

Scene shaped(const Campaign& campaign, const Composition& composition,
             const std::vector<double>& theta, std::size_t shot, std::span<const Complex> path) {
  Scene scene(campaign.bench, campaign.shots[shot].facts, path);
  shape(composition.applied(theta, shot), scene);
  return scene;
}

}  // namespace

SourceWaves source_waves(Study& study, const Studied& studied) {
  const Campaign& campaign = study.campaign();
  const double smoothing_rad_per_s =
      kBeyond * 2.0 * std::numbers::pi * study.residuals().band().limit_Hz;
  SourceWaves waves{{}, campaign.period_s};
  for (std::size_t n = 0; n < campaign.shots.size(); ++n) {
    std::vector<double> record = campaign.shots[n].strain[campaign.reference];
    for (std::size_t i = 0; i < record.size(); ++i) {
      record[i] *= gate(campaign.shots[n].facts.time_s[i]);
    }
    DampedTransform transform(padded(record.size()), campaign.period_s);
    auto spectrum = spectrum_of(transform, record);
    const std::vector<Complex> path = path_of(transform);
    const Scene scene = shaped(campaign, studied.composition, studied.fit.theta, n, path);
    const Transfers transfers = transfers_of(scene, campaign.reference);
    for (std::size_t k = 0; k < spectrum.size(); ++k) {
      const Complex mean = mean_over_length(scene, campaign.reference, k);
      spectrum[k] *= smoothing(path[k] / smoothing_rad_per_s) /
                     (transfers.reading[campaign.reference][k] / mean * invertible(mean));
    }
    std::vector<double> wave(record.size());
    transform.inverse(spectrum, wave);
    waves.by_shot.push_back(std::move(wave));
  }
  return waves;
}

std::vector<std::vector<double>> readings_of(const std::vector<double>& wave,
                                             const Campaign& campaign,
                                             const Composition& composition,
                                             const std::vector<double>& theta, std::size_t shot) {
  DampedTransform transform(padded(wave.size()), campaign.period_s);
  const std::vector<Complex> path = path_of(transform);
  const Scene scene = shaped(campaign, composition, theta, shot, path);
  const Transfers transfers = transfers_of(scene, campaign.reference);
  const auto source = spectrum_of(transform, wave);
  std::vector<std::vector<double>> readings;
  std::vector<Complex> spectrum(source.size());
  for (std::size_t j = 0; j < campaign.gauges(); ++j) {
    for (std::size_t k = 0; k < source.size(); ++k) {
      spectrum[k] = transfers.reading[j][k] * source[k];
    }
    std::vector<double> reading(wave.size());
    transform.inverse(spectrum, reading);
    const std::vector<double>& addition = scene.record.additions[j];
    for (std::size_t i = 0; i < reading.size(); ++i) {
      const double strain = reading[i];
      reading[i] *= 1.0 + scene.record.bridge_b * strain + scene.record.bridge_c * strain * strain;
      reading[i] += addition.empty() ? 0.0 : addition[i];
    }
    readings.push_back(std::move(reading));
  }
  return readings;
}

}  // namespace kolsky
