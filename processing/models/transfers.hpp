#pragma once

#include <cstddef>
#include <vector>

#include "processing/models/scene.hpp"

namespace kolsky {

/// What a scene's gauges read of a unit source: the mean strain of the wave that travels in +x on
/// the input bar, where the reference gauge sits. Nothing is assumed of the impacted end: whatever
/// it sends back joins the source.
struct Transfers {
  using Spectrum = std::vector<Complex>;

  std::vector<Spectrum> reading;  ///< by gauge, along the path

  /// For a specimen whose answer is not linear: a strain q that its linear part does not foresee is
  /// a second source (see SpecimenScene).
  std::vector<Spectrum> reading_of_q;
  Spectrum stress, stress_of_q;  ///< of the specimen [Pa]
  Spectrum strain, strain_of_q;
};

/// What a gauge as long as it is reads of a wave that has strain 1 at its middle.
[[nodiscard]] Complex mean_over_length(const Scene& scene, std::size_t gauge, std::size_t at);

/// A gauge that is blind at a frequency (a wave as long as the gauge) tells nothing of the wave
/// there: divided by what it reads, noise would stand for the wave. The inverse of what this
/// returns is that of the factor, and goes smoothly to nothing where the factor does.
[[nodiscard]] Complex invertible(Complex factor);

/// Elementary gamma = s sqrt(rho J), J and a surface like the mean, for the bars of a scene whose
/// materials are known.
void set_elementary_waves(Scene& scene);

/// Bar: exp(-gamma x) + R exp(-gamma (2 L - x)). Specimen between two bars: continuity of force and
/// velocity at both faces, a layer that waves cross where it has inertia, by halves where they
/// cross its section, too (docs/methods/effects.md, specimen-inertia, radial-inertia, punching),
/// the output bar's far end as filed.
[[nodiscard]] Transfers transfers_of(const Scene& scene, std::size_t reference);

}  // namespace kolsky
