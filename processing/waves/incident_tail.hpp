#pragma once

#include <span>
#include <vector>

#include "processing/base/bench.hpp"
#include "processing/waves/compliance.hpp"

namespace kolsky {

/// What still passes a gauge on a lossy bar when the striker has let go: the record up to then is
/// carried back to the struck end, where it is the striker's push, which is over, and forward again
/// from its stress. Elementary waves: a tail is slow.
/// @param record  compression or tension, in any unit that is proportional to strain; baseline off
/// @param known   samples in which nothing else has reached the gauge, and after which nothing
///   pushes any more at the struck end
/// @param way_m   from the struck end to the gauge
/// @return as long as the record, 0 before `known`
[[nodiscard]] std::vector<double> incident_tail(std::span<const double> record, std::size_t known,
                                                const Bar& bar, const Compliance& compliance,
                                                double way_m, double period_s);

}  // namespace kolsky
