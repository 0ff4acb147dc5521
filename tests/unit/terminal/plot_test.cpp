#include "clients/terminal/plot.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <sstream>

#include "clients/terminal/braille_canvas.hpp"

namespace kolsky {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) {
    lines.push_back(line);
  }
  return lines;
}

TEST(BrailleCanvas, LightsEachDotOfACharacterAsUnicodeNumbersThem) {
  // Unicode chart U2800: dots 1 2 3 7 down the left, 4 5 6 8 down the right, dot n is bit n - 1.
  const char* const left[] = {"⠁", "⠂", "⠄", "⡀"};
  const char* const right[] = {"⠈", "⠐", "⠠", "⢀"};
  for (int y = 0; y < 4; ++y) {
    BrailleCanvas l(1, 1);
    l.dot(0, y, Ink::plain);
    EXPECT_EQ(l.row(0, false), left[y]);
    BrailleCanvas r(1, 1);
    r.dot(1, y, Ink::plain);
    EXPECT_EQ(r.row(0, false), right[y]);
  }
}

TEST(BrailleCanvas, IgnoresDotsOutside) {
  BrailleCanvas canvas(2, 1);
  for (const auto& [x, y] : {std::pair{-1, 0}, {0, -1}, {4, 0}, {0, 4}}) {
    canvas.dot(x, y, Ink::plain);
    EXPECT_FALSE(canvas.lit(x, y));
  }
  EXPECT_EQ(canvas.row(0, false), "  ");
}

TEST(Pen, DrawsEveryDotOfADiagonalAndNoOther) {
  BrailleCanvas canvas(4, 2);
  Pen pen(canvas, Ink::plain);
  pen.draw_to(0, 0);
  pen.draw_to(7, 7);
  for (int x = 0; x < 8; ++x) {
    for (int y = 0; y < 8; ++y) {
      EXPECT_EQ(canvas.lit(x, y), x == y) << x << " " << y;
    }
  }
}

TEST(Pen, DashesByDotsHoweverShortThePieces) {
  BrailleCanvas canvas(8, 1);
  Pen pen(canvas, Ink::plain, 2, 2);
  for (int i = 0; i < 160; ++i) {
    pen.draw_to(i / 10, 0);
  }
  for (int x = 0; x < 16; ++x) {
    EXPECT_EQ(canvas.lit(x, 0), x % 4 < 2) << x;
  }
}

TEST(PlotText, DrawsARisingLineFromCornerToCorner) {
  const Panel panel{"ramp", {"time", "s"}, {"force", "N"}, {{"f", {0.0, 1.0}, {0.0, 30.0}}}};
  // 24 x 12 characters between the axes are 48 x 48 dots: one dot up for each to the right.
  const auto lines = lines_of(plot_text(panel, {29, 12}, false));
  ASSERT_EQ(lines.size(), 16U);
  EXPECT_EQ(lines.front(), "force [N]   ramp");
  EXPECT_EQ(lines[1], " 30 ┤" + std::string(22, ' ') + "⡠⠊");
  EXPECT_TRUE(lines[12].starts_with("  0 ┤⡠⠊")) << lines[12];
  EXPECT_TRUE(lines[13].starts_with("    └┬─")) << lines[13];
  EXPECT_TRUE(lines[13].ends_with("─┬")) << lines[13];
  EXPECT_TRUE(lines[14].starts_with("     0")) << lines[14];
  EXPECT_TRUE(lines[15].ends_with("time [s]"));
}

TEST(PlotText, IsAsWideAsAskedAndNeverWider) {
  const Panel panel{"sine", {"time", "s"}, {"stress", "Pa"}, {{"", {}, {}}}};
  Panel sine = panel;
  for (int i = 0; i < 500; ++i) {
    sine.series[0].x.push_back(1e-6 * i);
    sine.series[0].y.push_back(-123456.0 * std::sin(0.05 * i));
  }
  for (const int columns : {40, 80, 133}) {
    std::size_t widest = 0;
    for (const std::string& line : lines_of(plot_text(sine, {columns, 12}, false))) {
      widest = std::max(widest, columns_of(line));
    }
    EXPECT_EQ(widest, static_cast<std::size_t>(columns));
  }
}

TEST(PlotText, TellsTwoLinesApartWithoutColourAndWithIt) {
  const Panel panel{"forces",
                    {"time", "s"},
                    {"force", "N"},
                    {{"front", {0.0, 1.0}, {0.0, 0.0}}, {"back", {0.0, 1.0}, {1.0, 1.0}}}};
  const auto plain = lines_of(plot_text(panel, {44, 4}, false));
  EXPECT_NE(plain[0].find("─── front"), std::string::npos);
  EXPECT_NE(plain[0].find("╌╌╌ back"), std::string::npos);
  EXPECT_NE(plain[1].find("⠉ ⠉"), std::string::npos) << "the second line is dashed: " << plain[1];
  EXPECT_EQ(plain[4].find("⣀ ⣀"), std::string::npos) << "the first is solid: " << plain[4];
  EXPECT_EQ(plot_text(panel, {44, 4}, false).find('\x1b'), std::string::npos);

  const auto coloured = lines_of(plot_text(panel, {44, 4}, true));
  EXPECT_NE(coloured[1].find("\x1b[33m⠉"), std::string::npos);
  EXPECT_NE(coloured[4].find("\x1b[36m⣀"), std::string::npos);
}

TEST(PlotText, BreaksTheLineWhereAPointIsMissing) {
  const double nan = std::nan("");
  const Panel panel{
      "", {"t", "s"}, {"f", "N"}, {{"", {0.0, 0.2, 0.5, 0.8, 1.0}, {1.0, 1.0, nan, 1.0, 1.0}}}};
  const auto lines = lines_of(plot_text(panel, {30, 3}, false));
  EXPECT_NE(lines[2].find("⠒⠂      "), std::string::npos) << lines[2];
  EXPECT_NE(lines[2].find("      ⠐⠒"), std::string::npos) << lines[2];
}

TEST(PlotText, DrawsAxesEvenWithNothingToDraw) {
  const auto lines = lines_of(plot_text({"empty", {"t", "s"}, {"f", "N"}, {}}, {40, 5}, false));
  EXPECT_EQ(lines.size(), 9U);
}

TEST(EnvelopeText, FillsBetweenTheTracesAndComesInFromTheRight) {
  const std::vector<double> low = {-1.0, 0.0};
  const std::vector<double> high = {1.0, 0.0};
  // Two columns of dots of six: the last character; the left one full, the right one lit in the
  // middle.
  EXPECT_EQ(envelope_text(low, high, {-1.0, 1.0}, {3, 1}, false), "  ⡗\n");
}

TEST(Terminal, CountsColumnsNotBytesNorEscapes) {
  EXPECT_EQ(columns_of("µs"), 2U);
  EXPECT_EQ(columns_of("\x1b[31mbad\x1b[0m"), 3U);
  EXPECT_EQ(padded_left("µ", 3), "  µ");
  EXPECT_EQ(padded_right("µ", 3), "µ  ");
}

TEST(Terminal, WrapsAtWordsByColumns) {
  EXPECT_EQ(wrapped("µs of loading", 5), (std::vector<std::string>{"µs of", "loading"}));
  EXPECT_EQ(wrapped("  a  b\nc ", 80), (std::vector<std::string>{"a b c"}));
  EXPECT_TRUE(wrapped("", 10).empty());
}

TEST(Terminal, APipeIsEightyColumnsWithoutColour) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const Terminal terminal = terminal_of(ends[1]);
  EXPECT_FALSE(terminal.interactive);
  EXPECT_FALSE(terminal.colour);
  EXPECT_EQ(terminal.columns, 80);
  close(ends[0]);
  close(ends[1]);
}

}  // namespace
}  // namespace kolsky
