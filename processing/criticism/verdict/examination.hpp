#pragma once

#include <optional>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/criticism/verdict/diagnosis.hpp"

namespace kolsky {

/// What there is to say of shots before any model is fitted: bad data, or one gauge alone that is
/// there or sees anything, which tells nothing while each shot's source is free. None where they
/// can be examined.
/// @pre there are shots
[[nodiscard]] std::optional<Diagnosis> verdict_without_fit(const std::vector<Shot>& shots);

}  // namespace kolsky
