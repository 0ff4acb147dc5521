#pragma once

namespace kolsky {

/// Relative loss of a viscoelastic bar's springs by which a deviation of its temperature counts,
/// where nothing better is known. PMMA at room temperature: 0.3 % per kelvin.
inline constexpr double kSofteningPerK = 3e-3;

}  // namespace kolsky
