#pragma once

#include <string>
#include <vector>

#include "processing/criticism/fitting/study.hpp"

namespace kolsky {

/// A model fitted by the noise as it is known now, from where its numbers stand.
/// @param theta  in scales, as its composition has them
[[nodiscard]] Studied begun_at(Study& study, const Model& model, std::vector<double> theta);

/// Another model, begun from where one stands.
[[nodiscard]] Studied changed(Study& study, const Studied& current, const Model& model);

[[nodiscard]] Model model_without(const Studied& current, const std::string& id);
/// The fit without an effect, begun from where it stands with it.
[[nodiscard]] Studied without(Study& study, const Studied& current, const std::string& id);

/// What a fit gains over one that lacks some of its numbers, as a square of a normal deviate: a hum
/// of every gauge's own takes a dozen numbers along, each of which fits some noise.
[[nodiscard]] double evidence(const Studied& without, const Studied& with, double noise);

/// Whether a fit is worse for want of what went.
[[nodiscard]] bool missed_in(const Study& study, const Studied& left, const Studied& current);

/// Of chi2, what repeats over what noise leaves of it.
[[nodiscard]] double repeated_excess(const Study& study, const Studied& studied);

}  // namespace kolsky
