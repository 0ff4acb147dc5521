#include "processing/reduction/cut_off.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "processing/reduction/code_steps.hpp"
#include "processing/reduction/first_pulse.hpp"
#include "processing/reduction/pulse.hpp"

namespace kolsky {

namespace {

using Readings = std::span<const double>;

constexpr std::size_t kLongRun = 8;
constexpr double kSteps = 2.0;
/// An extreme nearer to the record's beginning than this share of the farther one is quiet, not a
/// pulse.
constexpr double kOfTheFarther = 0.25;

/// How far a parabola through the record on either side of a run goes beyond it: of a
/// smooth top less than a step between codes, of one that was cut off what is missing.
/// @param sense  of the extreme, from the record's beginning
double beyond_run(Readings readings, const CutOff& run, double sense) {
  const std::size_t side = std::clamp<std::size_t>(run.count, 8, 16);
  const std::size_t end = run.first + run.count;
  if (run.first < side || end + side > readings.size()) {
    return std::numeric_limits<double>::infinity();
  }
  // As many samples to either side: only even powers tell of the middle.
  const double centre = 0.5 * static_cast<double>(run.count - 1);
  double squares = 0.0;
  double fourths = 0.0;
  double sum = 0.0;
  double sum_of_squares = 0.0;
  for (std::size_t k = 0; k < side; ++k) {
    const double x = (centre + 1.0 + static_cast<double>(k)) / static_cast<double>(side);
    const double both = readings[run.first - 1 - k] + readings[end + k];
    squares += 2.0 * x * x;
    fourths += 2.0 * x * x * x * x;
    sum += both;
    sum_of_squares += x * x * both;
  }
  const double count = 2.0 * static_cast<double>(side);
  const double middle =
      (fourths * sum - squares * sum_of_squares) / (count * fourths - squares * squares);
  return sense * (middle - readings[run.first]);
}

/// Whether a record comes to a run, or leaves it, within a few steps between codes: a pulse that
/// was cut off comes and leaves steeply.
bool level_beside(Readings readings, const CutOff& run, double most) {
  constexpr std::size_t kSide = 8;
  const std::size_t end = run.first + run.count;
  const auto near = [&](std::size_t first) {
    return std::ranges::all_of(readings.subspan(first, kSide), [&](double value) {
      return std::abs(value - readings[run.first]) <= most;
    });
  };
  return (run.first >= kSide && near(run.first - kSide)) ||
         (end + kSide <= readings.size() && near(end));
}

/// Longest run of one code, of those that are asked for.
template <typename Asked>
CutOff longest_run(Readings readings, const Asked& asked) {
  CutOff longest;
  std::size_t run = 0;
  for (std::size_t n = 0; n < readings.size(); ++n) {
    run = n > 0 && readings[n] == readings[n - 1] ? run + 1 : 1;
    if (run > longest.count && asked(readings[n])) {
      longest = {n + 1 - run, run};
    }
  }
  return longest;
}

/// Where the steps are coarse and the noise is less, a smooth top stays at one code too: as the
/// quiet record does.
/// @param other  the record's other extreme: it may be cut off there as well
CutOff cut_off_at(Readings readings, double extreme, double other, double baseline) {
  const CutOff top = longest_run(readings, [&](double value) { return value == extreme; });
  if (top.count < kLongRun || level_beside(readings, top, kSteps * least_step(readings))) {
    return {};
  }
  const double height = std::abs(extreme - baseline);
  const std::vector<double> steps = code_steps(readings);
  if (!steps.empty() &&
      beyond_run(readings, top, std::copysign(1.0, extreme - baseline)) < kSteps * steps.front()) {
    return {};
  }
  const auto stays_longer_than = [&](double from) {
    const std::size_t elsewhere =
        longest_run(readings, [&](double value) {
          return value != extreme && value != other && std::abs(value - baseline) > from;
        }).count;
    return top.count > 3 * elsewhere;
  };
  constexpr double kCoarse = 1.0 / 300.0;
  constexpr double kAnywhere = -1.0;
  const bool coarse = code_step(readings) > kCoarse * height;
  return stays_longer_than(0.5 * height) && (!coarse || stays_longer_than(kAnywhere)) ? top
                                                                                      : CutOff{};
}

}  // namespace

std::optional<CutOff> cut_off(std::span<const double> readings) {
  if (readings.empty()) {
    return std::nullopt;
  }
  const double baseline = quiet_before(readings, kFewestQuiet).baseline;
  const auto [least, most] = std::ranges::minmax(readings);
  const double farther = std::max(most - baseline, baseline - least);
  CutOff longest;
  for (const auto& [extreme, other] : {std::pair{most, least}, std::pair{least, most}}) {
    if (std::abs(extreme - baseline) > kOfTheFarther * farther) {
      const CutOff found = cut_off_at(readings, extreme, other, baseline);
      longest = found.count > longest.count ? found : longest;
    }
  }
  return longest.count > 0 ? std::optional(longest) : std::nullopt;
}

}  // namespace kolsky
