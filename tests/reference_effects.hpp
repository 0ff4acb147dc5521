#pragma once

#include <array>

namespace kolsky::testing {

/// The effects that the reference defines, without their gauges.
inline constexpr std::array kReferenceEffects{"second-relaxation",
                                              "series-dashpot",
                                              "fractional-damping",
                                              "amplitude-dependence",
                                              "temperature",
                                              "geometric-dispersion",
                                              "end-reflection",
                                              "bending",
                                              "bar-length",
                                              "specimen-dimensions",
                                              "gauge-position",
                                              "gauge-factor",
                                              "channel-delay",
                                              "amplifier-bandwidth",
                                              "baseline-drift",
                                              "gauge-length",
                                              "crosstalk",
                                              "mains-hum",
                                              "bridge-nonlinearity",
                                              "specimen-second-relaxation",
                                              "specimen-nonlinearity",
                                              "specimen-inertia",
                                              "radial-inertia",
                                              "interface-friction",
                                              "interface-gap",
                                              "punching",
                                              "core-nonlinearity",
                                              "cover-nonlinearity",
                                              "core-second-relaxation",
                                              "cover-second-relaxation",
                                              "contact-friction",
                                              "off-centre-contact",
                                              "sabot-contact"};

}  // namespace kolsky::testing
