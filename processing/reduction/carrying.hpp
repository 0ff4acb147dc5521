#pragma once

#include <span>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/waves/bar_modes.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

/// One bar as the reduction sees it.
struct CarryingBar {
  double area_m2 = 0.0;
  double density_kg_m3 = 0.0;
  double gauge_to_specimen_m = 0.0;
  /// To the impacted end of the input bar, to the free end of the output bar.
  double gauge_to_far_end_m = 0.0;
  FarEnd far_end = FarEnd::free;
  double front_speed_m_per_s = 0.0;
  std::vector<BarMode> modes;  ///< one per bin of the transform
};

/// What turns the spectra of the gauge records into those of the histories at the specimen.
/// Everything at s = eta + i w, for one bench and one length of record.
///
/// Input bar. While the striker pushes, the impacted end is the source of the incident wave;
/// afterwards it is free. The incident pulse is known at the gauge only until the specimen's answer
/// arrives there, but carried to the impacted end, where it ends with the striker's push, it is
/// known whole: so is its tail at the gauge, I. The rest of the record is the left-going wave L and
/// what the free end has sent back of it:
///     e1 = I + L - L exp(-2 gamma x1),    D = e1 - I,    L = D / (1 - exp(-2 gamma x1)),
/// x1 from the gauge to the impacted end. At the specimen
///     right-going (I - L exp(-2 gamma x1)) exp(-gamma l1),   left-going L exp(+gamma l1).
/// Output bar, free at distance x2 behind the gauge: e2 = T - T exp(-2 gamma x2), and at the
/// specimen
///     right-going T exp(+gamma l2),   left-going -T exp(-gamma (2 x2 + l2)).
/// Stress is strain over J, particle velocity s/gamma times (right-going - left-going). With only
/// first passages these are the paper's eqs (10) to (18) with their errata, bars unequal or not.
class CarryingKernels {
 public:
  CarryingKernels() = default;

  /// @param path     the first places of a damped transform, as many as the bars' modes
  /// @param delay_s  by which every history comes out late; at least the longer of both fronts'
  ///   travel from gauge to specimen, so that carrying back looks into no future and nothing wraps
  ///   round the record's start
  CarryingKernels(std::span<const Complex> path, const CarryingBar& input,
                  const CarryingBar& output, double specimen_length_m, double delay_s);

  [[nodiscard]] std::size_t bins() const { return to_impact_.size(); }

  /// Spectra of the histories, from those of the incident pulse I, the rest D of the input gauge,
  /// and the output gauge E2: of the first bins, behind which the band limit leaves nothing. All
  /// of one size. @pre at most bins()
  struct Inputs {
    std::span<const Complex> incident;
    std::span<const Complex> rest;
    std::span<const Complex> output;
  };
  /// The incident wave at the input gauge as the stress [Pa] of the striker's push, late by a
  /// front's travel from the impacted end to the gauge; and back. It is the stress that ends with
  /// the push: the strain of a viscoelastic end goes on recovering.
  void push_from_incident(std::span<Complex> wave) const;
  void incident_from_push(std::span<Complex> wave) const;

  void force_front(const Inputs& in, std::span<Complex> out) const;
  void force_back(const Inputs& in, std::span<Complex> out) const;
  void strain_rate(const Inputs& in, std::span<Complex> out) const;
  /// Particle velocity of the input bar's end over the specimen's length.
  void rate_of_front(const Inputs& in, std::span<Complex> out) const;
  void right_going_front(const Inputs& in, std::span<Complex> out) const;
  void left_going_front(const Inputs& in, std::span<Complex> out) const;
  void right_going_back(const Inputs& in, std::span<Complex> out) const;

 private:
  std::vector<Complex> to_impact_;
  std::vector<Complex> from_impact_;
  std::vector<Complex> force_of_incident_;
  std::vector<Complex> force_of_rest_;
  std::vector<Complex> force_of_output_;
  std::vector<Complex> rate_of_incident_;
  std::vector<Complex> rate_of_rest_;
  std::vector<Complex> rate_of_output_;
  std::vector<Complex> right_of_incident_;
  std::vector<Complex> right_of_rest_;
  std::vector<Complex> left_of_rest_;
  std::vector<Complex> right_of_output_;
};

}  // namespace kolsky
