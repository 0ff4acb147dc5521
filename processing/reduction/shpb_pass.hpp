#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "processing/reduction/pulse.hpp"
#include "processing/reduction/quality.hpp"
#include "processing/reduction/reducer.hpp"
#include "processing/reduction/separated_faces.hpp"
#include "processing/reduction/shpb_tables.hpp"

namespace kolsky {

/// One reduction of a split Hopkinson bar's shot in progress: what is found on the way from the
/// records to the histories and their quality. Each part of the way is a file: the incident pulse
/// (shpb_incident.cpp), what is known of the striker's push (shpb_push), the window of the
/// histories (shpb_window), these (shpb_histories) and what they are worth (shpb_judgement).
class ShpbPass {
 public:
  /// @pre the plans and tables are this shot's. All outlive this
  ShpbPass(const Shot& shot, const BarStation& in, const BarStation& out,
           const ReductionOptions& options, ShpbPlans& plans, ShpbTables& tables);

  [[nodiscard]] Reduction run();

 private:
  /// Of a history.
  static constexpr double kFewestSamples = 8.0;

  /// In size.
  [[nodiscard]] static double largest(std::span<const double> values);

  /// Without a sample before the pulse neither baseline nor arrival is known: every other reason
  /// may follow from that.
  void tell_late_record(Quality& quality) const;
  [[nodiscard]] Reduction reduced();
  /// The push still rises when it is hidden: of a short bar, or after an arrival that is not its
  /// foot.
  [[nodiscard]] Reduction push_not_seen() const;
  [[nodiscard]] Reduction nothing_in_window() const;
  [[nodiscard]] const std::string& first_gauge() const;
  /// Of a front, from the gauge that sees the push.
  [[nodiscard]] double travel_to_specimen_s() const;
  [[nodiscard]] double wave_speed_m_per_s() const;
  /// By how much until the pulse has come and gone at the specimen, if it is as long as the bar
  /// lets it be.
  [[nodiscard]] std::string record_longer() const;
  /// All of a spectrum that the band limit leaves.
  [[nodiscard]] std::span<Complex> in_band(std::vector<Complex>& spectrum) const;

  /// @return whether any pulse stands out of the noise
  [[nodiscard]] bool find_incident();
  /// Foot at the gauge itself, from the unfiltered record.
  [[nodiscard]] double rough_foot(const Rise& rise, std::size_t reach);
  void transform_records();
  /// The incident pulse from its quiet part on, until it is hidden.
  [[nodiscard]] std::span<const double> pulse_as_read() const;
  /// Of one that is hidden before it is over, less what is left of it there, risen to as smoothly
  /// as the pulse is long: a step's spectrum would count as its own, far above what the noise
  /// allows.
  [[nodiscard]] std::span<const double> pulse_without_cut();
  /// The incident pulse at its gauge, as long as the specimen's answer does not hide it.
  [[nodiscard]] std::span<const double> incident_strain() const;
  void choose_band(std::span<const double> pulse);
  /// Below that the filter mixes the pulse with the specimen's answer to it, and what is carried
  /// back with it grows without bounds.
  void require_band_of_pulse(double limit_Hz) const;

  /// Gives the incident pulse the tail that the specimen's answer hides: at the impacted end it is
  /// the striker's push, which is over before the hidden part would have started there, unless it
  /// is to be taken to go on.
  void complete_incident();
  /// Share of a pulse, rms over rms, that lateral inertia moves on its way to the specimen: by the
  /// phase that Love's bar adds, k = (w/c) sqrt(1 + (nu a w/c)^2 / 2).
  [[nodiscard]] double moved_by_lateral_inertia(std::span<const double> pulse) const;
  [[nodiscard]] double longest_gauge_m() const;
  /// Share of a pulse's rate of change, rms over rms, that is not in the mean over the longest
  /// gauge's length: of a wave of wavenumber k that mean is sin(k l / 2) / (k l / 2).
  [[nodiscard]] double lost_in_gauge_length(std::span<const double> pulse) const;
  /// Behind what is known of it: for as long again as it is known, which is beyond the loading.
  void let_push_go_on(std::span<double> push_Pa, double stress_Pa) const;
  void incident_from_push(std::span<const double> push_Pa, std::span<Complex> incident);
  /// Samples at an end of so many over which a level is averaged, so that it is judged and not the
  /// noise; and what of that noise alone does not exceed.
  [[nodiscard]] std::size_t few_of(std::size_t samples) const;
  [[nodiscard]] double noise_of_few(std::size_t few) const;
  /// How much of the push is left at the end of what is known of it.
  void judge_push(std::span<const double> push);
  /// Whether what the gauge sees of the push alone ends on its rise: on a ramp the last fifth of
  /// the window is 1.3 times the one before and near the peak, on a plateau that creeps no more
  /// than 1.05; what is left of a push that has gone may be anything, but is small.
  [[nodiscard]] bool push_still_rises() const;
  /// What a push that went on at its peak would take off the largest strain, as a share of it: all
  /// of it counts as reflected, and what it would have done at the specimen is missing. Need not be
  /// known where nothing of the push stands out.
  void weigh_hidden_push();
  /// The share of the push that may be left: it takes no more than so much off the largest strain,
  /// or does not stand out of the noise.
  [[nodiscard]] double overlap_limit() const;

  /// t = 0: the foot of the incident pulse after it has been carried to interface A. Where the band
  /// ends below what the noise allows, the filter has rounded that foot: then the one at the gauge,
  /// before any filter, and a front's way from there.
  void locate_arrival();
  /// The foot of the pulse whose peak lies between two samples of a record.
  [[nodiscard]] Foot first_foot(std::span<const double> record, double from, double to,
                                double noise_rms);
  /// Tells the waves apart by more than time, where that is asked for or needed and possible.
  void separate();
  /// From the arrival until the first wave is back from a far end, or where waves are separated
  /// until the first loading is over if that is later; as far as the record allows: the waves at
  /// the specimen are known up to a front's travel before the record's end.
  /// @return whether that holds any samples to speak of
  [[nodiscard]] bool choose_window();
  [[nodiscard]] std::size_t first_of_histories() const;
  /// From the arrival until the first wave is back at the specimen from a far end.
  [[nodiscard]] double first_return_s() const;
  /// How far the record tells what happened at the specimen.
  [[nodiscard]] double known_samples() const;
  /// From the arrival to the end of the first loading, where waves are separated.
  [[nodiscard]] double first_loading_s() const;
  /// Seconds a front needs over a stretch of the output bar that ends at its far end, if anything
  /// comes back from there.
  [[nodiscard]] double far_end_time_s(double distance_m) const;

  using Kernel = void (CarryingKernels::*)(const CarryingKernels::Inputs&,
                                           std::span<Complex>) const;
  [[nodiscard]] CarryingKernels::Inputs inputs();
  /// The history behind a kernel, from sample `first` of the late ones on.
  void carry(Kernel kernel, std::span<double> history, std::size_t first = 0);
  /// Of the specimen, late as `t_.history` is.
  [[nodiscard]] std::span<const double> strain_rate();
  /// The same, cut to the window.
  [[nodiscard]] std::vector<double> history(Kernel kernel);
  /// What t_.history holds, within the window.
  [[nodiscard]] std::vector<double> window() const;
  /// @pre t_.history still holds the right-going wave at interface A
  void fill_histories();
  void take_separated();
  void fill_strain();
  /// The rate integrated over what the low-pass has smeared before the arrival.
  /// @param rate  from the shot's first sample on
  [[nodiscard]] double strain_before_window(std::span<const double> rate) const;

  void judge_quality();
  /// What cannot be, whatever the specimen is.
  void judge_sizes(double incident_peak);
  [[nodiscard]] SeparationJudgement separation_judgement() const;
  /// From when a specimen that was taken to be in equilibrium may be: its own waves have crossed it
  /// a few times by then, as fast as the modulus has them that its peak stress has over its strain.
  [[nodiscard]] double assumed_from_s() const;

  const Shot& shot_;
  const BarStation& in_;
  const BarStation& out_;
  const ReductionOptions& options_;
  ShpbPlans& t_;
  ShpbTables& bars_;
  std::size_t bins_ = 0;  ///< within the band
  double rate_Hz_;
  double period_s_;
  double sense_ = 1.0;                    ///< of the push, in strain
  double gauge_foot_ = 0.0;               ///< of the pulse at its gauge, in samples
  bool foot_is_rounded_ = false;          ///< by a band that ends below what the noise allows
  std::optional<double> arrival_late_s_;  ///< of one that was given, than the foot that is found
  std::size_t push_end_ = 0;              ///< of what is known of the push, in samples of its own
  double push_left_Pa_ = 0.0;
  double push_peak_Pa_ = 0.0;
  double push_left_share_ = 0.0;
  double push_noise_share_ = 0.0;  ///< what that must exceed to stand out of the noise
  std::optional<double> strain_per_push_;
  bool strain_rate_known_ = false;
  double band_loss_ = 0.0;
  double moved_by_lateral_inertia_ = 0.0;
  double lost_in_gauge_length_ = 0.0;
  double strain_before_ = 0.0;
  double missing_s_ = 0.0;
  std::vector<double> front_rate_per_s_;  ///< of the front face alone
  std::optional<SeparatedFaces> faces_;
  double input_noise_ = 0.0;
  double output_noise_ = 0.0;
  std::size_t quiet_ = 0;  ///< samples before the pulse
  bool incident_found_ = false;
  std::size_t split_ = 0;  ///< sample at which the specimen's answer reaches the gauge
  std::size_t first_ = 0;  ///< sample of the histories
  std::size_t count_ = 0;  ///< of their samples
  Reduction reduction_;
};

}  // namespace kolsky
