#pragma once

#include <string>
#include <vector>

#include "processing/specimen/specimen_fit.hpp"

namespace kolsky {

/// Four deviations above 1, the deviation being chance's of so many degrees of freedom, or half
/// above it where that is less. Modest misfits of many shots can hide large errors along a number.
[[nodiscard]] bool leaves_more_than_noise(const SpecimenFit& fit);

/// What keeps numbers of a solid from being taken at their word: those that the shots hardly
/// determine, or not at all.
[[nodiscard]] std::vector<std::string> warnings_of(const std::vector<FittedNumber>& parameters);

/// A loss that is clearly negative, where it first is: no passive material does that.
[[nodiscard]] std::vector<std::string> warnings_of(const std::vector<CompliancePoint>& spectrum);

/// Of strain over stress that gives energy back at half of its frequencies or more, where a fit to
/// the records found nothing either: it is bars or gauges that are wrong. Empty for any other.
[[nodiscard]] std::string gives_energy_back(const std::vector<CompliancePoint>& spectrum);

/// Of a family that takes nothing worth having off the chi2 of three elements: what it has more is
/// not determined.
[[nodiscard]] std::string no_more_than_three_elements(const SpecimenFit& fit);

/// Where a three-element solid through strain over stress contradicts that of the direct fit by far
/// more than the deviations of both: which to quote, if any. Empty where it does not.
[[nodiscard]] std::vector<std::string> contradiction(const SpecimenFit& fit,
                                                     const std::vector<FittedNumber>& spectral);

}  // namespace kolsky
