#include "clients/figure/layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

namespace kolsky {
namespace {

constexpr std::array<std::string_view, 7> kPrefixes = {"n", "µ", "m", "", "k", "M", "G"};
constexpr int kNoPrefix = 3;
constexpr double kNearZero = 0.02;  // of the largest value

bool takes_prefix(const std::string& unit) {
  return unit == "Pa" || unit == "N" || unit == "s" || unit == "V" || unit == "Hz" || unit == "m";
}

DisplayUnit prefixed(const std::string& unit, double largest) {
  const int thousands = largest > 0.0 ? static_cast<int>(std::floor(std::log10(largest) / 3.0)) : 0;
  const int prefix = std::clamp(thousands + kNoPrefix, 0, static_cast<int>(kPrefixes.size()) - 1);
  return {std::pow(10.0, -3.0 * (prefix - kNoPrefix)),
          std::string(kPrefixes.at(static_cast<std::size_t>(prefix))) + unit};
}

// 1, 2 or 5 times a power of ten: the smallest that needs no more than `most` marks.
double step_for(double span, int most) {
  const double least = span / std::max(1, most - 1);
  const double decade = std::pow(10.0, std::floor(std::log10(least)));
  for (const double multiple : {1.0, 2.0, 5.0}) {
    if (multiple * decade >= least * (1.0 - 1e-9)) {
      return multiple * decade;
    }
  }
  return 10.0 * decade;
}

std::string label_of(double value, double step) {
  if (std::abs(value) >= 1e6) {
    return fmt::format("{:g}", value);
  }
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  return decimals > 6 ? fmt::format("{:g}", value) : fmt::format("{:.{}f}", value, decimals);
}

template <typename Coordinate>
AxisRange span_of(const Panel& panel, Coordinate coordinate) {
  AxisRange range{std::numeric_limits<double>::infinity(),
                  -std::numeric_limits<double>::infinity()};
  for (const Series& series : panel.series) {
    const std::size_t points = std::min(series.x.size(), series.y.size());
    for (std::size_t i = 0; i < points; ++i) {
      if (std::isfinite(series.x[i]) && std::isfinite(series.y[i])) {
        range.low = std::min(range.low, coordinate(series, i));
        range.high = std::max(range.high, coordinate(series, i));
      }
    }
  }
  if (range.low > range.high) {
    return {0.0, 1.0};
  }
  // Histories begin a fraction of a sample after zero.
  if (range.low > 0.0 && range.low < kNearZero * range.high) {
    range.low = 0.0;
  }
  if (range.high - range.low <= 1e-12 * std::max(std::abs(range.low), std::abs(range.high))) {
    const double margin = range.low == 0.0 ? 1.0 : 0.5 * std::abs(range.low);
    return {range.low - margin, range.high + margin};
  }
  return range;
}

}  // namespace

DisplayUnit display_unit(const std::string& unit, double largest) {
  if (unit == "strain") {
    return largest >= 0.005 ? DisplayUnit{100.0, "%"} : DisplayUnit{1e6, "microstrain"};
  }
  return takes_prefix(unit) ? prefixed(unit, largest) : DisplayUnit{1.0, unit};
}

std::string with_unit(double value, const std::string& unit) {
  if (!std::isfinite(value)) {
    return "unknown";
  }
  const DisplayUnit shown = display_unit(unit, std::abs(value));
  const double number = value * shown.factor;
  const std::string text =
      std::abs(number) >= 1000.0 ? fmt::format("{:.0f}", number) : fmt::format("{:.4g}", number);
  return shown.name.empty() || shown.name == "1" || shown.name == "-" ? text
                                                                      : text + " " + shown.name;
}

std::string with_deviation(double value, double sd, const std::string& unit) {
  if (!std::isfinite(value) || !std::isfinite(sd) || sd <= 0.0) {
    return with_unit(value, unit) + " ± " + with_unit(sd, unit);
  }
  const DisplayUnit shown = display_unit(unit, std::max(std::abs(value), sd));
  const double last_digit = std::floor(std::log10(sd * shown.factor)) - 1.0;
  const int decimals = std::clamp(static_cast<int>(-last_digit), 0, 9);
  const std::string text =
      fmt::format("{:.{}f} ± {:.{}f}", value * shown.factor, decimals, sd * shown.factor, decimals);
  return shown.name.empty() || shown.name == "1" || shown.name == "-" ? text
                                                                      : text + " " + shown.name;
}

AxisLayout lay_out(const Axis& axis, AxisRange range, int most_marks) {
  const DisplayUnit shown =
      display_unit(axis.unit, std::max(std::abs(range.low), std::abs(range.high)));
  const double step = step_for((range.high - range.low) * shown.factor, most_marks);
  const double slack = 1e-9 * step;
  AxisLayout layout{range, {}, axis.name};
  if (!shown.name.empty() && shown.name != "1") {
    layout.title += " [" + shown.name + "]";
  }
  const auto first = std::ceil((range.low * shown.factor - slack) / step);
  const auto last = std::floor((range.high * shown.factor + slack) / step);
  for (double n = first; n <= last; n += 1.0) {
    const double value = n == 0.0 ? 0.0 : n * step;  // never "-0"
    layout.marks.push_back(
        {std::clamp(value / shown.factor, range.low, range.high), label_of(value, step)});
  }
  return layout;
}

AxisRange x_range(const Panel& panel) {
  return span_of(panel, [](const Series& series, std::size_t i) { return series.x[i]; });
}

AxisRange y_range(const Panel& panel) {
  return span_of(panel, [](const Series& series, std::size_t i) { return series.y[i]; });
}

}  // namespace kolsky
