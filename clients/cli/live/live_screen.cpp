#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "clients/cli/live/live_view.hpp"
#include "clients/cli/reports/daemon_text.hpp"
#include "clients/figure/ball_figure.hpp"
#include "clients/figure/layout.hpp"
#include "clients/figure/reduction_figure.hpp"
#include "clients/terminal/plot.hpp"

namespace kolsky::cli {
namespace {

constexpr int kTraceRows = 2;
constexpr int kShotRows = 4;
constexpr int kLeastLoopRows = 6;
constexpr int kLoopFrame = 4;       // lines of a plot that are not its area
constexpr double kLeastBand = 6.0;  // a trace of noise alone fills about a third of its rows

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) {
    lines.push_back(line);
  }
  return lines;
}

// The line as far as the terminal goes: a longer one would break the screen.
std::string cut(const std::string& line, int columns) {
  if (columns_of(line) <= static_cast<std::size_t>(columns)) {
    return line;
  }
  std::string kept;
  std::size_t end = 0;
  while (end < line.size()) {
    std::size_t next = end + 1;
    while (next < line.size() && (static_cast<unsigned char>(line[next]) & 0xC0U) == 0x80U) {
      ++next;
    }
    if (columns_of(line.substr(0, next)) > static_cast<std::size_t>(columns)) {
      break;
    }
    end = next;
  }
  kept = line.substr(0, end);
  return line.find('\x1b') == std::string::npos ? kept : kept + "\x1b[0m";
}

AxisRange range_of(const std::vector<double>& minimum, const std::vector<double>& maximum,
                   double noise_rms) {
  const double low = *std::min_element(minimum.begin(), minimum.end());
  const double high = *std::max_element(maximum.begin(), maximum.end());
  const double middle = 0.5 * (low + high);
  const double half = std::max({0.5 * (high - low), kLeastBand * noise_rms,
                                1e-12 * std::max(std::abs(low), std::abs(high)), 1e-300});
  return {middle - half, middle + half};
}

std::string view_text(AxisRange range, const std::string& unit, double span_s) {
  const DisplayUnit shown = display_unit(unit, std::max(std::abs(range.low), std::abs(range.high)));
  return fmt::format(" · {}: {:.3g} to {:.3g} {}", with_unit(span_s, "s"), range.low * shown.factor,
                     range.high * shown.factor, shown.name);
}

template <typename Lines>
void append(std::vector<std::string>& to, const Lines& lines) {
  to.insert(to.end(), lines.begin(), lines.end());
}

}  // namespace

std::vector<std::string> LiveView::trace_lines(const Terminal& terminal) const {
  std::vector<std::string> lines;
  for (const v1::ChannelStatus& channel : status_.channels()) {
    std::string label = channel_line(channel);
    const auto trace = traces_.find(channel.gauge());
    if (trace == traces_.end() || trace->second.minimum.empty()) {
      lines.push_back(label);
      continue;
    }
    const std::vector<double> low(trace->second.minimum.begin(), trace->second.minimum.end());
    const std::vector<double> high(trace->second.maximum.begin(), trace->second.maximum.end());
    const AxisRange range = range_of(low, high, channel.noise_rms());
    lines.push_back(label + view_text(range, trace->second.unit,
                                      trace->second.step_s * static_cast<double>(low.size())));
    append(lines, lines_of(envelope_text(low, high, range, {terminal.columns, kTraceRows},
                                         terminal.colour)));
  }
  return lines;
}

std::vector<std::string> LiveView::shot_lines(const Terminal& terminal) const {
  std::vector<std::string> lines;
  if (shots_.empty()) {
    lines.emplace_back("no shots yet");
  }
  for (const v1::ShotSummary& shot : shots_) {
    if (lines.size() == kShotRows) {
      break;
    }
    lines.push_back(shot_line(shot, terminal.colour));
  }
  return lines;
}

std::vector<std::string> LiveView::loop_lines(const Terminal& terminal, int rows) const {
  if (!last_loop_.has_value() || rows < kLeastLoopRows + kLoopFrame) {
    return {};
  }
  const Reduction& reduction = last_loop_->reduction;
  Panel panel = reduction.ball ? ball_force_panel(*reduction.ball) : loop_panel(reduction);
  panel.title = last_loop_->shot_id;
  return lines_of(
      plot_text(panel, {std::min(terminal.columns, 100), rows - kLoopFrame}, terminal.colour));
}

std::vector<std::string> LiveView::model_lines(bool colour) const {
  std::vector<std::string> lines;
  if (status_.has_comparison()) {
    lines.push_back(comparison_line(status_.comparison(), colour));
  }
  if (status_.has_diagnosis()) {
    lines.push_back(diagnosis_line(status_.diagnosis()));
  }
  return lines;
}

std::string LiveView::loss_line(bool colour) const {
  std::string text = fmt::format("messages lost on the way here: {}", lost_messages());
  for (const auto& [topic, count] : lost_) {
    text += fmt::format(" ({} of {})", count, topic);
  }
  if (lost_messages() > 0) {
    text = inked(text, Ink::bad, colour);
  }
  if (restarts_ > 0) {
    text += fmt::format("; daemon restarts: {}", restarts_);
  }
  return last_fault_.empty() ? text : text + "; last fault " + inked(last_fault_, Ink::bad, colour);
}

std::string LiveView::screen(const Terminal& terminal) const {
  std::vector<std::string> lines = {headline(status_, terminal.colour),
                                    counters_line(status_, terminal.colour), store_line(status_),
                                    loss_line(terminal.colour)};
  append(lines, model_lines(terminal.colour));
  append(lines, trace_lines(terminal));
  append(lines, shot_lines(terminal));
  append(lines, loop_lines(terminal, terminal.rows - static_cast<int>(lines.size()) - 1));
  lines.resize(std::min(lines.size(), static_cast<std::size_t>(std::max(terminal.rows - 1, 1))));
  std::string text;
  for (const std::string& line : lines) {
    text += cut(line, terminal.columns) + "\n";
  }
  return text;
}

}  // namespace kolsky::cli
