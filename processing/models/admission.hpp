#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/models/model.hpp"

namespace kolsky {

/// Why an effect is not fit to be part of a model.
struct AdmissionProblem {
  std::string check;  ///< "identity", "derivative", "finite", "passivity", "causality", "inverse"
  std::string what;
  std::string mend;
};

/// A bench of ordinary size to check effects on where no bench is at hand: a 2 m bar of 20 mm with
/// three gauges, or two of them around a specimen.
[[nodiscard]] Bench admission_bench(BenchKind kind);

/// Checks an effect beside the library effects of a model, over the bounds of its parameters, from
/// 50 Hz up to where surface gauges go blind, 200 kHz or the bench's Nyquist frequency:
/// - identity: at null it changes nothing, whatever its auxiliary parameters are;
/// - derivative: beside null it changes something, in proportion to its strength;
/// - finite everywhere;
/// - passivity: materials lose energy (Im J <= 0, Re J > 0), waves die away (Re gamma >= 0), ends
///   return no more than they get (|R| <= 1), unless the model without it does no better;
/// - causality: the answer of its stage to a pulse has no part before the pulse, sensors excepted
///   by kSensorLead_s: positions and clocks are relative, a gauge has a length;
/// - inverse: a map from strain to reading rises all over +-5000 microstrain.
/// @return the first problem; none for an effect that passes
[[nodiscard]] std::optional<AdmissionProblem> admission_problem(const Effect& effect,
                                                                const Model& model,
                                                                const Bench& bench);

inline constexpr double kSensorLead_s = 20e-6;

}  // namespace kolsky
