#include "clients/terminal/plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "clients/terminal/braille_canvas.hpp"

namespace kolsky {
namespace {

constexpr int kColumnsPerMark = 12;
constexpr int kRowsPerMark = 3;
constexpr int kMostMarks = 8;

struct Dashes {
  int on;
  int off;
  const char* sample;
};

Dashes dashes_of(std::size_t series, bool colour) {
  constexpr std::array<Dashes, 3> kDashes = {{{1, 0, "───"}, {2, 2, "╌╌╌"}, {1, 3, "···"}}};
  return colour ? kDashes.at(0) : kDashes.at(series % kDashes.size());
}

int mark_count(int extent, int per_mark) {
  return std::clamp(extent / per_mark, 2, kMostMarks);
}

// Nearest of `count` places along a range; far outside it stays outside, near enough for integers.
int place(double fraction, int count) {
  return static_cast<int>(std::lround(std::clamp(fraction, -2.0, 3.0) * (count - 1)));
}

void draw(BrailleCanvas& canvas, const Series& series, AxisRange x, AxisRange y, Ink ink,
          Dashes dashes) {
  Pen pen(canvas, ink, dashes.on, dashes.off);
  const std::size_t points = std::min(series.x.size(), series.y.size());
  for (std::size_t i = 0; i < points; ++i) {
    if (std::isfinite(series.x[i]) && std::isfinite(series.y[i])) {
      pen.draw_to(place(x.fraction(series.x[i]), canvas.width()),
                  canvas.height() - 1 - place(y.fraction(series.y[i]), canvas.height()));
    } else {
      pen.lift();
    }
  }
}

std::string heading(const Panel& panel, const AxisLayout& y, bool colour) {
  std::string text = inked(y.title, Ink::bold, colour);
  text += "   " + panel.title;
  if (panel.series.size() > 1) {
    for (std::size_t i = 0; i < panel.series.size(); ++i) {
      text += "   " + inked(dashes_of(i, colour).sample, series_ink(i), colour) + " " +
              panel.series[i].name;
    }
  }
  return text;
}

// The label of each row of the left margin, empty where there is none.
std::vector<std::string> row_labels(const AxisLayout& y, int rows) {
  std::vector<std::string> labels(static_cast<std::size_t>(rows));
  for (const AxisMark& mark : y.marks) {
    const int dots_down = 4 * rows - 1 - place(y.range.fraction(mark.at), 4 * rows);
    labels.at(static_cast<std::size_t>(dots_down / 4)) = mark.label;
  }
  return labels;
}

struct BottomAxis {
  std::string line;
  std::string labels;
};

BottomAxis bottom_axis(const AxisLayout& x, int columns) {
  std::vector<bool> marked(static_cast<std::size_t>(columns), false);
  std::string labels;
  std::size_t written = 0;
  for (const AxisMark& mark : x.marks) {
    const auto column = static_cast<std::size_t>(place(x.range.fraction(mark.at), 2 * columns) / 2);
    const std::size_t half = columns_of(mark.label) / 2;
    const std::size_t start = column > half ? column - half : 0;
    marked.at(column) = true;
    if (written == 0 || start > written) {
      labels += std::string(start - written, ' ') + mark.label;
      written = start + columns_of(mark.label);
    }
  }
  BottomAxis axis{"", labels};
  for (const bool mark : marked) {
    axis.line += mark ? "┬" : "─";
  }
  return axis;
}

std::size_t widest(const std::vector<std::string>& labels) {
  std::size_t width = 0;
  for (const std::string& label : labels) {
    width = std::max(width, columns_of(label));
  }
  return width;
}

}  // namespace

std::string plot_text(const Panel& panel, PlotSize size, bool colour) {
  const int rows = std::max(size.rows, 2);
  const AxisLayout y_axis = lay_out(panel.y, y_range(panel), mark_count(rows, kRowsPerMark));
  const std::vector<std::string> labels = row_labels(y_axis, rows);
  const std::size_t margin = widest(labels) + 1;
  const int columns = std::max(10, size.columns - static_cast<int>(margin) - 2);
  const AxisLayout x_axis = lay_out(panel.x, x_range(panel), mark_count(columns, kColumnsPerMark));

  BrailleCanvas canvas(columns, rows);
  for (std::size_t i = 0; i < panel.series.size(); ++i) {
    draw(canvas, panel.series[i], x_axis.range, y_axis.range, series_ink(i), dashes_of(i, colour));
  }
  std::string text = heading(panel, y_axis, colour) + "\n";
  for (int row = 0; row < rows; ++row) {
    const std::string& label = labels[static_cast<std::size_t>(row)];
    text +=
        padded_left(label, margin) + (label.empty() ? " │" : " ┤") + canvas.row(row, colour) + "\n";
  }
  const BottomAxis bottom = bottom_axis(x_axis, columns);
  const std::string indent(margin + 2, ' ');
  text += std::string(margin + 1, ' ') + "└" + bottom.line + "\n" + indent + bottom.labels + "\n";
  const std::size_t title = columns_of(x_axis.title);
  const auto width = static_cast<std::size_t>(columns);
  text += indent + std::string(width > title ? width - title : 0, ' ') +
          inked(x_axis.title, Ink::bold, colour) + "\n";
  return text;
}

std::string envelope_text(std::span<const double> minimum, std::span<const double> maximum,
                          AxisRange range, PlotSize size, bool colour) {
  BrailleCanvas canvas(std::max(1, size.columns), std::max(1, size.rows));
  const std::size_t pairs = std::min(minimum.size(), maximum.size());
  const auto width = static_cast<std::size_t>(canvas.width());
  for (std::size_t i = 0; i < pairs; ++i) {
    // Fewer pairs than dots: they fill in from the right.
    const std::size_t x = pairs >= width ? i * width / pairs : width - pairs + i;
    const int top = canvas.height() - 1 - place(range.fraction(maximum[i]), canvas.height());
    const int bottom = canvas.height() - 1 - place(range.fraction(minimum[i]), canvas.height());
    for (int y = std::max(top, 0); y <= std::min(bottom, canvas.height() - 1); ++y) {
      canvas.dot(static_cast<int>(x), y, Ink::first);
    }
  }
  std::string text;
  for (int row = 0; row < canvas.rows(); ++row) {
    text += canvas.row(row, colour) + "\n";
  }
  return text;
}

}  // namespace kolsky
