#pragma once

#include <memory>
#include <span>
#include <vector>

#include "processing/base/bench.hpp"
#include "processing/waves/bar_modes.hpp"

namespace kolsky {

/// What a record holds.
enum class SeparationRecord {
  surface_strain,
  mean_stress_Pa,  ///< over the section, as at an end whose force is known from elsewhere
};

/// A record of one gauge on a bar, or of a section whose stress is known: the end at a specimen in
/// equilibrium carries the force that the other bar's gauge gives.
struct SeparationGauge {
  double position_m = 0.0;         ///< from the bar's start
  std::span<const double> values;  ///< compression positive, baseline taken off
  double noise_rms = 0.0;          ///< of the strain; 0 where all gauges are as good
  SeparationRecord record = SeparationRecord::surface_strain;
};

/// What is known of a bar's ends, at all times of the record: a free end returns every wave
/// inverted, a matched one none.
struct FreeEnds {
  bool start = false;
  bool end = false;
  bool end_matched = false;
};

/// Of which strain the waves are given: the surface's, as gauges read it, or the section's mean.
enum class StrainOf { surface, section };

/// A bar over time at one place. Compression positive; motion from start to end.
struct SeparatedWaves {
  std::vector<double> right_going;  ///< strain
  std::vector<double> left_going;
  std::vector<double> stress_Pa;         ///< mean over the section
  std::vector<double> velocity_m_per_s;  ///< mean over the section
};

/// Frequencies at which the gauges together tell next to nothing of one of the waves.
struct BlindFrequency {
  double frequency_Hz = 0.0;
  double noise_gain = 0.0;  ///< of the worse known wave, over that of two independent gauges
};

/// @throws InputError as WaveSeparation does
/// @param band_limit_Hz  they are looked for up to it
[[nodiscard]] std::vector<BlindFrequency> blind_frequencies(
    const Bar& bar, const Compliance& compliance, WaveTheory theory,
    const std::vector<SeparationGauge>& gauges, const FreeEnds& ends, double band_limit_Hz);

/// Left- and right-going waves in a bar from two or more gauges, or from one and a free end, by
/// maximum likelihood. With P the right-going wave at the start and Q the left-going one at the
/// end,
///   e_j = P exp(-gamma x_j) + Q exp(-gamma (L - x_j)) + noise,
/// and P = -Q exp(-gamma L) where the start is free, Q = -P exp(-gamma L) where the end is, Q = 0
/// where it is matched. Solved at each s = eta + i w by least squares weighted with the noise: with
/// damping (see DampedTransform) overlapping passes and a record that is cut between them cost
/// nothing, and blind frequencies amplify noise but never divide by zero.
/// Beyond what gauges see waves go on as seen_modes has it: the band's flank reaches there.
/// Holds its own work space: one thread at a time.
class WaveSeparation {
 public:
  /// @param compliance  of the bar
  /// @throws InputError where the gauges do not suffice, lie off the bar or differ in length
  WaveSeparation(const Bar& bar, const Compliance& compliance, WaveTheory theory,
                 const std::vector<SeparationGauge>& gauges, const FreeEnds& ends, double period_s,
                 double band_limit_Hz);
  ~WaveSeparation();
  WaveSeparation(const WaveSeparation&) = delete;
  WaveSeparation& operator=(const WaveSeparation&) = delete;

  /// The waves at a place, over the records' time.
  [[nodiscard]] SeparatedWaves at(double position_m, StrainOf strain = StrainOf::surface) const;

  /// Standard deviation [Pa] of the stress at a place from the gauges' noise, over the records'
  /// time: white from the sample `quiet` on, before which the records are zero, and in the baseline
  /// that so many samples gave. It grows with time, the faster the closer the gauges are together.
  [[nodiscard]] std::vector<double> stress_noise_Pa(double position_m, std::size_t quiet) const;

  /// Samples up to which the records tell what left a place at one of the bar's ends: what has not
  /// reached the nearest gauge by their end is missing, and where more gauges than are needed
  /// contradict each other there, for having been cut, that spoils the waves a fifth of the
  /// transform's length before (least squares at s = eta + i w look ahead, damped by exp(-2 eta
  /// t)).
  [[nodiscard]] std::size_t known(double position_m) const;

 private:
  /// What waves do between a bar's ends and a place, by bin.
  struct Way {
    std::vector<Complex> from_start, from_end;
  };

  /// Each gauge's share in the waves, by least squares.
  void share_out(const std::vector<SeparationGauge>& gauges, const FreeEnds& ends);
  /// The waves from the records, filtered.
  void solve(const std::vector<SeparationGauge>& gauges);
  [[nodiscard]] Way way_to(double position_m) const;

  struct Work;
  double length_m_;
  double period_s_;
  double band_limit_Hz_;
  double slowest_s_per_m_ = 0.0;  ///< within the band
  std::size_t samples_;
  std::size_t lead_;
  std::size_t looks_ahead_ = 0;
  std::vector<Complex> path_;
  std::vector<BarMode> modes_;
  std::vector<Complex> across_;     ///< exp(-gamma L)
  std::vector<Complex> stiffness_;  ///< mean stress over surface strain
  /// What one gauge's record has in the waves.
  struct Share {
    double position_m;
    double noise_rms;
    std::vector<Complex> right, left;
  };
  std::vector<Share> shares_;
  std::vector<Complex> right_;  ///< at the start
  std::vector<Complex> left_;   ///< at the end
  std::unique_ptr<Work> work_;
};

}  // namespace kolsky
