#include "clients/report/svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include "clients/figure/layout.hpp"
#include "clients/figure/text_columns.hpp"
#include "clients/report/polyline.hpp"

namespace kolsky {
namespace {

// Okabe and Ito's colours: told apart with any colour vision.
constexpr std::array<std::string_view, 6> kColours = {"#0072b2", "#d55e00", "#009e73",
                                                      "#cc79a7", "#56b4e9", "#e69f00"};

constexpr double kPageMargin = 28.0;
constexpr double kPanelWidth = 560.0;
constexpr double kPanelHeight = 360.0;
constexpr double kTitleHeight = 34.0;
constexpr double kNoteHeight = 18.0;
constexpr double kLegendSample = 22.0;
constexpr double kLegendGap = 14.0;
constexpr double kLegendHeight = 17.0;
constexpr double kCharacterWidth = 6.6;  // of the legend's font, about
constexpr double kTitleCharacter = 8.0;  // of the title's
constexpr double kResolution = 0.25;     // of a line, in page units
constexpr double kBesideFrame = 86.0;    // on its left: marks as long as 1.75e-10, and a title
constexpr double kBeyondFrame = 20.0;    // on its right
constexpr double kPadding = 0.04;        // of the data's span, round the data

struct Frame {
  double left, top, width, height;

  [[nodiscard]] double right() const { return left + width; }
  [[nodiscard]] double bottom() const { return top + height; }
};

AxisRange padded(AxisRange range) {
  const double margin = kPadding * (range.high - range.low);
  return {range.low - margin, range.high + margin};
}

double legend_width(const std::string& name) {
  return kCharacterWidth * static_cast<double>(name.size()) + kLegendSample + 5.0 + kLegendGap;
}

// Series by the lines of the legend above a frame of this width: beside the title where all have
// room there, else on lines of their own.
std::vector<std::vector<std::size_t>> legend_lines(const Panel& panel, double width) {
  std::vector<std::vector<std::size_t>> lines(1);
  if (panel.series.size() < 2) {
    return lines;
  }
  double wanted = kTitleCharacter * static_cast<double>(panel.title.size());
  for (std::size_t i = 0; i < panel.series.size(); ++i) {
    wanted += legend_width(panel.series[i].name);
    lines[0].push_back(i);
  }
  if (wanted <= width) {
    return lines;
  }
  lines = {{}, {}};
  double used = 0.0;
  for (std::size_t i = 0; i < panel.series.size(); ++i) {
    const double own = legend_width(panel.series[i].name);
    if (used + own > width && !lines.back().empty()) {
      lines.emplace_back();
      used = 0.0;
    }
    lines.back().push_back(i);
    used += own;
  }
  return lines;
}

class PanelDrawing {
 public:
  PanelDrawing(const Panel& panel, Frame outer)
      : panel_(panel),
        legend_(legend_lines(panel, outer.width - kBesideFrame - kBeyondFrame)),
        frame_{outer.left + kBesideFrame, outer.top + 34.0 + below_title(),
               outer.width - kBesideFrame - kBeyondFrame, outer.height - 90.0 - below_title()},
        x_(lay_out(panel.x, padded(x_range(panel)), 8)),
        y_(lay_out(panel.y, padded(y_range(panel)), 7)) {}

  [[nodiscard]] std::string text(std::size_t number) const {
    std::string out = grid() + axis_titles() + heading();
    const std::string clip = fmt::format("panel{}", number);
    out += fmt::format(
        "<clipPath id=\"{}\"><rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\"/>"
        "</clipPath>\n<g clip-path=\"url(#{})\">\n",
        clip, frame_.left, frame_.top, frame_.width, frame_.height, clip);
    if (panel_.shaded > 0.0) {
      const double top = page_y(panel_.shaded);
      out += fmt::format(
          "<rect class=\"shaded\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" "
          "height=\"{:.2f}\"/>\n",
          frame_.left, top, frame_.width, page_y(-panel_.shaded) - top);
    }
    for (std::size_t i = 0; i < panel_.series.size(); ++i) {
      out += path(panel_.series[i], kColours.at(i % kColours.size()));
    }
    out += "</g>\n";
    out += fmt::format(
        "<rect class=\"frame\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\"/>\n",
        frame_.left, frame_.top, frame_.width, frame_.height);
    return out;
  }

 private:
  [[nodiscard]] double page_x(double value) const {
    return frame_.left + x_.range.fraction(value) * frame_.width;
  }
  [[nodiscard]] double page_y(double value) const {
    return frame_.bottom() - y_.range.fraction(value) * frame_.height;
  }

  [[nodiscard]] std::string grid() const {
    std::string out;
    for (const AxisMark& mark : x_.marks) {
      const double x = page_x(mark.at);
      out += fmt::format(
          "<line class=\"{}\" x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\"/>"
          "<text class=\"mark\" x=\"{:.2f}\" y=\"{:.2f}\" text-anchor=\"middle\">{}</text>\n",
          mark.at == 0.0 ? "zero" : "grid", x, frame_.top, x, frame_.bottom(), x,
          frame_.bottom() + 17.0, escaped(mark.label));
    }
    for (const AxisMark& mark : y_.marks) {
      const double y = page_y(mark.at);
      out += fmt::format(
          "<line class=\"{}\" x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\"/>"
          "<text class=\"mark\" x=\"{:.2f}\" y=\"{:.2f}\" text-anchor=\"end\">{}</text>\n",
          mark.at == 0.0 ? "zero" : "grid", frame_.left, y, frame_.right(), y, frame_.left - 7.0,
          y + 4.0, escaped(mark.label));
    }
    return out;
  }

  [[nodiscard]] std::string axis_titles() const {
    const double x = frame_.left + 0.5 * frame_.width;
    const double y = frame_.top + 0.5 * frame_.height;
    const double side = frame_.left - 70.0;
    return fmt::format(
        "<text class=\"axis\" x=\"{:.2f}\" y=\"{:.2f}\" text-anchor=\"middle\">{}</text>\n"
        "<text class=\"axis\" x=\"{:.2f}\" y=\"{:.2f}\" text-anchor=\"middle\" "
        "transform=\"rotate(-90 {:.2f} {:.2f})\">{}</text>\n",
        x, frame_.bottom() + 38.0, escaped(x_.title), side, y, side, y, escaped(y_.title));
  }

  [[nodiscard]] double below_title() const {
    return kLegendHeight * static_cast<double>(legend_.size() - 1);
  }

  // Title on the left, legend on the right or below it, both above the frame, so that nothing hides
  // a line.
  [[nodiscard]] std::string heading() const {
    const double top = frame_.top - 10.0 - below_title();
    std::string out = fmt::format("<text class=\"title\" x=\"{:.2f}\" y=\"{:.2f}\">{}</text>\n",
                                  frame_.left, top, escaped(panel_.title));
    for (std::size_t n = 0; n < legend_.size(); ++n) {
      out += legend_line(legend_[n], top + kLegendHeight * static_cast<double>(n));
    }
    return out;
  }

  [[nodiscard]] std::string legend_line(const std::vector<std::size_t>& line, double y) const {
    std::string out;
    double x = frame_.right();
    for (auto own = line.rbegin(); own != line.rend(); ++own) {
      const std::string& name = panel_.series[*own].name;
      x -= kCharacterWidth * static_cast<double>(name.size());
      out += fmt::format("<text class=\"mark\" x=\"{:.2f}\" y=\"{:.2f}\">{}</text>", x, y,
                         escaped(name));
      x -= kLegendSample + 5.0;
      out += fmt::format(
          "<line x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\" stroke=\"{}\" "
          "stroke-width=\"2\"/>\n",
          x, y - 4.0, x + kLegendSample, y - 4.0, kColours.at(*own % kColours.size()));
      x -= kLegendGap;
    }
    return out;
  }

  [[nodiscard]] std::string path(const Series& series, std::string_view colour) const {
    std::string commands;
    std::vector<PagePoint> run;
    const auto flush = [&] {
      char command = 'M';
      for (const PagePoint& point : thinned(run, kResolution)) {
        commands += fmt::format("{}{:.2f} {:.2f}", command, point.x, point.y);
        command = 'L';
      }
      run.clear();
    };
    const std::size_t points = std::min(series.x.size(), series.y.size());
    for (std::size_t i = 0; i < points; ++i) {
      if (std::isfinite(series.x[i]) && std::isfinite(series.y[i])) {
        run.push_back({page_x(series.x[i]), page_y(series.y[i])});
      } else {
        flush();
      }
    }
    flush();
    return commands.empty()
               ? std::string()
               : fmt::format("<path class=\"line\" stroke=\"{}\" d=\"{}\"/>\n", colour, commands);
  }

  const Panel& panel_;
  std::vector<std::vector<std::size_t>> legend_;
  Frame frame_;
  AxisLayout x_;
  AxisLayout y_;
};

constexpr std::string_view kRules =
    "text{font-family:'DejaVu Sans',Verdana,Helvetica,Arial,sans-serif;fill:#222}"
    ".page{font-size:18px;font-weight:bold}"
    ".note{font-size:12px;fill:#555}"
    ".title{font-size:14px;font-weight:bold}"
    ".axis{font-size:13px}"
    ".mark{font-size:12px;fill:#444}"
    ".grid{stroke:#e4e4e4;stroke-width:1}"
    ".zero{stroke:#a8a8a8;stroke-width:1}"
    ".frame{fill:none;stroke:#444;stroke-width:1}"
    ".line{fill:none;stroke-width:1.6;stroke-linejoin:round;stroke-linecap:round}"
    ".shaded{fill:#f0e6c8}";

/// Of the text above the panels; what continues a note is indented.
struct NoteLine {
  double indent = 0.0;
  std::string text;
};

std::vector<NoteLine> note_lines(const std::vector<std::string>& notes, double width) {
  constexpr double kIndent = 16.0;
  const auto columns = static_cast<std::size_t>((width - kIndent) / kCharacterWidth);
  std::vector<NoteLine> lines;
  for (const std::string& note : notes) {
    double indent = 0.0;
    for (std::string& line : wrapped(note, columns)) {
      lines.push_back({indent, std::move(line)});
      indent = kIndent;
    }
  }
  return lines;
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string out;
  for (const char character : text) {
    switch (character) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        // XML has no control characters but tab and line ends.
        if (static_cast<unsigned char>(character) >= 0x20U || character == '\t') {
          out += character;
        }
    }
  }
  return out;
}

std::string panel_style() {
  return std::string(kRules);
}

std::string panel_svg(const Panel& panel, double width, double height, std::size_t number) {
  return fmt::format("<svg viewBox=\"0 0 {0:.0f} {1:.0f}\" role=\"img\" aria-label=\"{2}\">\n",
                     width, height, escaped(panel.title)) +
         PanelDrawing(panel, {0.0, 0.0, width, height}).text(number) + "</svg>\n";
}

std::string render_svg(const Figure& figure) {
  const std::size_t across = figure.panels.size() > 1 ? 2 : 1;
  const std::size_t down = (figure.panels.size() + across - 1) / across;
  const double width = 2.0 * kPageMargin + kPanelWidth * static_cast<double>(across);
  const std::vector<NoteLine> notes = note_lines(figure.notes, width - 2.0 * kPageMargin);
  const double head = kPageMargin + kTitleHeight + kNoteHeight * static_cast<double>(notes.size());
  const double height = head + kPageMargin + kPanelHeight * static_cast<double>(down);
  std::string out = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "viewBox=\"0 0 {0:.0f} {1:.0f}\">\n<title>{2}</title>\n<style>{3}</style>\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
      width, height, escaped(figure.title), kRules);
  out += fmt::format("<text class=\"page\" x=\"{:.2f}\" y=\"{:.2f}\">{}</text>\n", kPageMargin,
                     kPageMargin + 14.0, escaped(figure.title));
  for (std::size_t i = 0; i < notes.size(); ++i) {
    out += fmt::format(
        "<text class=\"note\" x=\"{:.2f}\" y=\"{:.2f}\">{}</text>\n", kPageMargin + notes[i].indent,
        kPageMargin + kTitleHeight + kNoteHeight * static_cast<double>(i), escaped(notes[i].text));
  }
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    const std::size_t row = i / across;
    const Frame outer{kPageMargin + kPanelWidth * static_cast<double>(i % across),
                      head + kPanelHeight * static_cast<double>(row), kPanelWidth, kPanelHeight};
    out += PanelDrawing(figure.panels[i], outer).text(i);
  }
  return out + "</svg>\n";
}

}  // namespace kolsky
