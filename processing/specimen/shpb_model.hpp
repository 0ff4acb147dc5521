#pragma once

#include <array>
#include <vector>

#include "processing/specimen/shpb_unknowns.hpp"
#include "processing/waves/bar_modes.hpp"
#include "processing/waves/solids.hpp"

namespace kolsky {

/// What of the specimen besides its compliance shapes the waves: nothing (the paper), its mass
/// along the axis (a short rod with one-dimensional waves in it), or its mass in both directions
/// (Love's rod).
enum class SpecimenWaves { massless, rod, lateral };

[[nodiscard]] std::string name_of(SpecimenWaves waves);
/// @throws InputError for any other name
[[nodiscard]] SpecimenWaves specimen_waves(const std::string& name);

/// What is assumed about how waves travel.
struct ShpbTheory {
  WaveTheory bars = WaveTheory::elementary;
  SpecimenWaves specimen = SpecimenWaves::massless;
  bool operator==(const ShpbTheory&) const = default;
};

/// What follows from a force on the impacted end, which is free but for that force: per newton.
struct ShpbPerForce {
  std::vector<Complex> first;        ///< reading of the first station
  std::vector<Complex> force_front;  ///< of the specimen, on its faces
  std::vector<Complex> force_back;
  std::vector<Complex> velocity_front_m_per_s;
  std::vector<Complex> velocity_back_m_per_s;

  void resize(std::size_t count) {
    for (auto* part :
         {&first, &force_front, &force_back, &velocity_front_m_per_s, &velocity_back_m_per_s}) {
      part->resize(count);
    }
  }
};

/// The gauge records of a specimen shot as multiples of that of the first station.
///
/// The wave that comes from the input bar's impacted end is a free source at all times: whatever
/// the striker and that end do is in it. At the specimen, with Z = A rho s / gamma of each bar and
/// E = exp(-2 gamma L) the way to the output bar's far end and back (0 where that is matched), the
/// output bar answers with the admittance (1 + E) / (Z2 (1 - E)). The specimen adds s ls Js / As
/// (massless), or changes force and velocity as a line of length ls does. With Y the admittance of
/// both, the input bar's wave is reflected with r = (1 - Z1 Y) / (1 + Z1 Y) in velocity, and a
/// station at distance d from the specimen reads
///     on the input bar   exp(gamma d) (1 + r exp(-2 gamma d)),
///     on the output bar  what its force launches, and that wave's return from the far end.
/// Ratios to the station nearest to the impact are causal.
class ShpbModel {
 public:
  explicit ShpbModel(std::vector<ShpbStation> stations) : stations_(std::move(stations)) {}

  /// H_j / H_0 along a path of s, for stations 1 on. `transfers()[j - 1][k]`.
  /// Modes of the bars are kept from call to call for a path of the same `slot`.
  /// @param per_N  if given: what a force on the impacted end makes
  void evaluate(const ShpbTheory& theory, const MovedShpb& moved, const Compliance& specimen,
                const std::vector<Complex>& path, std::size_t slot,
                std::vector<std::vector<Complex>>& transfers, ShpbPerForce* per_N = nullptr);

  [[nodiscard]] const std::vector<ShpbStation>& stations() const { return stations_; }

 private:
  struct KeptModes {
    std::vector<double> key;
    std::vector<BarMode> modes;
  };
  const std::vector<BarMode>& modes(WaveTheory theory, const MovedShpb& moved, std::size_t bar,
                                    const std::vector<Complex>& path, std::size_t slot);

  std::vector<ShpbStation> stations_;
  std::array<std::array<KeptModes, 2>, 3> kept_;  ///< by slot and bar
};

}  // namespace kolsky
