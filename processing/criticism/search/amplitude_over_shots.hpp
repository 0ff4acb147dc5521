#pragma once

#include <string>

#include "processing/criticism/fitting/study.hpp"
#include "processing/criticism/search/common_amplitude.hpp"

namespace kolsky {

/// What a fit with cosine and sine parts of every shot's own says of the amplitude that all shots
/// share, in its unit. Where every gauge has parts of its own, of what is in all of them in the
/// same shares: alike, or as the parts themselves stand to each other, whichever stands out more.
/// Zero where no parts are free.
[[nodiscard]] Amplitude amplitude_over_shots(const Studied& studied, const std::string& id);

}  // namespace kolsky
