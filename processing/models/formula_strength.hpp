#pragma once

#include "processing/models/model.hpp"

namespace kolsky {

/// Whether a formula gives an effect's strength with the sizes filed (a solid's inertia).
[[nodiscard]] bool has_formula(const EffectUse& use);

/// Whether a strength is what its formula gives, within three deviations or a share of it; false
/// without a formula.
[[nodiscard]] bool agrees_with_formula(const EffectUse& fitted, double share);

/// Whether a strength is something, less than twice its formula's, and agrees with that to a tenth.
[[nodiscard]] bool may_be_its_formula(const EffectUse& fitted);
/// Whether it is known to a tenth, too.
[[nodiscard]] bool is_its_formula(const EffectUse& fitted);

/// Whether an effect may be what it is said to be: a variant that `only_by_formula` allows has
/// another strength where something else does its work.
[[nodiscard]] bool allowed_by_formula(const EffectUse& fitted);

}  // namespace kolsky
