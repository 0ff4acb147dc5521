#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "processing/criticism/fitting/composition.hpp"
#include "processing/criticism/fitting/gauge_shares.hpp"
#include "processing/criticism/fitting/shot_residuals.hpp"
#include "processing/criticism/fitting/specimen_response.hpp"
#include "processing/criticism/noise/gauge_noise.hpp"
#include "processing/criticism/noise/window_jumps.hpp"
#include "processing/criticism/records/campaign.hpp"
#include "processing/criticism/records/judged_band.hpp"
#include "processing/models/transfers.hpp"

namespace kolsky {

/// Residuals before they are whitened, over the judged window at its own rate, filtered beyond the
/// judged band.
struct PlainResiduals {
  std::vector<std::vector<std::vector<double>>> records;  ///< by shot and other gauge
  /// What they hold of the reference gauge's record, by other gauge, from lag -before on, filtered
  /// alike; then, where that gauge is long, of the others' own, and the filter alone.
  std::vector<std::vector<double>> responses;
  std::size_t before = 0;
};

/// Whitened residuals of a campaign under compositions of effects.
///
/// Each shot's source is free at all times and eliminated exactly: with H_j a gauge's reading of a
/// unit source and y its record,
///     r_j(t) = y_j - (H_j / H_ref) y_ref,     j != reference,
/// (with means over the reference gauge's length m: m y_j - (H_j m / H_ref) y_ref)
/// is causal, so that a record cut while waves ring loses nothing, and under the true model noise
/// alone, of covariance G P G^H at each frequency (P the gauges' noise, G = [-H_j/H_ref, 1]).
/// Whitened with it, their sum of squares is that of all records with the source at its best:
/// the covariance follows the parameters, or what is noise in y_ref would pull at them.
///
/// The covariance is that of a shot of mean amplitude and temperature.
///
/// Work space is per worker; evaluations in different workers may run at once.
class WhiteResiduals : public ShotResiduals {
 public:
  /// @param band_limit_Hz  0: where the pulses fall below the noise, at most where surface gauges
  /// go blind
  WhiteResiduals(const Campaign& campaign, double band_limit_Hz, std::size_t workers);
  ~WhiteResiduals() override;

  /// Takes from this composition how residuals are shared out among the gauges, and what they say
  /// of each gauge's noise.
  void freeze(const Composition& composition, const std::vector<double>& theta);

  /// Adds to what is known of each gauge's noise what a coarse converter's steps leave of records
  /// like those foretold when `freeze` was called.
  /// @return whether any gauge's converter is coarse
  bool know_steps();

  /// Takes the quiet parts at their word about noise again; `freeze` is to follow.
  void believe_quiet();

  /// A gauge's record less what is known of its noise since `freeze`.
  [[nodiscard]] std::vector<double> signal(std::size_t shot, std::size_t gauge);

  /// What a specimen goes through under a shot's source, as all gauges together have it: errors of
  /// these histories are independent of the residuals. @param theta  as frozen
  [[nodiscard]] SpecimenHistories specimen_histories(const Composition& composition,
                                                     const std::vector<double>& theta,
                                                     std::size_t shot);

  /// Corrects what is known of each gauge's noise by what the residuals of a fit show of it: at
  /// each frequency the part that does not follow the shots' sources cannot be an unchanging error
  /// of the model. How it is shared out matters as much as how much it is: with a wrong share for
  /// the reference, noise in the source would pull at the parameters. Its power over that measured
  /// before the pulses is taken as s0 + s1/f + s2/f^2 for each gauge. One shot cannot tell its
  /// noise from what a model lacks: its residuals are taken for noise up to four times that power.
  void calibrate(const Composition& composition, const std::vector<double>& theta,
                 NoiseShown shown = NoiseShown::all);

  /// All shots' residuals, shot by shot, of unit variance under the true model.
  [[nodiscard]] Eigen::VectorXd evaluate(const Composition& composition,
                                         const std::vector<double>& theta,
                                         std::size_t worker = 0) override;
  /// Those of one shot.
  [[nodiscard]] Eigen::VectorXd evaluate_shot(const Composition& composition,
                                              const std::vector<double>& theta, std::size_t shot,
                                              std::size_t worker) override;

  /// What window ends leak of slow noise where a long reference gauge is blind, as a share of what
  /// is foretold: short quiet parts tell no more of it than its order of magnitude, and a fit would
  /// gain by all that is foretold too much.
  [[nodiscard]] double taken_by_noise(const Composition& composition,
                                      const std::vector<double>& theta,
                                      std::size_t worker) override;

  /// Whitened as they would be under another composition.
  [[nodiscard]] Eigen::VectorXd evaluate_in_noise_of(const Composition& known,
                                                     const std::vector<double>& known_theta,
                                                     const Composition& composition,
                                                     const std::vector<double>& theta,
                                                     std::size_t worker);
  [[nodiscard]] Eigen::VectorXd evaluate_shot_in_noise_of(const Composition& known,
                                                          const std::vector<double>& known_theta,
                                                          const Composition& composition,
                                                          const std::vector<double>& theta,
                                                          std::size_t shot, std::size_t worker);
  /// Whitened residuals of one shot with other records, as far as a linear specimen carries them
  /// and nothing is added to them. @param records  by gauge, as long as the shots', at their rate
  [[nodiscard]] Eigen::VectorXd whiten_records(const Composition& composition,
                                               const std::vector<double>& theta,
                                               std::span<const std::vector<double>> records,
                                               std::size_t worker);
  /// The same before they are whitened, of a shot's own waves. @return by other gauge
  [[nodiscard]] std::vector<std::vector<double>> plain_of_records(
      const Composition& composition, const std::vector<double>& theta,
      std::span<const std::vector<double>> records, std::size_t shot);
  /// Whitened residuals of all shots, of whose records all but what stands out of their noise is
  /// zero: what two compositions make of the pulses, without what they make of the noise of the
  /// reference gauge.
  [[nodiscard]] Eigen::VectorXd whiten_pulses(const Composition& composition,
                                              const std::vector<double>& theta, std::size_t worker);
  /// Whether that is all they make of them: nothing is added to records, and the specimen carries
  /// waves as linear ones do, alike in all shots.
  [[nodiscard]] bool only_carries(const Composition& composition,
                                  const std::vector<double>& theta) const;
  /// The residuals themselves. @param theta  as frozen
  [[nodiscard]] PlainResiduals plain(const Composition& composition,
                                     const std::vector<double>& theta);

  [[nodiscard]] std::size_t size() const { return per_shot() * campaign_.shots.size(); }
  [[nodiscard]] std::size_t per_shot() const override;
  [[nodiscard]] const JudgedBand& band() const { return band_; }
  [[nodiscard]] const Campaign& campaign() const { return campaign_; }

  /// Gauges in the order of a residual's components: all but the reference.
  [[nodiscard]] const std::vector<std::size_t>& others() const { return others_; }
  /// Index within a shot's residuals of the real part at a judged bin; the imaginary part follows.
  [[nodiscard]] std::size_t index(std::size_t bin, std::size_t other) const {
    return 2 * (bin * others_.size() + other);
  }
  [[nodiscard]] const GaugeNoise& noise() const { return noise_; }

  /// What whitened residuals of one shot are at every gauge, the reference included: the best
  /// estimate of each gauge's deviation from a wave common to all, in strain.
  /// @return by gauge, over the judged window at the decimated rate
  [[nodiscard]] std::vector<std::vector<double>> deviations(std::span<const double> white) const;
  /// Whitened residuals of one shot at a bin, times this, are the spectrum of all gauges'
  /// deviations there: gauges x others.
  [[nodiscard]] const Eigen::MatrixXcd& spread(std::size_t bin) const {
    return shares_.spread(bin);
  }
  /// The judged window of one gauge's record, filtered and decimated alike.
  [[nodiscard]] const std::vector<double>& judged_record(std::size_t shot,
                                                         std::size_t gauge) const {
    return judged_records_[shot][gauge];
  }
  /// The same as spectra over the judged bins.
  [[nodiscard]] std::vector<std::vector<Complex>> deviation_bins(
      std::size_t shot, const Eigen::VectorXd& white) const;
  /// Of all gauges and shots over the judged window and band, as squares of a spectrum's bins: the
  /// records', and what noise as it is known leaves in the deviations.
  [[nodiscard]] double energy_of_records() const { return energy_of_records_; }
  [[nodiscard]] double energy_of_noise() const;
  /// Energy of all records over that of their noise, in the units of whitened residuals.
  [[nodiscard]] double signal_energy() const { return signal_energy_; }
  [[nodiscard]] double judged_period_s() const;
  [[nodiscard]] double judged_start_s(std::size_t shot) const;
  /// Spectrum over the judged bins of a shot's source at the reference gauge, as all gauges
  /// together have it: unlike the record there, its error is independent of the residuals.
  [[nodiscard]] std::vector<Complex> source_spectrum(std::size_t shot, const Eigen::VectorXd& white,
                                                     std::size_t worker = 0);

 private:
  struct Workspace;
  using Spectrum = std::vector<Complex>;

  /// Each gauge's reading over the reference's, along the damped path. A reference gauge as long
  /// as a wave is blind to it, and nothing can be divided by what it reads of it: the others'
  /// records take the mean over its length instead.
  struct Ratios : Transfers {
    Spectrum mean;  ///< that all others take; empty: the reference is a point

    [[nodiscard]] Complex mean_at(std::size_t k) const { return mean.empty() ? 1.0 : mean[k]; }
  };

  // How waves travel and carry noise (residuals.cpp).
  [[nodiscard]] const Spectrum& path() const;
  [[nodiscard]] Ratios ratios_of(const Scene& scene) const;
  void know_waves(Workspace& work, const Composition& composition,
                  std::vector<AppliedEffect> effects, std::size_t shot) const;
  [[nodiscard]] Ratios usual_ratios(Workspace& work, const Composition& composition,
                                    const std::vector<AppliedEffect>& effects) const;
  void know_noise(Workspace& work, const Composition& composition,
                  const std::vector<AppliedEffect>& effects) const;
  void carry_noise(Workspace& work, const Ratios& ratios) const;

  // Residuals of shots (residuals.cpp).
  void shape_records(Workspace& work, const std::vector<AppliedEffect>& effects,
                     std::size_t shot) const;
  const Spectrum& departure_of(Workspace& work, Spectrum source, std::size_t shot) const;
  void find_residuals(Workspace& work, const Composition& composition,
                      const std::vector<double>& theta, std::size_t shot) const;
  void subtract(Workspace& work, const std::vector<Spectrum>& records) const;
  void evaluate_shots(const Composition& composition, const std::vector<double>& theta,
                      std::size_t first, std::size_t end, std::size_t worker, double* out);
  void whiten_shot(Workspace& work, double*& next) const;
  void whiten_shots(const Composition& composition, const std::vector<double>& theta,
                    std::size_t first, std::size_t end, std::size_t worker, double* out);

  // What residuals say of the gauges (residual_noise.cpp).
  void measure_signal();
  [[nodiscard]] std::span<const double> white_of(std::size_t shot,
                                                 const Eigen::VectorXd& white) const;
  [[nodiscard]] std::vector<double> by_bin(std::span<const double> white) const;
  [[nodiscard]] std::vector<Spectrum> deviation_spectra(std::span<const double> by_bin) const;
  [[nodiscard]] std::span<const double> shared_out(Workspace& work, std::size_t shot,
                                                   std::size_t gauge,
                                                   std::span<const double> shares = {}) const;
  void know_gauge_noise(Workspace& work, const Composition& composition,
                        const std::vector<double>& theta);
  [[nodiscard]] std::span<const double> own_noise(std::size_t shot, std::size_t gauge) const;
  void know_source_noise(Workspace& work);
  [[nodiscard]] std::vector<double> shares_of_noise() const;
  void share_out_noise(const Eigen::VectorXd& white, NoiseShown shown);
  [[nodiscard]] double times_jumps(const Eigen::VectorXd& white) const;
  void forget_whitener();
  [[nodiscard]] double power_over_known(std::size_t gauge, std::size_t bin,
                                        const std::vector<std::vector<Spectrum>>& noise,
                                        const std::vector<Spectrum>& sources) const;

  // Noise is there whether waves pass or not (residual_beneath_waves.cpp).
  struct AroundWaves {
    double log_p = 0.0;       ///< that noise leaves as much more where waves pass their gauge
    double between = 1.0;     ///< mean square of deviations where none does, over that of noise
    double between_sd = 0.0;  ///< of that, if it is noise
  };
  /// Of the frozen residuals.
  [[nodiscard]] AroundWaves around_waves() const;
  /// Takes back of what was learned what would leave too little between the waves.
  void keep_what_is_between_waves(const Composition& composition, const std::vector<double>& theta);

  const Campaign& campaign_;
  JudgedBand band_;
  GaugeNoise noise_;
  std::vector<std::size_t> others_;
  std::vector<std::vector<Spectrum>> spectra_;  ///< at the carried bins, by shot and gauge
  ShotFacts usual_;  ///< the shots' mean: how noise is carried differs too little between them
  GaugeShares shares_;
  WindowJumps jumps_;                   ///< as frozen
  Eigen::VectorXd frozen_;              ///< residuals as frozen, white by bin; none before
  std::vector<Spectrum> source_noise_;  ///< by shot, as frozen, at the carried bins
  std::vector<std::vector<std::vector<double>>> gauge_noise_;     ///< by shot and gauge, as frozen
  std::vector<std::vector<std::vector<double>>> judged_records_;  ///< by shot and gauge
  double signal_energy_ = 0.0;
  double energy_of_records_ = 0.0;
  std::vector<std::unique_ptr<Workspace>> work_;
};

}  // namespace kolsky
