#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/reduction/ball/ball_deviations.hpp"
#include "processing/reduction/ball/ball_kernels.hpp"
#include "processing/reduction/ball/contact_numbers.hpp"
#include "processing/reduction/reducer.hpp"
#include "processing/reduction/stations.hpp"

namespace kolsky {

/// One reduction of a ball's shot in progress: strain at the gauges, force on the face, numbers of
/// the contact. Force histories count from the record's first sample at the face.
class BallPass {
 public:
  BallPass(const Shot& shot, const std::vector<BarStation>& stations,
           const ReductionOptions& options, BallPlans& plans, BallKernels& kernels);

  [[nodiscard]] static double front_speed(const Bar& bar);
  [[nodiscard]] Reduction run();

 private:
  /// After the contact, as long until the bar is looked at for what should not be there.
  static constexpr double kAfterContact_s = 50e-6;

  [[nodiscard]] double travel_samples(double distance_m) const;
  /// From first touch until the far end's reflection, carried back, overlies a station's force.
  [[nodiscard]] double clean_samples(const BarStation& station) const;
  [[nodiscard]] bool find_wave();
  /// Samples of a station before the wave arrives there.
  [[nodiscard]] std::size_t quiet_samples(const BarStation& station) const;
  /// @return whether every reading is a strain
  [[nodiscard]] bool read_strains();
  /// The wave at a station, until the far end answers there.
  [[nodiscard]] std::span<const double> wave_at(std::size_t i) const;
  void choose_band();
  /// The force on the face by each station.
  void find_forces();
  /// The mean of the chosen stations' forces by their noise.
  void weigh(const std::vector<bool>& chosen, std::vector<double>& force);
  /// t = 0: the foot of the force at the face. @return whether there is a push
  [[nodiscard]] bool locate_touch(const std::vector<double>& force);
  /// The face's force is known up to a front's travel before the record's end.
  [[nodiscard]] std::size_t known_samples() const;
  /// Stations whose window ends before the ball has left would cut the others' short.
  void choose_stations();
  /// From the record's first sample to the end of what is known of the combined force.
  [[nodiscard]] std::span<const double> known_force() const;
  /// @pre holds_push()
  [[nodiscard]] std::size_t peak_after_touch(std::span<const double> known) const;
  /// Whether anything of the push is known.
  [[nodiscard]] bool holds_push() const;
  [[nodiscard]] double threshold_for(double peak_N) const;
  void fill_history();
  [[nodiscard]] SampleRange contact_span(const Stay& stay, std::size_t known) const;
  void measure();
  [[nodiscard]] double impulse(std::span<const double> force, const SampleRange& span) const;
  /// Rms of the combined force's noise before the low-pass, taken as white.
  [[nodiscard]] double raw_noise_N() const;
  /// Relative deviation of every force alike: modulus, section, gauges.
  [[nodiscard]] double scale_sd() const;
  /// Noise and baseline: by adding stretches of the quiet before the impact to the force, each with
  /// a baseline of its own, and by the formulas for white noise; whichever is more.
  void find_deviations(std::span<const double> known, const Stay& stay, const SampleRange& span);
  void list_stations(const SampleRange& span);
  void look_after_contact(std::span<const double> known, const Stay& stay);
  void judge_quality();

  const Shot& shot_;
  const Bar& bar_;
  const std::vector<BarStation>& stations_;
  const ReductionOptions& options_;
  BallPlans& t_;
  BallKernels& kernels_;
  double rate_Hz_;
  double period_s_;
  double front_speed_m_per_s_;
  double foot_ = 0.0;   ///< of the wave at the first station, in samples
  double touch_ = 0.0;  ///< first touch, in samples
  double clean_ = 0.0;  ///< samples from it that are known of the combined force
  std::size_t bins_ = 0;
  std::size_t baseline_samples_ = 1;
  std::vector<std::vector<double>> strains_;
  std::vector<double> noise_strain_;
  std::vector<std::vector<double>> forces_;
  std::vector<double> weights_;
  std::vector<double> best_;
  std::vector<double> force_;
  std::span<const double> quiet_force_;
  double noise_N_ = 0.0;
  double band_loss_ = 0.0;
  double peak_strain_ = 0.0;
  double peak_over_noise_ = 0.0;
  double contact_end_s_ = 0.0;
  double after_contact_N_ = 0.0;
  double after_contact_sd_N_ = 0.0;
  std::string speed_problem_;
  Reduction reduction_;
};

}  // namespace kolsky
