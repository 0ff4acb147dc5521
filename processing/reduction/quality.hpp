#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/reduction/reduction.hpp"

namespace kolsky {

/// Largest rms(front - back) over the mean force: rubber under a 170 us pulse has 4.5 to 5 % at
/// 4 mm and 9 to 11 % at 6 mm; 7 % separates the paper's two findings.
inline constexpr double kEquilibriumLimit = 0.07;

/// Why a shot's samples cannot be reduced, whatever the bench: a gap in its window or clipped
/// codes. Empty when they can.
[[nodiscard]] std::string unusable_because(const Shot& shot);

/// What records show of the ends of their converters where nobody filed these, as of a table.
struct FlatTop {
  bool ends_filed = true;   ///< by all gauges
  std::string gauge;        ///< cut off for the longest; empty: none
  std::size_t samples = 0;  ///< for so long
};

/// By where the gauges' records are cut off (cut_off.hpp).
[[nodiscard]] FlatTop longest_flat_top(const Shot& shot);

/// A pass, or a warning where a record of unknown ends was cut off.
[[nodiscard]] Check clipping(const FlatTop& flat_top);

/// What to do about a shot that is `unusable_because`.
inline constexpr const char* kRepeatOrLeaveOut = "repeat the shot, or leave this capture out";

/// No histories, why, and what would be right.
[[nodiscard]] Reduction not_reducible(std::string reason, std::string mend);

/// What is known of separated waves.
struct SeparationJudgement {
  std::string gauges;            ///< as "g1 and g2"
  double noise_share = 0.0;      ///< of the front force's peak, one sigma, at the histories' end
  std::vector<double> blind_Hz;  ///< of the input bar, within the band
  /// Of the front force, one sigma, as long as the histories; empty where it is not known.
  std::vector<double> front_noise_N;
  bool assumes_equilibrium = false;  ///< front and back force are one
  bool ends_in_loading = false;      ///< the record does, so nothing after it is known
};

/// What keeps the reflection from hiding the push at its gauge: how short a pulse, how far a gauge.
[[nodiscard]] std::string longer_window(double gauge_to_specimen_m, double wave_speed_m_per_s);

/// Largest share of the strain that what is left of the striker's push may take off it; of the push
/// itself it is never more.
inline constexpr double kOverlapLimit = 0.02;

/// An arrival that is given further from the foot that the record shows is another's.
inline constexpr double kArrivalLimit_s = 10e-6;

/// What the checks need besides the histories.
struct QualityInputs {
  double input_peak = 0.0;       ///< of the incident pulse at its gauge, strain
  double input_noise_rms = 0.0;  ///< strain
  double output_peak = 0.0;      ///< at the output gauge within the histories' time
  double output_noise_rms = 0.0;
  /// What is left of the striker's push, as a share of its peak, at the end of what is known of it.
  double push_left_share = 0.0;
  double push_limit = kOverlapLimit;  ///< the share that may be left
  double gauge_to_specimen_m = 0.0;   ///< of the gauge that sees the push
  double wave_speed_m_per_s = 0.0;    ///< of a front in the input bar
  /// What a push that went on at its peak would take off the largest strain, as a share of it.
  double strain_per_push = 0.0;
  /// Time, as in the histories, from which a gauge holds waves that came back from a far end too.
  double returns_from_s = 0.0;
  bool may_shorten = true;  ///< nobody asked for a duration
  double missing_s = 0.0;   ///< of the histories' time, that the record does not hold
  FlatTop flat_top{};
  /// Where the waves of both bars were separated: what there is to say of it.
  std::optional<SeparationJudgement> separated{};
  /// Velocity of the front face over the specimen's length, as long as the histories.
  std::vector<double> front_rate_per_s;
  double specimen_length_m = 0.0;
  double specimen_mass_kg = 0.0;  ///< 0 where its density is not filed
  /// Of an arrival that was given: by how much it is later than the foot that the record shows.
  std::optional<double> arrival_late_s{};
  double way_to_specimen_s = 0.0;  ///< of a front, from the gauge that sees the push
  double band_loss = 0.0;  ///< share of the incident pulse's energy that the band limit took
  /// Of elementary waves: how much of the incident pulse (rms over rms) lateral inertia would have
  /// moved on its way to the specimen.
  double moved_by_lateral_inertia = 0.0;
  /// Of the longest gauge: how much of the incident pulse's rate of change (rms over rms) is lost
  /// in the mean over its length.
  double lost_in_gauge_length = 0.0;
  double gauge_length_m = 0.0;
};

/// Judges a reduction: equilibrium, signal to noise, window overlap, clipping, loop closure, the
/// record's end, the lag between front and back, energy, the band, and whether the waves that come
/// back from the far ends do so as the bench says. Where they do not, the histories are cut where
/// those waves begin. Limits and their reasons: docs/quality.md.
void judge(const QualityInputs& inputs, Reduction& reduction);

}  // namespace kolsky
