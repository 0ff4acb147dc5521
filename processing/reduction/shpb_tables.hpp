#pragma once

#include <memory>
#include <span>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/reduction/carrying.hpp"
#include "processing/reduction/stations.hpp"
#include "processing/waves/band_limit.hpp"

namespace kolsky {

/// One bar with how waves travel in it.
struct ShpbBar {
  std::unique_ptr<const Compliance> compliance;
  double front_speed_m_per_s;
  CarryingBar waves;
  std::vector<double> lateral_delay_s_per_m;  ///< by bin

  ShpbBar(const Bar& bar, const BarStation& station, const Material& viscoelastic);

  /// Seconds a front needs over a distance.
  [[nodiscard]] double front_time_s(double distance_m) const;
  /// Seconds that the slowest waves of a band need from the gauge to the specimen.
  [[nodiscard]] double travel_s(std::span<const Complex> path, double band_limit_Hz) const;
};

/// What decides the kernels: two shots that agree in it are reduced with the same ones.
[[nodiscard]] std::vector<double> shpb_numbers(const Bench& bench, const Material& viscoelastic,
                                               WaveTheory theory, const BarStation& in,
                                               const BarStation& out);

/// Samples that a front needs from a gauge to the specimen, on the bar where it needs more.
[[nodiscard]] std::size_t longest_travel(const Shot& shot, const ShpbBar& input,
                                         const ShpbBar& output);

/// What decides the plans.
struct ShpbPlanKey {
  std::size_t samples;
  SampleRate rate;
  /// Samples by which histories come out late, so that nothing looks ahead: what the slowest waves
  /// in the band take from a gauge to the specimen. What is carried back by more wraps round to the
  /// end, where the transform's damping makes it larger than everything else.
  std::size_t delay;
  std::size_t longest_pulse;
  /// Of the transform: the records' own, or more where exact waves of thick bars would be damped
  /// too much within so short a time (see PochhammerChree).
  std::size_t transformed;
  bool operator==(const ShpbPlanKey&) const = default;

  /// Of a shot on these bars; rounded up, so that benches that differ a little share their plans.
  static ShpbPlanKey of(const Shot& shot, const ShpbBar& input, const ShpbBar& output,
                        WaveTheory theory);
};

/// Plans and work space for shots of one length.
struct ShpbPlans {
  ShpbPlanKey key;
  DampedTransform transform;
  BandLimit band;
  std::vector<Complex> path;
  std::vector<double> input_strain, output_strain, history, scratch, strain_rate;
  std::vector<Complex> incident, rest, output_spectrum, work, hidden, hidden_in_rest;

  explicit ShpbPlans(const ShpbPlanKey& k);
};

/// The bars of one bench, with what carries their waves as far up in frequency as was asked for.
struct ShpbTables {
  std::vector<double> numbers;
  ShpbPlanKey plan;
  WaveTheory theory;
  Bar input_bar;
  Bar output_bar;
  double specimen_length_m;
  ShpbBar input;
  ShpbBar output;
  CarryingKernels kernels;

  ShpbTables(std::vector<double> n, const ShpbPlanKey& p, WaveTheory t, const Bench& bench,
             const Material& m, const BarStation& in, const BarStation& out);

  void reach(const ShpbPlans& plans, std::size_t bins);
  /// Where surface gauges go blind, if within so many bins.
  [[nodiscard]] double blind_from_Hz(const ShpbPlans& plans, std::size_t bins) const;
};

}  // namespace kolsky
