#include "processing/criticism/fitting/residuals.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "processing/criticism/fitting/residual_workspace.hpp"
#include "processing/reduction/pulse.hpp"

namespace kolsky {

namespace {

/// A record's strain is that of a pulse from so many standard deviations of its noise on.
constexpr double kStandsOut = 4.0;

/// A shot as the others are on average.
ShotFacts mean_of(const std::vector<CampaignShot>& shots) {
  ShotFacts mean = shots.front().facts;
  const auto count = static_cast<double>(shots.size());
  double peak_strain = 0.0;
  double warmer_by_K = 0.0;
  for (const CampaignShot& shot : shots) {
    peak_strain += shot.facts.peak_strain / count;
    if (shot.facts.warmer_by_K) {
      warmer_by_K += *shot.facts.warmer_by_K / count;
    } else {
      mean.warmer_by_K.reset();
    }
  }
  mean.peak_strain = peak_strain;
  if (mean.warmer_by_K) {
    mean.warmer_by_K = warmer_by_K;
  }
  return mean;
}

}  // namespace

WhiteResiduals::~WhiteResiduals() = default;

WhiteResiduals::WhiteResiduals(const Campaign& campaign, double band_limit_Hz, std::size_t workers)
    : campaign_(campaign),
      band_(judged_band(campaign, band_limit_Hz)),
      noise_(campaign, band_),
      usual_(mean_of(campaign.shots)),
      jumps_(campaign.reference) {
  for (std::size_t j = 0; j < campaign.gauges(); ++j) {
    if (j != campaign.reference) {
      others_.push_back(j);
    }
  }
  for (std::size_t w = 0; w < workers; ++w) {
    work_.push_back(std::make_unique<Workspace>(campaign, band_, noise_));
  }
  for (const CampaignShot& shot : campaign.shots) {
    std::vector<Spectrum>& of_shot = spectra_.emplace_back(campaign.gauges());
    for (std::size_t j = 0; j < campaign.gauges(); ++j) {
      work_.front()->transforms.carry(shot.strain[j], of_shot[j]);
    }
  }
  measure_signal();
}

const WhiteResiduals::Spectrum& WhiteResiduals::path() const {
  return work_.front()->transforms.path();
}

std::size_t WhiteResiduals::per_shot() const {
  return 2 * band_.bins_judged * others_.size();
}

double WhiteResiduals::judged_period_s() const {
  return campaign_.period_s * static_cast<double>(band_.decimation);
}

double WhiteResiduals::judged_start_s(std::size_t shot) const {
  return static_cast<double>(band_.begin) * campaign_.period_s - campaign_.shots[shot].foot_s;
}

WhiteResiduals::Ratios WhiteResiduals::ratios_of(const Scene& scene) const {
  const std::size_t reference = campaign_.reference;
  Ratios ratios{transfers_of(scene, reference), {}};
  Spectrum& own = ratios.reading[reference];
  if (scene.gauges[reference].length_m > 0.0) {
    for (std::size_t k = 0; k < band_.bins_carried; ++k) {
      ratios.mean.push_back(mean_over_length(scene, reference, k));
    }
  }
  for (std::size_t k = 0; k < band_.bins_carried; ++k) {
    const Complex mean = ratios.mean_at(k);
    const Complex seen = own[k] / mean;
    for (const std::size_t j : others_) {
      ratios.reading[j][k] /= seen;
    }
    own[k] = seen * invertible(mean);
  }
  return ratios;
}

/// What of the reference gauge's noise the other gauges' residuals hold, at the judged bins; then,
/// what the mean over a long reference gauge would hold of it; last, where that or what others
/// share of it asks for it, all of it.
void WhiteResiduals::carry_noise(Workspace& work, const Ratios& ratios) const {
  std::vector<const Spectrum*> filters;
  for (const std::size_t j : others_) {
    filters.push_back(&ratios.reading[j]);
  }
  const Spectrum all_of_it(band_.bins_carried, 1.0);
  if (!ratios.mean.empty()) {
    filters.push_back(&ratios.mean);
  }
  if (!ratios.mean.empty() || noise_.shared_with(campaign_.reference)) {
    filters.push_back(&all_of_it);
  }
  work.responses.resize(filters.size());
  for (std::size_t i = 0; i < filters.size(); ++i) {
    work.transforms.respond(*filters[i], work.responses[i]);
  }
  noise_.carry(work.responses, work.carried_noise, work.bins);
  for (std::size_t k = 0; k < work.bins.size(); ++k) {
    const double passes = work.transforms.passes(k);
    work.bins[k].power /= passes * passes;
    work.bins[k].ratio /= passes;
  }
}

/// Scene and transfers of a shot under what acts on waves, unless they are known.
void WhiteResiduals::know_waves(Workspace& work, const Composition& composition,
                                std::vector<AppliedEffect> effects, std::size_t shot) const {
  const bool same_shot = work.shot && (*work.shot == shot || !composition.differs_by_shot());
  if (work.scene && same_shot && work.on_waves == effects) {
    return;
  }
  work.scene.emplace(campaign_.bench, campaign_.shots[shot].facts, path());
  shape(effects, *work.scene);
  work.ratios = ratios_of(*work.scene);
  work.on_waves = std::move(effects);
  work.shot = shot;
}

/// The ratios by which noise is carried: of a shot as the others are on average.
WhiteResiduals::Ratios WhiteResiduals::usual_ratios(
    Workspace& work, const Composition& composition,
    const std::vector<AppliedEffect>& effects) const {
  if (!composition.differs_by_shot()) {
    know_waves(work, composition, effects, 0);
    return work.ratios;
  }
  Scene scene(campaign_.bench, usual_, path());
  shape(effects, scene);
  return ratios_of(scene);
}

/// What whitens residuals under these effects, unless it is known.
void WhiteResiduals::know_noise(Workspace& work, const Composition& composition,
                                const std::vector<AppliedEffect>& effects) const {
  if (work.on_noise == effects) {
    return;
  }
  carry_noise(work, usual_ratios(work, composition, effects));
  work.whitener.know(work.bins);
  work.jumps.know(noise_, work.whitener, work.bins);
  work.on_noise = effects;
}

Eigen::VectorXd WhiteResiduals::evaluate(const Composition& composition,
                                         const std::vector<double>& theta, std::size_t worker) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(size()));
  evaluate_shots(composition, theta, 0, campaign_.shots.size(), worker, out.data());
  return out;
}

Eigen::VectorXd WhiteResiduals::evaluate_shot(const Composition& composition,
                                              const std::vector<double>& theta, std::size_t shot,
                                              std::size_t worker) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(per_shot()));
  evaluate_shots(composition, theta, shot, shot + 1, worker, out.data());
  return out;
}

Eigen::VectorXd WhiteResiduals::evaluate_in_noise_of(const Composition& known,
                                                     const std::vector<double>& known_theta,
                                                     const Composition& composition,
                                                     const std::vector<double>& theta,
                                                     std::size_t worker) {
  know_noise(*work_[worker], known, StagedEffects(known, known_theta, 0).on_waves);
  Eigen::VectorXd out(static_cast<Eigen::Index>(size()));
  whiten_shots(composition, theta, 0, campaign_.shots.size(), worker, out.data());
  return out;
}

Eigen::VectorXd WhiteResiduals::evaluate_shot_in_noise_of(const Composition& known,
                                                          const std::vector<double>& known_theta,
                                                          const Composition& composition,
                                                          const std::vector<double>& theta,
                                                          std::size_t shot, std::size_t worker) {
  know_noise(*work_[worker], known, StagedEffects(known, known_theta, 0).on_waves);
  Eigen::VectorXd out(static_cast<Eigen::Index>(per_shot()));
  whiten_shots(composition, theta, shot, shot + 1, worker, out.data());
  return out;
}

void WhiteResiduals::evaluate_shots(const Composition& composition,
                                    const std::vector<double>& theta, std::size_t first,
                                    std::size_t end, std::size_t worker, double* next) {
  know_noise(*work_[worker], composition, StagedEffects(composition, theta, 0).on_waves);
  whiten_shots(composition, theta, first, end, worker, next);
}

/// With the noise as known.
void WhiteResiduals::whiten_shots(const Composition& composition, const std::vector<double>& theta,
                                  std::size_t first, std::size_t end, std::size_t worker,
                                  double* next) {
  Workspace& work = *work_[worker];
  for (std::size_t n = first; n < end; ++n) {
    find_residuals(work, composition, theta, n);
    whiten_shot(work, next);
  }
}

/// What is in `work.residuals`, with the noise as known there.
void WhiteResiduals::whiten_shot(Workspace& work, double*& next) const {
  const std::span<double> shot{next, per_shot()};
  const auto rows = static_cast<Eigen::Index>(others_.size());
  Eigen::VectorXcd r(rows);
  Eigen::VectorXcd white(rows);
  work.rows.resize(others_.size());
  for (std::size_t i = 0; i < others_.size(); ++i) {
    work.transforms.judge(work.residuals[i], work.rows[i]);
  }
  for (std::size_t k = 0; k < band_.bins_judged; ++k) {
    for (Eigen::Index i = 0; i < rows; ++i) {
      r[i] = work.rows[static_cast<std::size_t>(i)][k];
    }
    white.noalias() = work.whitener.factor(k).lazyProduct(r);
    for (Eigen::Index i = 0; i < rows; ++i) {
      *next++ = white[i].real();
      *next++ = white[i].imag();
    }
  }
  work.jumps.take_out(shot);
}

double WhiteResiduals::taken_by_noise(const Composition& composition,
                                      const std::vector<double>& theta, std::size_t worker) {
  Workspace& work = *work_[worker];
  const StagedEffects effects(composition, theta, 0);
  // Only a reference gauge that has a length is blind anywhere.
  if (work.on_noise != effects.on_waves &&
      usual_ratios(work, composition, effects.on_waves).mean.empty()) {
    return 0.0;
  }
  know_noise(work, composition, effects.on_waves);
  // Real and imaginary parts of unit variance each.
  return 2.0 * work.whitener.leaked() * static_cast<double>(campaign_.shots.size());
}

/// Undoes what effects say was done to the records after the strain was sensed.
void WhiteResiduals::shape_records(Workspace& work, const std::vector<AppliedEffect>& effects,
                                   std::size_t of_shot) const {
  const CampaignShot& shot = campaign_.shots[of_shot];
  Scene& scene = *work.scene;
  scene.facts = &shot.facts;
  RecordScene& record = scene.record;
  record = RecordScene{};
  record.additions.resize(campaign_.gauges());
  for (const AppliedEffect& effect : effects) {
    effect.effect->apply(scene, effect.values, effect.gauge);
  }
  work.records.resize(campaign_.gauges());
  for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
    work.shaped = shot.strain[j];
    const auto& addition = record.additions[j];
    if (!addition.empty()) {
      const double before = quiet_before(addition, shot.quiet_samples).baseline;
      for (std::size_t n = 0; n < work.shaped.size(); ++n) {
        work.shaped[n] -= addition[n] - before;
      }
    }
    if (record.bends(j)) {
      // What was bent follows from the reading without its noise: bent straight with the signal,
      // noise would shrink under every b > 0, and any record would ask for some.
      std::vector<double> read = work.shaped;
      const std::span<const double> noise = own_noise(of_shot, j);
      for (std::size_t n = 0; n < noise.size(); ++n) {
        read[band_.begin + n] -= noise[n];
      }
      work.transforms.smooth(read);
      std::vector<double> straight = read;
      record.straighten(j, straight);
      for (std::size_t n = 0; n < read.size(); ++n) {
        work.shaped[n] -= read[n] - straight[n];
      }
    }
    work.transforms.carry(work.shaped, work.records[j]);
  }
}

/// By what the specimen departs from its linear law, in the scene that is known. It departs by
/// the wave, not by its noise, which the others' residuals have as a linear specimen carries it: a
/// law that lets less of it through would gain by that.
const WhiteResiduals::Spectrum& WhiteResiduals::departure_of(Workspace& work, Spectrum source,
                                                             std::size_t shot) const {
  for (std::size_t k = 0; k < source.size() && !source_noise_.empty(); ++k) {
    source[k] -= source_noise_[shot][k];
  }
  if (const Spectrum* known = work.departures.find(shot, work.on_waves, source)) {
    return *known;
  }
  work.response.solve(*work.scene, work.ratios, campaign_.reference, source,
                      work.transforms.filter(), work.transforms.decimated());
  work.departures.keep(shot, work.on_waves, source, work.response.q());
  return work.response.q();
}

/// One shot's residuals by other gauge, at the carried bins.
void WhiteResiduals::find_residuals(Workspace& work, const Composition& composition,
                                    const std::vector<double>& theta, std::size_t shot) const {
  const std::size_t reference = campaign_.reference;
  StagedEffects effects(composition, theta, shot);
  know_waves(work, composition, std::move(effects.on_waves), shot);
  const Scene& scene = *work.scene;
  const Ratios& ratios = work.ratios;
  const std::vector<Spectrum>* records = &spectra_[shot];
  if (!effects.on_records.empty()) {
    shape_records(work, effects.on_records, shot);
    records = &work.records;
  }
  subtract(work, *records);
  if (!scene.specimen || !scene.specimen->nonlinear()) {
    return;
  }
  // Of the reference record, what the specimen's further strain q has sent there goes first.
  const Spectrum& q = departure_of(work, (*records)[reference], shot);
  const Spectrum& filter = work.transforms.filter();
  for (std::size_t i = 0; i < others_.size(); ++i) {
    const std::size_t j = others_[i];
    for (std::size_t k = 0; k < band_.bins_carried; ++k) {
      work.residuals[i][k] -= (ratios.mean_at(k) * ratios.reading_of_q[j][k] -
                               ratios.reading[j][k] * ratios.reading_of_q[reference][k]) *
                              filter[k] * q[k];
    }
  }
}

/// The other gauges' records less what the reference's makes of them, in the scene that is known.
void WhiteResiduals::subtract(Workspace& work, const std::vector<Spectrum>& records) const {
  const Ratios& ratios = work.ratios;
  const Spectrum& source = records[campaign_.reference];
  work.residuals.resize(others_.size());
  for (std::size_t i = 0; i < others_.size(); ++i) {
    const std::size_t j = others_[i];
    Spectrum& residual = work.residuals[i];
    residual.resize(band_.bins_carried);
    for (std::size_t k = 0; k < band_.bins_carried; ++k) {
      residual[k] = ratios.mean_at(k) * records[j][k] - ratios.reading[j][k] * source[k];
    }
  }
}

Eigen::VectorXd WhiteResiduals::whiten_records(const Composition& composition,
                                               const std::vector<double>& theta,
                                               std::span<const std::vector<double>> records,
                                               std::size_t worker) {
  Workspace& work = *work_[worker];
  const StagedEffects effects(composition, theta, 0);
  know_noise(work, composition, effects.on_waves);
  know_waves(work, composition, effects.on_waves, 0);
  std::vector<Spectrum> spectra(records.size());
  for (std::size_t j = 0; j < records.size(); ++j) {
    work.transforms.carry(records[j], spectra[j]);
  }
  subtract(work, spectra);
  Eigen::VectorXd white(static_cast<Eigen::Index>(per_shot()));
  double* next = white.data();
  whiten_shot(work, next);
  return white;
}

std::vector<std::vector<double>> WhiteResiduals::plain_of_records(
    const Composition& composition, const std::vector<double>& theta,
    std::span<const std::vector<double>> records, std::size_t shot) {
  Workspace& work = *work_.front();
  know_waves(work, composition, StagedEffects(composition, theta, shot).on_waves, shot);
  std::vector<Spectrum> spectra(records.size());
  for (std::size_t j = 0; j < records.size(); ++j) {
    work.transforms.carry(records[j], spectra[j]);
  }
  subtract(work, spectra);
  std::vector<std::vector<double>> plain;
  for (const Spectrum& residual : work.residuals) {
    const std::span<const double> window = work.transforms.window_of(residual);
    plain.emplace_back(window.begin(), window.end());
  }
  return plain;
}

Eigen::VectorXd WhiteResiduals::whiten_pulses(const Composition& composition,
                                              const std::vector<double>& theta,
                                              std::size_t worker) {
  Workspace& work = *work_[worker];
  Eigen::VectorXd white(static_cast<Eigen::Index>(size()));
  for (std::size_t n = 0; n < campaign_.shots.size(); ++n) {
    const CampaignShot& shot = campaign_.shots[n];
    std::vector<std::vector<double>> pulses = shot.strain;
    for (std::vector<double>& record : pulses) {
      work.transforms.smooth(record);
      const double least = kStandsOut * quiet_before(record, shot.quiet_samples).noise_rms;
      std::ranges::replace_if(
          record, [&](double strain) { return std::abs(strain) < least; }, 0.0);
    }
    const auto at = static_cast<Eigen::Index>(n * per_shot());
    white.segment(at, static_cast<Eigen::Index>(per_shot())) =
        whiten_records(composition, theta, pulses, worker);
  }
  return white;
}

bool WhiteResiduals::only_carries(const Composition& composition,
                                  const std::vector<double>& theta) const {
  if (composition.changes_records() || composition.differs_by_shot()) {
    return false;
  }
  Scene scene(campaign_.bench, campaign_.shots.front().facts, path());
  shape(composition.applied(theta, 0), scene);
  return !scene.specimen || !scene.specimen->nonlinear();
}

PlainResiduals WhiteResiduals::plain(const Composition& composition,
                                     const std::vector<double>& theta) {
  Workspace& work = *work_.front();
  know_noise(work, composition, StagedEffects(composition, theta, 0).on_waves);
  PlainResiduals plain;
  plain.before = band_.begin / band_.decimation;
  plain.responses = work.responses;
  if (plain.responses.size() == others_.size() + 1) {
    plain.responses.pop_back();
  }
  for (std::size_t n = 0; n < campaign_.shots.size(); ++n) {
    find_residuals(work, composition, theta, n);
    auto& of_shot = plain.records.emplace_back();
    for (const Spectrum& residual : work.residuals) {
      const std::span<const double> window = work.transforms.window_of(residual);
      of_shot.emplace_back(window.begin(), window.end());
    }
  }
  return plain;
}

}  // namespace kolsky
