#pragma once

#include <cstddef>
#include <span>

namespace kolsky {

/// Whether a record rises out of its noise where so many neighbouring samples are averaged that
/// eight means are quiet: a pulse that is no more than a few times the noise, sample by sample.
/// @param quiet  samples before anything comes
[[nodiscard]] bool stands_out_on_average(std::span<const double> record, std::size_t quiet);

}  // namespace kolsky
