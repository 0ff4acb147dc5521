#pragma once

#include <string>

#include "clients/figure/figure.hpp"
#include "processing/impact/impact_history.hpp"

namespace kolsky {

/// Strain rates at points are means over this long, as single elements' rates diverge on the axis
/// with refinement.
inline constexpr double kRateWindow_s = 20e-6;

/// What meshed bars ring above is cut off here in gauge strain.
inline constexpr double kGaugeCutoff_Hz = 50e3;

/// Contact force over time.
[[nodiscard]] Panel contact_force_panel(const impact::ImpactHistory& history);

/// Axial strain rate at the probes, compression positive, over 20 us. @param names  of the probes
[[nodiscard]] Panel probe_rate_panel(const impact::ImpactHistory& history,
                                     const std::vector<std::string>& names);

[[nodiscard]] Panel contact_radius_panel(const impact::ImpactHistory& history);

/// Gauge strain on a meshed bar, low-passed at 50 kHz.
[[nodiscard]] Panel gauge_strain_panel(const impact::ImpactHistory& history,
                                       const std::vector<std::string>& names);

}  // namespace kolsky
