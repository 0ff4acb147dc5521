#include "clients/report/cascade_svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clients/report/svg.hpp"

namespace kolsky {

namespace {

constexpr double kLeft = 74.0;
constexpr double kTop = 46.0;
constexpr double kPlotHeight = 300.0;
constexpr double kFoot = 64.0;
constexpr double kRight = 120.0;
constexpr double kColumn = 150.0;
constexpr double kBar = 84.0;
constexpr double kHeadroom = 1.6;  ///< above the highest level, as a ratio
constexpr double kFootroom = 2.0;  ///< below the floor

constexpr const char* kStyle =
    "<style>.cascade text{font:12px 'DejaVu Sans',Verdana,Helvetica,Arial,sans-serif;fill:#222}"
    ".cascade .title{font-size:14px;font-weight:600}.cascade .small{font-size:11px;fill:#666}"
    ".cascade .grid{stroke:#e4e4e0}.cascade .left{fill:#0072b2}.cascade .gone{fill:#f3c38b}"
    ".cascade .link{stroke:#888;stroke-dasharray:2 3}"
    ".cascade .floor{stroke:#009e73;stroke-width:2;stroke-dasharray:7 4}"
    ".cascade .floorname{fill:#007a59}</style>\n";

class Drawing {
 public:
  explicit Drawing(const Cascade& cascade) : cascade_(cascade) {
    high_ = cascade.floor;
    low_ = cascade.floor;
    for (const Cascade::Step& step : cascade.steps) {
      high_ = std::max(high_, step.level);
      low_ = std::min(low_, step.level);
    }
    high_ *= kHeadroom;
    low_ /= kFootroom;
  }

  [[nodiscard]] std::string text() const {
    const double width = kLeft + kColumn * static_cast<double>(cascade_.steps.size()) + kRight;
    const double height = kTop + kPlotHeight + kFoot;
    std::string out = fmt::format(
        "<svg class=\"cascade\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} "
        "{1:.0f}\" style=\"max-width:{0:.0f}px\" role=\"img\">\n",
        width, height);
    out += kStyle;
    out += fmt::format("<text class=\"title\" x=\"{:.0f}\" y=\"24\">{}</text>\n", kLeft - 54.0,
                       escaped(cascade_.title));
    out += grid(width - kRight);
    for (std::size_t i = 0; i < cascade_.steps.size(); ++i) {
      out += column(i);
    }
    const double floor = page_y(cascade_.floor);
    out += fmt::format(
        "<line class=\"floor\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>"
        "<text class=\"floorname\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n",
        kLeft, floor, width - kRight, floor, width - kRight + 6.0, floor + 4.0,
        escaped(cascade_.floor_name));
    return out + "</svg>\n";
  }

 private:
  [[nodiscard]] double page_y(double level) const {
    return kTop + kPlotHeight * std::log(high_ / level) / std::log(high_ / low_);
  }

  [[nodiscard]] std::string grid(double right) const {
    std::string out;
    const bool narrow = high_ / low_ < 100.0;
    for (int decade = static_cast<int>(std::floor(std::log10(low_)));
         decade <= static_cast<int>(std::ceil(std::log10(high_))); ++decade) {
      for (const double digit : {1.0, 2.0, 5.0}) {
        const double level = digit * std::pow(10.0, decade);
        if (level < low_ || level > high_ || (digit != 1.0 && !narrow)) {
          continue;
        }
        const double y = page_y(level);
        out += fmt::format(
            "<line class=\"grid\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>"
            "<text class=\"small\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{:g}</text>\n",
            kLeft, y, right, y, kLeft - 8.0, y + 4.0, level);
      }
    }
    const double middle = kTop + 0.5 * kPlotHeight;
    return out + fmt::format(
                     "<text class=\"small\" transform=\"rotate(-90 20 {0:.1f})\" x=\"20\" "
                     "y=\"{0:.1f}\" text-anchor=\"middle\">{1}</text>\n",
                     middle, escaped(cascade_.quantity));
  }

  [[nodiscard]] std::string column(std::size_t i) const {
    const Cascade::Step& step = cascade_.steps[i];
    const double centre = kLeft + kColumn * (static_cast<double>(i) + 0.5);
    const double x = centre - 0.5 * kBar;
    const double bottom = kTop + kPlotHeight;
    const double y = page_y(step.level);
    std::string out = fmt::format(
        "<rect class=\"left\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>\n", x,
        y, kBar, bottom - y);
    if (i > 0) {
      const double before = page_y(cascade_.steps[i - 1].level);
      out += fmt::format(
          "<line class=\"link\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>\n",
          x - kColumn + kBar, before, x + kBar, before);
      if (before < y) {
        out += fmt::format(
            "<rect class=\"gone\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>"
            "\n",
            x, before, kBar, y - before);
      }
    }
    return out + fmt::format(
                     "<text x=\"{0:.1f}\" y=\"{1:.1f}\" text-anchor=\"middle\">{2:.4g}</text>\n"
                     "<text x=\"{0:.1f}\" y=\"{3:.1f}\" text-anchor=\"middle\">{4}</text>\n"
                     "<text class=\"small\" x=\"{0:.1f}\" y=\"{5:.1f}\" text-anchor=\"middle\">{6}"
                     "</text>\n",
                     centre, y - 7.0, step.level, bottom + 20.0, escaped(step.name), bottom + 38.0,
                     escaped(step.note));
  }

  const Cascade& cascade_;
  double high_ = 1.0;
  double low_ = 1.0;
};

}  // namespace

std::string cascade_svg(const Cascade& cascade) {
  return Drawing(cascade).text();
}

}  // namespace kolsky
