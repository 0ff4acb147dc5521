#pragma once

#include <complex>
#include <functional>
#include <span>
#include <vector>

namespace kolsky {

/// A memoryless map from strain to what was recorded, as an analytic function. Over the strains of
/// a record it rises.
using RecordMap = std::function<void(std::span<const std::complex<double>> strain,
                                     std::span<std::complex<double>> reading)>;

/// Readings become the strains that the map makes them of. The map is tabulated over twice the
/// record's range and read backwards by cubic interpolation; its slopes are exact (derivative along
/// the imaginary axis), so that the error falls with the fourth power of the table's step. What no
/// strain of the table maps to takes the table's last slope.
void undo(const RecordMap& map, std::vector<double>& record);

}  // namespace kolsky
