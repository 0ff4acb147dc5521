#pragma once

#include <string>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/reduction/reduction.hpp"
#include "processing/reduction/shpb_tables.hpp"

namespace kolsky {

/// The specimen's faces from separated waves, from the shot's first sample on.
struct SeparatedFaces {
  std::vector<double> force_front_N, force_back_N;
  std::vector<double> rate_of_front_per_s;  ///< velocity of the front face over the length
  std::vector<double> strain_rate_per_s;
  std::vector<double> incident, reflected, transmitted;  ///< mean strains
  std::vector<double> front_noise_N;                     ///< of the front force, one sigma
  std::vector<double> blind_Hz;                          ///< of the input bar
  std::string gauges;                                    ///< of the input bar, as "g1 and g2"
  std::size_t quiet = 0;  ///< samples before the pulse at every gauge
  std::size_t known = 0;  ///< samples up to which the gauges have seen what left the faces
};

/// @throws InputError where the input bar's are at one place
void require_two_places(const Bench& bench);
/// Whether a bar has gauges at two places that are more than a diameter apart.
[[nodiscard]] bool gauges_at_two_places(const Bench& bench, const std::string& bar);

/// @param how    gauges or equilibrium
/// @param quiet  samples before the pulse: baselines are theirs, and they count as zero
/// @throws InputError where the gauges do not suffice
[[nodiscard]] SeparatedFaces separated_faces(const Shot& shot, const ShpbTables& bars,
                                             Separation how, std::size_t quiet,
                                             double band_limit_Hz);

/// Samples to the end of the first loading: where the force, having risen, first falls below a
/// tenth of what it was at most until then; the record's length where it does not.
[[nodiscard]] std::size_t first_loading_end(const SeparatedFaces& faces, std::size_t arrival);

}  // namespace kolsky
