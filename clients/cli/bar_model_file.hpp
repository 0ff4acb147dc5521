#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "processing/base/shot.hpp"
#include "processing/specimen/shpb_unknowns.hpp"

namespace kolsky::cli {

/// A material file with what its identification filed beside the numbers.
struct BarModelFile {
  BarPrior prior;
  std::string name;                     ///< of the file, for messages
  std::optional<double> band_limit_Hz;  ///< up to which it was identified
  std::optional<double> temperature_K;  ///< at which it was identified
};

/// Reads a material file, its `covariance` (nine numbers, row by row, of E1_Pa, E2_Pa and
/// eta2_Pa_s) and from `[identified]` the band and the temperature. Without a covariance the
/// numbers' own deviations count as independent.
/// @throws InputError: file, key and mend
[[nodiscard]] BarModelFile read_bar_model(const std::filesystem::path& path);

/// A shot's temperature: the bench's, or the fact `temperature_K` of the capture, which goes first.
/// @throws InputError where that fact is no number
[[nodiscard]] std::optional<double> temperature_of(const Shot& shot);

/// Refuses a bar model for a shot at another temperature than it was identified at, where both are
/// known. PMMA changes by some 0.3 % per kelvin.
/// @throws InputError
void require_temperature(const BarModelFile& model, const Shot& shot);

/// What to say where a bar model's temperature is known and the shot's is not; else nothing.
[[nodiscard]] std::string temperature_unchecked(const BarModelFile& model, const Shot& shot);

/// Refuses a bar model of another density than a viscoelastic bar of the bench: moduli tell a
/// wave's speed only with the density they were identified with.
/// @throws InputError where they are more than 1 % and three filed deviations apart
void require_density(const BarModelFile& model, const Bench& bench);

/// The band limit to work with: what was asked for, which must lie within the model's band; else
/// none. @throws InputError
void require_band(const BarModelFile& model, std::optional<double> asked_Hz);

}  // namespace kolsky::cli
