#pragma once

#include <cstddef>
#include <vector>

namespace kolsky {

/// Ends a response where it falls below what the damped transform tells of it: the spectrum's own
/// end leaves ripples of a share of 3e-10 of the peak, which undamping raises. What is before the
/// last sample that stands above them stays as it is.
/// @param growth  of undamping, per sample
/// @param first  the response's first sample in the transform
void end_where_unresolved(std::vector<double>& response, double growth, std::size_t first);

}  // namespace kolsky
