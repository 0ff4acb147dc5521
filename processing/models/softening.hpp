#pragma once

namespace kolsky {

/// Relative loss of E1 and E2 of a viscoelastic bar by which a deviation of its temperature counts,
/// where nothing better is known. PMMA at room temperature: 0.3 % per kelvin.
inline constexpr double kSofteningPerK = 3e-3;

}  // namespace kolsky
