#pragma once

#include <optional>

#include "processing/base/bench.hpp"
#include "processing/base/material.hpp"
#include "processing/base/reduction_request.hpp"
#include "processing/reduction/reducer.hpp"

namespace kolsky {

/// Why a specimen's options are refused for a ball, and the mend.
inline constexpr const char* kForSpecimens =
    "is for specimens, and this is a ball on an elastic bar";
inline constexpr const char* kLeaveOutForBall =
    "leave it out; an impact's deviations come by themselves";

/// The options that a request stands for.
/// @throws InputError at its key, where a word is none of those known or a number is out of range
[[nodiscard]] ReductionOptions options_of(const ReductionRequest& request);

/// Refuses what cannot be asked of any shot of this bench: anything of a bar by itself, a
/// specimen's options of a ball, inertia without the specimen's density, separation by gauges that
/// are at one place, a band beyond the record's or the bar model's.
/// @param bar_model  of viscoelastic bars, where one is given
/// @throws InputError at the request's key
void require_suits(const ReductionRequest& request, const Bench& bench,
                   const std::optional<Material>& bar_model);

/// @throws InputError where a record sampled at `rate_Hz` does not reach up to there
void require_band_of_record(const std::optional<double>& band_limit_Hz, double rate_Hz);

/// @param blind_from_Hz  where surface gauges of the thicker bar go blind
/// @throws InputError where the band asked for goes beyond
void require_band_seen(double band_limit_Hz, double blind_from_Hz);

}  // namespace kolsky
