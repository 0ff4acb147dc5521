#pragma once

#include "clients/figure/figure.hpp"
#include "processing/reduction/reduction.hpp"

namespace kolsky {

/// Stress over strain of the specimen, engineering.
[[nodiscard]] Panel loop_panel(const Reduction& reduction);

/// Force on the specimen's front and back face over time: they agree in equilibrium.
[[nodiscard]] Panel force_panel(const Reduction& reduction);

[[nodiscard]] Panel strain_rate_panel(const Reduction& reduction);

/// Incident, reflected and transmitted strain at the interfaces.
[[nodiscard]] Panel wave_panel(const Reduction& reduction);

/// All of them on one page, with the bars that were assumed, the band limit and the checks as
/// notes.
[[nodiscard]] Figure reduction_figure(const Reduction& reduction, const std::string& title);

}  // namespace kolsky
