#pragma once

#include <optional>
#include <vector>

#include "processing/base/measured.hpp"
#include "processing/criticism/records/campaign.hpp"

namespace kolsky {

/// Shots at nearly one speed: they repeat each other, and share the solver's runs.
struct SpeedGroup {
  double speed_m_per_s = 0.0;  ///< mean
  double low_m_per_s = 0.0;    ///< speeds that are calculated: between them forces are
  double high_m_per_s = 0.0;   ///< interpolated
  std::vector<std::size_t> shots;
  std::vector<double> faster;  ///< by shot of these: than the mean, relative
};

/// What of an impact's records is judged: gauge by gauge from before the arrival on, low-passed and
/// thinned out alike in measurement and model.
struct ImpactWindow {
  double cutoff_Hz = 0.0;       ///< Gaussian low-pass, half the power here
  double period_s = 0.0;        ///< between judged samples
  std::size_t samples = 0;      ///< of a gauge
  double lead_s = 0.0;          ///< from the first one to the arrival at the reference gauge
  bool to_far_end_only = true;  ///< ends before the far end's reflection is back
};

/// The judged records of a campaign of impacts and their noise.
struct ImpactRecords {
  ImpactWindow window;
  std::vector<SpeedGroup> groups;     ///< by rising speed
  std::vector<std::size_t> group_of;  ///< by shot
  /// By shot and gauge: the whole record, low-passed [strain].
  std::vector<std::vector<std::vector<double>>> low_passed;
  double sample_period_s = 0.0;
  std::vector<std::vector<double>> judged;  ///< by shot: gauge after gauge [strain]
  std::vector<double> first_s;  ///< by shot: time of the reference gauge's first judged sample
  /// By gauge: how much later its samples are, less than a period, and how many of them the force
  /// that they show passed the reference gauge before. What a calculated force is off by is alike
  /// in all gauges only where they show the same force; apart it hides that they contradict each
  /// other.
  std::vector<double> later_s;
  std::vector<int> behind;
  std::vector<std::vector<double>> noise;  ///< by gauge: autocovariance, judged samples apart
  std::vector<double> peak;                ///< by shot: largest judged strain
  /// By shot: rebound speed over the speed of waves in the bar, a number of the size of strains;
  /// its deviation of zero: none was filed.
  std::vector<std::optional<Measured>> rebound;
  double wave_speed_m_per_s = 1.0;
  /// Relative deviations of the incident speeds: the largest of a shot by itself, and what is
  /// common to all (the distance of the beams that timed them).
  double own_speed_sd = 0.0;
  double common_speed_sd = 0.0;

  /// Of a gauge's k-th judged sample.
  [[nodiscard]] double judged_s(std::size_t shot, std::size_t gauge, std::size_t k) const {
    return first_s[shot] + later_s[gauge] + static_cast<double>(k) * window.period_s;
  }
  /// When the force of it passed the reference gauge, from the first judged sample there.
  [[nodiscard]] double force_s(std::size_t gauge, std::size_t k) const {
    return static_cast<double>(static_cast<int>(k) - behind[gauge]) * window.period_s;
  }

  /// Judges all shots at the same times after their first touch. What a model misses is the same in
  /// the shots of one speed only there: seen some microseconds earlier or later, a ripple of the
  /// contact scatters as noise does.
  /// @param touch_s  by shot, from the record's start
  void judge_from(const std::vector<double>& touch_s);
  /// Takes the judged samples of the low-passed records.
  void take_samples();

  /// A group's incident speed as `rebound` counts speeds.
  [[nodiscard]] double incident(std::size_t group) const {
    return groups[group].speed_m_per_s / wave_speed_m_per_s;
  }
  /// Shots of a group without a rebound speed.
  [[nodiscard]] std::size_t unsaid_rebounds(std::size_t group) const;
  [[nodiscard]] std::size_t unsaid_rebounds() const;
};

/// How much of the records is judged.
enum class JudgedStretch {
  to_reflection,  ///< until the far end's reflection is back
  whole,          ///< beyond that, up to where the struck end sends it back
};

/// @param cutoff_Hz  0: 10 kHz; above it forces carry the ripple of a contact that grows node by
/// node, whatever the mesh
/// @throws InputError where too little of a pulse is left to judge
[[nodiscard]] ImpactRecords read_impact_records(const Campaign& campaign, JudgedStretch stretch,
                                                double cutoff_Hz);

}  // namespace kolsky
