#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "processing/base/bench.hpp"
#include "processing/base/material.hpp"
#include "processing/identification/bar_prior.hpp"
#include "processing/specimen/shpb_records.hpp"

namespace kolsky {

/// A filed number of a specimen bench with a standard deviation: it may be off by about that much,
/// and a fit may move it. A move is the same for all shots.
struct ShpbUnknown {
  enum class Of {
    gain,
    position,
    delay,
    bar_length,
    bar_density,
    bar_diameter,
    bar_poisson,
    bar_modulus,   ///< of an elastic bar
    bar_material,  ///< one of the independent directions of a viscoelastic bar's moduli
    own_material,  ///< the same of an output bar's own material
    temperature,   ///< at which viscoelastic bars soften
    specimen_length,
    specimen_diameter,
    specimen_density
  };
  std::string name;  ///< as the effect that would name it: "gauge-position:g1"
  Of of = Of::gain;
  std::size_t index = 0;  ///< station, bar (0 input, 1 output) or direction
  double sd = 0.0;        ///< relative, but metres for position and length; seconds for delay;
                    ///< 1 for bar_material and own_material; for temperature that of the moduli
};

[[nodiscard]] std::vector<ShpbUnknown> shpb_unknowns(const Bench& bench,
                                                     const std::vector<ShpbStation>& stations,
                                                     const BarPrior& bars);

/// The bench with its known unknowns moved.
struct MovedShpb {
  std::array<Bar, 2> bars;  ///< input, output
  Material material;        ///< of viscoelastic bars
  Specimen specimen;
  std::vector<double> to_specimen_m;  ///< by station
  std::vector<double> gain;           ///< reading = gain x strain, by station
  std::vector<double> delay_s;        ///< beyond what is filed, by station

  /// @param moves  one per known unknown, in its standard deviations
  MovedShpb(const Bench& filed, const std::vector<ShpbStation>& stations, const BarPrior& prior,
            const std::vector<ShpbUnknown>& unknowns, std::span<const double> moves);
};

}  // namespace kolsky
