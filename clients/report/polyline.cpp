#include "clients/report/polyline.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace kolsky {
namespace {

bool goes_right(const std::vector<PagePoint>& points) {
  return std::is_sorted(points.begin(), points.end(),
                        [](const PagePoint& a, const PagePoint& b) { return a.x < b.x; });
}

std::vector<PagePoint> thinned_by_column(const std::vector<PagePoint>& points, double resolution) {
  std::vector<PagePoint> kept;
  for (std::size_t begin = 0; begin < points.size();) {
    const double column = std::floor(points[begin].x / resolution);
    std::size_t end = begin;
    std::size_t lowest = begin;
    std::size_t highest = begin;
    for (; end < points.size() && std::floor(points[end].x / resolution) == column; ++end) {
      lowest = points[end].y < points[lowest].y ? end : lowest;
      highest = points[end].y > points[highest].y ? end : highest;
    }
    std::array<std::size_t, 4> chosen = {begin, lowest, highest, end - 1};
    std::sort(chosen.begin(), chosen.end());
    const auto* const last = std::unique(chosen.begin(), chosen.end());
    std::for_each(chosen.cbegin(), last, [&](std::size_t i) { kept.push_back(points[i]); });
    begin = end;
  }
  return kept;
}

std::vector<PagePoint> thinned_by_distance(const std::vector<PagePoint>& points,
                                           double resolution) {
  std::vector<PagePoint> kept;
  for (const PagePoint& point : points) {
    if (kept.empty() ||
        std::hypot(point.x - kept.back().x, point.y - kept.back().y) >= resolution) {
      kept.push_back(point);
    }
  }
  return kept;
}

}  // namespace

std::vector<PagePoint> thinned(const std::vector<PagePoint>& points, double resolution) {
  return goes_right(points) ? thinned_by_column(points, resolution)
                            : thinned_by_distance(points, resolution);
}

}  // namespace kolsky
