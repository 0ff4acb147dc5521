#include "clients/terminal/braille_canvas.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace kolsky {
namespace {

// Unicode numbers the dots of a braille character by columns of three; the fourth row came later.
constexpr std::array<std::array<std::uint8_t, 4>, 2> kDotBits = {{
    {0x01, 0x02, 0x04, 0x40},
    {0x08, 0x10, 0x20, 0x80},
}};

std::string braille(std::uint8_t dots) {
  // U+2800 + dots in UTF-8
  return {static_cast<char>(0xE2), static_cast<char>(0xA0 | (dots >> 6U)),
          static_cast<char>(0x80 | (dots & 0x3FU))};
}

}  // namespace

BrailleCanvas::BrailleCanvas(int columns, int rows)
    : columns_(columns), rows_(rows), cells_(static_cast<std::size_t>(columns * rows)) {}

void BrailleCanvas::dot(int x, int y, Ink ink) {
  if (x < 0 || y < 0 || x >= width() || y >= height()) {
    return;
  }
  Cell& target = cells_[static_cast<std::size_t>((y / 4) * columns_ + x / 2)];
  target.dots |= kDotBits.at(static_cast<std::size_t>(x % 2)).at(static_cast<std::size_t>(y % 4));
  target.ink = ink;
}

bool BrailleCanvas::lit(int x, int y) const {
  if (x < 0 || y < 0 || x >= width() || y >= height()) {
    return false;
  }
  return (cell(x / 2, y / 4).dots &
          kDotBits.at(static_cast<std::size_t>(x % 2)).at(static_cast<std::size_t>(y % 4))) != 0;
}

std::string BrailleCanvas::row(int row, bool colour) const {
  std::string text;
  for (int column = 0; column < columns_; ++column) {
    const Cell& shown = cell(column, row);
    text += shown.dots == 0 ? std::string(" ") : inked(braille(shown.dots), shown.ink, colour);
  }
  return text;
}

void Pen::mark(int x, int y) {
  if (drawn_ % (on_ + off_) < on_) {
    canvas_.dot(x, y, ink_);
  }
  ++drawn_;
}

void Pen::draw_to(int x, int y) {
  if (!down_) {
    mark(x, y);
  } else {
    const int steps = std::max(std::abs(x - x_), std::abs(y - y_));
    for (int i = 1; i <= steps; ++i) {
      const double along = static_cast<double>(i) / steps;
      mark(x_ + static_cast<int>(std::lround(along * (x - x_))),
           y_ + static_cast<int>(std::lround(along * (y - y_))));
    }
  }
  down_ = true;
  x_ = x;
  y_ = y;
}

}  // namespace kolsky
