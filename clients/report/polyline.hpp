#pragma once

#include <vector>

namespace kolsky {

struct PagePoint {
  double x = 0.0;
  double y = 0.0;
};

/// Leaves out points that cannot be seen. Of points that go on to the right within one column of
/// `resolution`, the first, the lowest, the highest and the last stay; elsewhere a point stays if
/// it is `resolution` or more away from the one before it.
[[nodiscard]] std::vector<PagePoint> thinned(const std::vector<PagePoint>& points,
                                             double resolution);

}  // namespace kolsky
