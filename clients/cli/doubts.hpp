#pragma once

#include <cstdint>
#include <string>

namespace kolsky::cli {

/// How many draws a propagation of uncertainty is from.
/// @param command  for messages: "kolsky reduce"
/// @throws InputError where the number says too little or takes for ever
void require_draws(const std::string& command, std::uint64_t draws);

/// By how much viscoelastic bars' moduli fall per kelvin, relative.
/// @throws InputError where that is nothing a solid does
void require_softening(const std::string& command, double softening_per_K);

inline constexpr const char* kSofteningHelp =
    "relative loss of viscoelastic bars' moduli per kelvin, for temperature_K_sd; 0.003 by default";

}  // namespace kolsky::cli
