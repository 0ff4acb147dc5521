#pragma once

#include <cstddef>
#include <vector>

#include "processing/identification/bar_data.hpp"
#include "processing/identification/wide_products.hpp"

namespace kolsky {

/// How many of the lowest bins a fit takes together: those where a bar's retardation shows, to
/// which gauge 0's noise comes back by the far end within the record and ties them to each other.
[[nodiscard]] std::size_t bins_taken_together(const BarData& data, const BarNoise& noise);

/// The factor of the covariance that noise entering during the record gives them, at all gauges but
/// the first: real parts of all gauges before imaginary ones, bin after bin.
/// @param responses  by other gauge, in time, to what gauge 0 reads in the record's first sample
[[nodiscard]] LowerTriangle factor_of_lowest_bins(const BarData& data, const BarNoise& noise,
                                                  const std::vector<std::vector<double>>& responses,
                                                  std::size_t lowest_bins);

}  // namespace kolsky
