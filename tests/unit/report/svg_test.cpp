#include "clients/report/svg.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <cmath>
#include <map>
#include <sstream>

#include "clients/report/polyline.hpp"

namespace kolsky {
namespace {

using Tree = boost::property_tree::ptree;

Tree parsed(const std::string& svg) {
  std::istringstream stream(svg);
  Tree tree;
  boost::property_tree::read_xml(stream, tree);
  return tree;
}

void collect(const Tree& tree, const std::string& element, std::vector<Tree>& found) {
  for (const auto& [name, child] : tree) {
    if (name == element) {
      found.push_back(child);
    }
    collect(child, element, found);
  }
}

std::vector<Tree> all(const Tree& tree, const std::string& element) {
  std::vector<Tree> found;
  collect(tree, element, found);
  return found;
}

std::vector<std::string> texts(const Tree& tree) {
  std::vector<std::string> found;
  for (const Tree& text : all(tree, "text")) {
    found.push_back(text.data());
  }
  return found;
}

bool holds(const std::vector<std::string>& texts, const std::string& wanted) {
  return std::find(texts.begin(), texts.end(), wanted) != texts.end();
}

// Of a path that only moves and draws straight lines: "M0 1L2 3".
std::vector<PagePoint> points_of(std::string path) {
  std::replace_if(
      path.begin(), path.end(), [](char c) { return c == 'M' || c == 'L'; }, ' ');
  std::istringstream stream(path);
  std::vector<PagePoint> points;
  for (PagePoint point; stream >> point.x >> point.y;) {
    points.push_back(point);
  }
  EXPECT_TRUE(stream.eof()) << path;
  return points;
}

Figure two_forces() {
  return {"shot <1> & \"more\"",
          {"bars: PMMA"},
          {{"forces",
            {"time", "s"},
            {"force", "N"},
            {{"front", {0.0, 1e-4, 2e-4}, {0.0, 1000.0, 0.0}},
             {"back", {0.0, 1e-4, 2e-4}, {0.0, 500.0, 0.0}}}}}};
}

TEST(Svg, IsWellFormedWithTitlesUnitsAndLegend) {
  const Tree svg = parsed(render_svg(two_forces()));
  EXPECT_EQ(svg.get<std::string>("svg.<xmlattr>.xmlns"), "http://www.w3.org/2000/svg");
  EXPECT_EQ(svg.get<std::string>("svg.title"), "shot <1> & \"more\"");
  const auto written = texts(svg);
  for (const char* wanted : {"shot <1> & \"more\"", "bars: PMMA", "forces", "time [µs]",
                             "force [kN]", "front", "back", "200"}) {
    EXPECT_TRUE(holds(written, wanted)) << wanted;
  }
}

// A letter of the title's font is some 7.8 wide (rsvg-convert, DejaVu Sans Bold of 14).
TEST(Svg, ALegendThatHasNoRoomBesideTheTitleStandsBelowIt) {
  Figure figure = two_forces();
  const auto places = [&] {
    std::map<std::string, PagePoint> found;
    for (const Tree& text : all(parsed(render_svg(figure)), "text")) {
      found[text.data()] = {std::stod(text.get<std::string>("<xmlattr>.x")),
                            std::stod(text.get<std::string>("<xmlattr>.y"))};
    }
    return found;
  };
  auto at = places();
  EXPECT_EQ(at["front"].y, at["forces"].y);
  figure.panels[0].title = "35.65 mm core, friction 0.3";
  figure.panels[0].series = {{"full", {0.0, 1.0}, {0.0, 1.0}},
                             {"bulk-E1", {0.0, 1.0}, {0.0, 1.0}},
                             {"bulk-Einf", {0.0, 1.0}, {0.0, 1.0}},
                             {"exact", {0.0, 1.0}, {0.0, 1.0}}};
  at = places();
  const PagePoint title = at[figure.panels[0].title];
  const double title_end = title.x + 7.8 * static_cast<double>(figure.panels[0].title.size());
  for (const Series& series : figure.panels[0].series) {
    const PagePoint own = at[series.name];
    EXPECT_TRUE(own.y > title.y + 12.0 || own.x - 30.0 > title_end) << series.name;
  }
  EXPECT_LT(at["full"].x, at["exact"].x);
}

// At 12 px a character is 6.6 px wide at most on average.
TEST(Svg, WrapsItsNotesWithinThePage) {
  Figure figure;
  figure.title = "shot";
  figure.panels.resize(2);
  std::string note = "wave_theory:";
  for (int word = 0; word < 80; ++word) {
    note += " word" + std::to_string(word);
  }
  figure.notes = {"short", note};
  const Tree page = parsed(render_svg(figure));
  std::string joined;
  std::map<double, int> lines;
  for (const Tree& text : all(page, "text")) {
    if (text.get<std::string>("<xmlattr>.class", "") != "note") {
      continue;
    }
    const double right =
        text.get<double>("<xmlattr>.x") + 6.6 * static_cast<double>(text.data().size());
    EXPECT_LE(right, page.get<double>("svg.<xmlattr>.width") - 20.0) << text.data();
    ++lines[text.get<double>("<xmlattr>.y")];
    joined += (joined.empty() ? "" : " ") + text.data();
  }
  EXPECT_EQ(joined, "short " + note);
  EXPECT_GT(lines.size(), 3U);
  for (const auto& [y, count] : lines) {
    EXPECT_EQ(count, 1) << y;
  }
}

TEST(Svg, DrawsValuesWhereTheAxisSaysTheyAre) {
  const Tree svg = parsed(render_svg(two_forces()));
  const auto paths = all(svg, "path");
  ASSERT_EQ(paths.size(), 2U);
  const auto front = points_of(paths[0].get<std::string>("<xmlattr>.d"));
  const auto back = points_of(paths[1].get<std::string>("<xmlattr>.d"));
  ASSERT_EQ(front.size(), 3U);
  ASSERT_EQ(back.size(), 3U);
  EXPECT_NEAR(front[1].x - front[0].x, front[2].x - front[1].x, 0.02);
  EXPECT_NEAR((front[0].y - front[1].y) / (back[0].y - back[1].y), 2.0, 1e-3);
  // Marks are written at the height of their grid line: the one of 1 kN goes through the front's
  // peak.
  double one_kN = NAN;
  for (const Tree& text : all(svg, "text")) {
    if (text.data() == "1.0") {
      one_kN = std::stod(text.get<std::string>("<xmlattr>.y")) - 4.0;
    }
  }
  EXPECT_NEAR(one_kN, front[1].y, 0.02);
}

TEST(Svg, BreaksTheLineAtAMissingPointAndStaysWellFormed) {
  Figure figure = two_forces();
  figure.panels[0].series = {{"f", {0, 1, 2, 3, 4}, {0, 1, NAN, 1, 0}}};
  const auto paths = all(parsed(render_svg(figure)), "path");
  ASSERT_EQ(paths.size(), 1U);
  const auto d = paths[0].get<std::string>("<xmlattr>.d");
  EXPECT_EQ(std::count(d.begin(), d.end(), 'M'), 2);
  EXPECT_EQ(points_of(d).size(), 4U);
}

TEST(Svg, SurvivesAnEmptyFigureAndControlCharacters) {
  EXPECT_NO_THROW(parsed(render_svg({"", {}, {}})));
  EXPECT_NO_THROW(
      parsed(render_svg({"a\x01"
                         "b\x1b[0m",
                         {},
                         {{"", {}, {}, {}}}})));
}

TEST(Thinned, KeepsTheExtremesOfAFineTrace) {
  std::vector<PagePoint> points;
  for (int i = 0; i < 100000; ++i) {
    points.push_back({1e-3 * i, i == 54321 ? 7.0 : std::sin(0.01 * i)});
  }
  const auto kept = thinned(points, 0.25);
  EXPECT_LE(kept.size(), 1604U);
  EXPECT_GE(kept.size(), 400U);
  const auto highest =
      std::max_element(kept.begin(), kept.end(), [](auto& a, auto& b) { return a.y < b.y; });
  EXPECT_DOUBLE_EQ(highest->y, 7.0);
  EXPECT_DOUBLE_EQ(kept.front().x, 0.0);
  EXPECT_DOUBLE_EQ(kept.back().x, points.back().x);
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end(), [](auto& a, auto& b) { return a.x < b.x; }));
}

TEST(Thinned, LeavesNoVisibleHoleInALoop) {
  std::vector<PagePoint> points;
  for (int i = 0; i <= 20000; ++i) {
    const double angle = 2.0 * 3.14159265358979 * i / 20000;
    points.push_back({50.0 * std::cos(angle), 50.0 * std::sin(angle)});
  }
  const auto kept = thinned(points, 0.25);
  EXPECT_LT(kept.size(), 1300U);
  for (std::size_t i = 1; i < kept.size(); ++i) {
    EXPECT_LT(std::hypot(kept[i].x - kept[i - 1].x, kept[i].y - kept[i - 1].y), 0.3);
  }
}

}  // namespace
}  // namespace kolsky
