#pragma once

#include <optional>

#include "processing/criticism/fitting/misfit.hpp"
#include "processing/models/model.hpp"

namespace kolsky {

/// Misfit, as chi2 per degree of freedom, from which on first order says little.
inline constexpr double kFarOff = 3.0;

/// The model's own numbers may have gone far for want of an effect: much misfit shows it, or a
/// modulus that nothing holds any longer.
[[nodiscard]] bool astray(const Model& fitted, const Misfit& misfit);

/// A model that begins where nobody has fitted it: all of a material's moduli that an
/// earlier fit found go back to the library's. A fit that lacked an effect may have led them to
/// where what is added since finds no way back (a specimen's E1 a thousandfold, for want of lateral
/// inertia). So it may have strained what is filed, which goes back to that (a gauge's factor by
/// seventy of its deviations, for want of a gap). What is held or written by hand stays.
/// @return nothing where nothing was fitted before
[[nodiscard]] std::optional<Model> begun_afresh(const Model& model);

}  // namespace kolsky
