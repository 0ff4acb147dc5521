#include "processing/trigger/crossing.hpp"

#include <algorithm>
#include <cmath>

namespace kolsky {
namespace {

// The climb over the window of the fit, in levels. Wider averages more noise, narrower follows the
// edge.
constexpr double kClimb = 1.0;
constexpr double kGrowth = 1.4;
constexpr int kMostMoves = 3;

struct Window {
  std::size_t first = 0;
  std::size_t points = 0;
};

struct Line {
  double middle = 0.0;  ///< of the window, in samples
  double value = 0.0;   ///< there
  double slope = 0.0;   ///< per sample
};

/// c0 + c1 u + c2 u² + c3 u³ by least squares, u from -1 to 1 over the window. The samples lie
/// evenly about its middle, so even and odd coefficients part into two systems of two.
struct Cubic {
  double middle = 0.0;  ///< of the window, in samples
  double half = 1.0;    ///< half its length, in samples
  double c0 = 0.0, c1 = 0.0, c2 = 0.0, c3 = 0.0;
  double s0 = 0.0, s2 = 0.0, s4 = 0.0, s6 = 0.0;
  double line_slope = 0.0;  ///< of a straight line through the window, per sample

  [[nodiscard]] double at(double u) const { return c0 + u * (c1 + u * (c2 + u * c3)); }
  /// Of the parabola with the same curvature: the cubic's own slope is much noisier.
  [[nodiscard]] double slope_at(double u) const { return line_slope + 2.0 * c2 * u / half; }
  /// Variance of at(u) for white samples of variance one.
  [[nodiscard]] double noise_share_at(double u) const {
    const double u2 = u * u;
    const double even = (s4 - 2.0 * s2 * u2 + s0 * u2 * u2) / (s0 * s4 - s2 * s2);
    const double odd = u2 * (s6 - 2.0 * s4 * u2 + s2 * u2 * u2) / (s2 * s6 - s4 * s4);
    return even + odd;
  }
};

Cubic fit_cubic(std::span<const double> deviation, const Window& window) {
  const auto [first, points] = window;
  Cubic fit;
  fit.half = 0.5 * static_cast<double>(points - 1);
  fit.middle = static_cast<double>(first) + fit.half;
  double t0 = 0.0, t1 = 0.0, t2 = 0.0, t3 = 0.0;
  for (std::size_t i = 0; i < points; ++i) {
    const double u = (static_cast<double>(i) - fit.half) / fit.half;
    const double u2 = u * u;
    const double y = deviation[first + i];
    fit.s0 += 1.0;
    fit.s2 += u2;
    fit.s4 += u2 * u2;
    fit.s6 += u2 * u2 * u2;
    t0 += y;
    t1 += y * u;
    t2 += y * u2;
    t3 += y * u2 * u;
  }
  const double even = fit.s0 * fit.s4 - fit.s2 * fit.s2;
  const double odd = fit.s2 * fit.s6 - fit.s4 * fit.s4;
  fit.c0 = (t0 * fit.s4 - t2 * fit.s2) / even;
  fit.c2 = (t2 * fit.s0 - t0 * fit.s2) / even;
  fit.c1 = (t1 * fit.s6 - t3 * fit.s4) / odd;
  fit.c3 = (t3 * fit.s2 - t1 * fit.s4) / odd;
  fit.line_slope = t1 / fit.s2 / fit.half;
  return fit;
}

Line fit_line(std::span<const double> deviation, const Window& window) {
  const double half = 0.5 * static_cast<double>(window.points - 1);
  double sum = 0.0, moment = 0.0, span = 0.0;
  for (std::size_t i = 0; i < window.points; ++i) {
    const double at = static_cast<double>(i) - half;
    sum += deviation[window.first + i];
    moment += at * deviation[window.first + i];
    span += at * at;
  }
  return {static_cast<double>(window.first) + half, sum / static_cast<double>(window.points),
          moment / span};
}

// The samples about the crossing over which a straight line climbs one level, the crossing in the
// middle. Grows from four; what four noisy samples say of slope and place is not believed until
// more agree.
std::optional<Window> find_window(std::span<const double> deviation, std::size_t guess,
                                  double level, std::size_t reach) {
  const auto widest = static_cast<std::ptrdiff_t>(std::max<std::size_t>(reach, 2));
  const auto size = static_cast<std::ptrdiff_t>(deviation.size());
  std::ptrdiff_t half = 2;
  auto centre = std::clamp(static_cast<std::ptrdiff_t>(guess), half - 1, size - 1 - half);
  std::optional<Window> found;
  for (int moves = 0; 2 * half <= size;) {
    const Window window{static_cast<std::size_t>(centre - half + 1),
                        static_cast<std::size_t>(2 * half)};
    const Line line = fit_line(deviation, window);
    const double climb = line.slope * static_cast<double>(window.points - 1);
    const double away = climb > 0.0 ? (level - line.value) / line.slope : 0.0;
    const double limit = static_cast<double>(half);
    const auto at =
        static_cast<std::ptrdiff_t>(std::floor(line.middle + std::clamp(away, -limit, limit)));
    const std::ptrdiff_t next = std::clamp(at, half - 1, size - 1 - half);
    const bool steep = climb >= kClimb * level;
    // Of the steepest edges a line tells little; the samples on either side of the level tell all.
    const bool caught = steep && half == 2 && deviation[window.first + 1] < level &&
                        deviation[window.first + 2] >= level;
    if (!caught && next != centre && moves++ < kMostMoves) {
      centre = next;
      continue;
    }
    found = window;
    if (steep || half == widest) return found;
    moves = 0;
    const auto grown = static_cast<std::ptrdiff_t>(kGrowth * static_cast<double>(half));
    half = std::min(widest, std::max(half + 1, grown));
    centre = std::clamp(centre, half - 1, std::max(half - 1, size - 1 - half));
  }
  return found;
}

// In the middle half of the window where it is there, else anywhere in it.
std::optional<double> root(const Cubic& fit, double level) {
  for (double reach : {0.5, 1.0}) {
    double low = -reach;
    double high = reach;
    if (fit.at(low) >= level || fit.at(high) <= level) continue;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (fit.at(middle) < level ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }
  return std::nullopt;
}

// An edge that jumps between two samples while their neighbours stand still could lie anywhere
// between.
double unresolved(std::span<const double> deviation, double position, double level) {
  const auto before = static_cast<std::size_t>(position);
  if (before < 1 || before + 2 >= deviation.size()) return 0.0;
  const double jump = deviation[before + 1] - deviation[before];
  if (jump < level) return 0.0;
  const double beside = std::abs(deviation[before] - deviation[before - 1]) +
                        std::abs(deviation[before + 2] - deviation[before + 1]);
  return std::max(0.0, 1.0 - beside / jump) / 12.0;
}

}  // namespace

std::optional<Crossing> fit_crossing(std::span<const double> deviation, std::size_t guess,
                                     double level, std::size_t reach) {
  const std::optional<Window> window = find_window(deviation, guess, level, reach);
  if (!window) return std::nullopt;
  const Cubic fit = fit_cubic(deviation, *window);
  const std::optional<double> u = root(fit, level);
  if (!u || fit.slope_at(*u) <= 0.0) return std::nullopt;
  const double position = fit.middle + *u * fit.half;
  return Crossing{position, fit.slope_at(*u), fit.noise_share_at(*u),
                  unresolved(deviation, position, level), window->points};
}

double block_noise_variance(std::span<double> quiet, std::size_t block, double limit) {
  // A second line makes good what spikes did to the first.
  for (int round = 0; round < 2; ++round) {
    const Line line = fit_line(quiet, {0, quiet.size()});
    for (std::size_t i = 0; i < quiet.size(); ++i) {
      const double along = line.value + line.slope * (static_cast<double>(i) - line.middle);
      quiet[i] = std::clamp(quiet[i] - along, -limit, limit);
    }
  }
  block = std::clamp<std::size_t>(block, 1, quiet.size() / 8);
  const std::size_t count = quiet.size() / block;
  double sum = 0.0, square = 0.0;
  for (std::size_t b = 0; b < count; ++b) {
    double mean = 0.0;
    for (const double sample : quiet.subspan(b * block, block)) mean += sample;
    mean /= static_cast<double>(block);
    sum += mean;
    square += mean * mean;
  }
  const double about_mean = std::max(0.0, square - sum * sum / static_cast<double>(count));
  return about_mean / static_cast<double>(count - 2) * static_cast<double>(block);
}

}  // namespace kolsky
