#include "clients/figure/layout.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

namespace kolsky {
namespace {

std::vector<std::string> labels_of(const AxisLayout& layout) {
  std::vector<std::string> labels;
  for (const AxisMark& mark : layout.marks) {
    labels.push_back(mark.label);
  }
  return labels;
}

TEST(Layout, MarksARoundRangeAtRoundNumbersInTheUnitPeopleRead) {
  const AxisLayout layout = lay_out({"stress", "Pa"}, {0.0, 30e6}, 4);
  EXPECT_EQ(layout.title, "stress [MPa]");
  EXPECT_EQ(labels_of(layout), (std::vector<std::string>{"0", "10", "20", "30"}));
  EXPECT_DOUBLE_EQ(layout.marks[1].at, 10e6);
}

TEST(Layout, MarksFractionsWithTheDecimalsTheyNeed) {
  const AxisLayout layout = lay_out({"time", "s"}, {-0.4e-6, 1.1e-6}, 5);
  EXPECT_EQ(layout.title, "time [µs]");
  EXPECT_EQ(labels_of(layout), (std::vector<std::string>{"0.0", "0.5", "1.0"}));
}

// Whatever the range: inside it, strictly rising, no label twice, never more than asked for, two at
// least, and the label is the number that stands at the mark.
TEST(Layout, MarksAreHonestForAnyRange) {
  for (const double low : {-3.7e9, -1.0, 0.0, 2.2e-7, 17.3, 9.99e5}) {
    for (const double span : {1e-6, 0.3, 7.0, 4321.0, 6.1e8}) {
      for (const int most : {2, 4, 8}) {
        if (span < 1e-7 * std::abs(low)) {
          continue;
        }
        const AxisRange range{low, low + span};
        const AxisLayout layout = lay_out({"a", "1"}, range, most);
        const std::string place = std::to_string(low) + " + " + std::to_string(span);
        EXPECT_LE(layout.marks.size(), static_cast<std::size_t>(most) + 1) << place;
        std::set<std::string> seen;
        double before = -std::numeric_limits<double>::infinity();
        for (const AxisMark& mark : layout.marks) {
          EXPECT_GE(mark.at, range.low) << place;
          EXPECT_LE(mark.at, range.high) << place;
          EXPECT_GT(mark.at, before) << place;
          before = mark.at;
          if (span > 1e-5 * std::abs(low)) {
            EXPECT_TRUE(seen.insert(mark.label).second) << place << " " << mark.label;
            EXPECT_NEAR(std::stod(mark.label), mark.at, 1e-6 * span + 1e-5 * std::abs(mark.at));
          }
        }
      }
    }
  }
}

TEST(Layout, ChoosesTheUnitByTheLargestMagnitude) {
  EXPECT_EQ(display_unit("Pa", 3.1e9).name, "GPa");
  EXPECT_EQ(display_unit("Pa", 999.0).name, "Pa");
  EXPECT_EQ(display_unit("s", 170e-6).name, "µs");
  EXPECT_EQ(display_unit("V", 0.0).name, "V");
  EXPECT_EQ(display_unit("strain", 0.03).name, "%");
  EXPECT_EQ(display_unit("strain", 0.001).name, "microstrain");
  EXPECT_EQ(display_unit("1/s", 5e4).name, "1/s");
}

TEST(Layout, WritesNumbersWithTheirUnit) {
  EXPECT_EQ(with_unit(31.42e6, "Pa"), "31.42 MPa");
  EXPECT_EQ(with_unit(-0.0315, "strain"), "-3.15 %");
  EXPECT_EQ(with_unit(0.07, "1"), "0.07");
  EXPECT_EQ(with_unit(std::nan(""), "Pa"), "unknown");
  EXPECT_EQ(with_deviation(1.1562e9, 7.766e6, "Pa"), "1.1562 ± 0.0078 GPa");
  EXPECT_EQ(with_deviation(0.1672, 4915e-6, "strain"), "16.72 ± 0.49 %");
  EXPECT_EQ(with_deviation(1750.0, 23.0, "1/s"), "1750 ± 23 1/s");
  EXPECT_EQ(with_deviation(0.07, std::nan(""), "1"), "0.07 ± unknown");
  EXPECT_EQ(with_deviation(0.07, 0.0, "1"), "0.07 ± 0");
}

TEST(Layout, SpansOnlyFinitePointsAndIsNeverEmpty) {
  const double nan = std::nan("");
  const Panel holes{"", {}, {}, {{"", {0.0, nan, 2.0, 5.0}, {1.0, 9.0, 3.0, INFINITY}}}};
  EXPECT_DOUBLE_EQ(x_range(holes).high, 2.0);
  EXPECT_DOUBLE_EQ(y_range(holes).high, 3.0);
  const Panel flat{"", {}, {}, {{"", {0.0, 1.0}, {4.0, 4.0}}}};
  EXPECT_LT(y_range(flat).low, 4.0);
  EXPECT_GT(y_range(flat).high, 4.0);
  const Panel nothing{"", {}, {}, {}};
  EXPECT_LT(x_range(nothing).low, x_range(nothing).high);
}

}  // namespace
}  // namespace kolsky
