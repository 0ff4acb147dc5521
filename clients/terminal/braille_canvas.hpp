#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "clients/terminal/terminal.hpp"

namespace kolsky {

/// A grid of dots drawn with braille characters: two dots wide and four high in each character. Dot
/// (0, 0) is the upper left one.
class BrailleCanvas {
 public:
  /// @pre columns > 0 and rows > 0, in characters
  BrailleCanvas(int columns, int rows);

  [[nodiscard]] int width() const { return 2 * columns_; }  ///< in dots
  [[nodiscard]] int height() const { return 4 * rows_; }    ///< in dots
  [[nodiscard]] int rows() const { return rows_; }

  /// Lights a dot; outside the canvas nothing happens. A character takes the ink of its last dot.
  void dot(int x, int y, Ink ink);

  [[nodiscard]] bool lit(int x, int y) const;

  /// A row of characters, top row first; blanks where no dot is lit.
  [[nodiscard]] std::string row(int row, bool colour) const;

 private:
  struct Cell {
    std::uint8_t dots = 0;
    Ink ink = Ink::plain;
  };
  [[nodiscard]] const Cell& cell(int column, int row) const {
    return cells_[static_cast<std::size_t>(row * columns_ + column)];
  }

  int columns_;
  int rows_;
  std::vector<Cell> cells_;
};

/// Draws a line through points, in dots; it may leave the canvas and come back.
class Pen {
 public:
  /// @param on, off  so many dots lit, so many not, again and again; off = 0: solid
  Pen(BrailleCanvas& canvas, Ink ink, int on = 1, int off = 0)
      : canvas_(canvas), ink_(ink), on_(on), off_(off) {}

  /// From the last point to this one; after `lift` (and at first) just a dot.
  void draw_to(int x, int y);
  void lift() { down_ = false; }

 private:
  void mark(int x, int y);

  BrailleCanvas& canvas_;
  Ink ink_;
  int on_;
  int off_;
  int drawn_ = 0;
  bool down_ = false;
  int x_ = 0;
  int y_ = 0;
};

}  // namespace kolsky
