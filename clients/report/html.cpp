#include "clients/report/html.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "clients/report/svg.hpp"

namespace kolsky {

namespace {

constexpr double kPanelWidth = 560.0;
constexpr double kPanelHeight = 300.0;
constexpr double kFewestDecades = 3.0;

constexpr std::string_view kRules =
    "html{color-scheme:light}"
    "body{margin:0;background:#f6f6f4;color:#222;"
    "font:15px/1.5 'DejaVu Sans',Verdana,Helvetica,Arial,sans-serif}"
    "main{max-width:1180px;margin:0 auto;padding:28px 24px 60px}"
    "h1{font-size:21px;margin:0 0 4px}h2{font-size:17px;margin:0 0 10px}"
    ".headline{font-size:18px;margin:14px 0;padding:12px 16px;border-radius:6px;"
    "background:#fbe9e0;border-left:5px solid #d55e00}"
    ".headline.good{background:#e2f3ec;border-color:#009e73}"
    ".small{font-size:13px;color:#555;margin:2px 0}"
    "section{background:#fff;border:1px solid #e2e2de;border-radius:8px;padding:18px 20px;"
    "margin:18px 0}"
    "p{margin:6px 0;max-width:80ch}"
    "table{border-collapse:collapse;font-size:13px;margin:10px 0}"
    "th,td{padding:4px 10px;text-align:left;border-bottom:1px solid #ececea;white-space:nowrap}"
    "th{font-weight:600;color:#555}td{font-variant-numeric:tabular-nums}"
    ".maps{display:flex;flex-wrap:wrap;gap:10px 36px}.scroll{overflow-x:auto}"
    ".map td{min-width:44px;text-align:center;border:2px solid #fff;border-radius:4px}"
    ".map th{border:0}.map caption{text-align:left;font-size:13px;color:#555}"
    ".bar{display:grid;grid-template-columns:minmax(180px,1fr) 3fr 90px;gap:10px;"
    "align-items:center;font-size:13px;margin:4px 0}"
    ".bar i{display:block;height:14px;border-radius:3px;background:#0072b2}"
    ".panels{display:grid;grid-template-columns:repeat(auto-fit,minmax(420px,1fr));gap:4px 12px}"
    "summary{cursor:pointer;font-weight:600;padding:6px 0}svg{width:100%;height:auto}"
    "@media print{body{background:#fff}section{break-inside:avoid}}";

/// Prose; what stands between backquotes, as commands do in a terminal's texts, is set as code.
std::string prose(const std::string& text) {
  std::string out;
  bool code = false;
  for (const char c : escaped(text)) {
    if (c != '`') {
      out += c;
      continue;
    }
    out += code ? "</code>" : "<code>";
    code = !code;
  }
  return code ? out + "</code>" : out;
}

std::string table_html(const PageTable& table) {
  std::string out = "<div class=\"scroll\"><table><tr>";
  for (const std::string& name : table.header) {
    out += "<th>" + escaped(name) + "</th>";
  }
  out += "</tr>\n";
  for (const auto& row : table.rows) {
    out += "<tr>";
    for (const std::string& cell : row) {
      out += "<td>" + escaped(cell) + "</td>";
    }
    out += "</tr>\n";
  }
  return out + "</table></div>\n";
}

/// From a pale to a deep orange, told apart in grey as well.
std::string cell_html(double value, const HeatMap& map) {
  if (!std::isfinite(value)) {
    return "<td></td>";
  }
  const double depth = std::clamp(
      std::log(std::max(value, 1e-12) / map.calm) / std::log(map.alarm / map.calm), 0.0, 1.0);
  const auto mix = [&](double pale, double deep) {
    return static_cast<int>(std::lround(pale + depth * (deep - pale)));
  };
  return fmt::format("<td style=\"background:#{:02x}{:02x}{:02x};color:{}\">{}</td>", mix(244, 178),
                     mix(244, 60), mix(240, 8), depth > 0.6 ? "#fff" : "#222",
                     value < 100.0 ? fmt::format("{:.3g}", value) : fmt::format("{:.0f}", value));
}

std::string map_html(const HeatMap& map) {
  std::string out = "<div class=\"scroll\"><table class=\"map\"><caption>" +
                    escaped(map.rows_name + " × " + map.columns_name) + "</caption><tr><th></th>";
  for (const std::string& name : map.columns) {
    out += "<th>" + escaped(name) + "</th>";
  }
  out += "</tr>\n";
  for (std::size_t r = 0; r < map.rows.size(); ++r) {
    out += "<tr><th>" + escaped(map.rows[r]) + "</th>";
    for (const double value : map.values[r]) {
      out += cell_html(value, map);
    }
    out += "</tr>\n";
  }
  return out + "</table></div>\n";
}

std::string bars_html(const std::vector<ShareBar>& bars) {
  double decades = kFewestDecades;
  for (const ShareBar& bar : bars) {
    if (bar.share > 0.0) {
      decades = std::max(decades, std::ceil(-std::log10(bar.share)) + 1.0);
    }
  }
  std::string out;
  for (const ShareBar& bar : bars) {
    const double length =
        bar.share > 0.0 ? std::clamp(1.0 + std::log10(bar.share) / decades, 0.0, 1.0) : 0.0;
    out += fmt::format(
        "<div class=\"bar\"><span>{}</span><i style=\"width:{:.1f}%\"></i><span>{} %</span>"
        "</div>\n",
        escaped(bar.name), 100.0 * length,
        bar.share < 0.995 ? fmt::format("{:.2g}", 100.0 * bar.share) : "100");
  }
  return bars.empty() ? out : out + "<p class=\"small\">bars on a logarithmic scale</p>\n";
}

}  // namespace

std::string render_html(const Page& page) {
  std::size_t panels = 0;
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>{}</title>\n"
      "<style>{}{}</style></head>\n<body><main>\n<h1>{}</h1>\n",
      escaped(page.title), panel_style(), kRules, escaped(page.title));
  out += fmt::format("<p class=\"headline{}\">{}</p>\n", page.good ? " good" : "",
                     prose(page.headline));
  for (const std::string& note : page.notes) {
    out += "<p class=\"small\">" + prose(note) + "</p>\n";
  }
  for (const PageSection& section : page.sections) {
    out += "<section><h2>" + escaped(section.title) + "</h2>\n";
    for (const std::string& paragraph : section.text) {
      out += "<p>" + prose(paragraph) + "</p>\n";
    }
    for (const std::string& picture : section.pictures) {
      out += picture;
    }
    out += bars_html(section.bars);
    if (!section.maps.empty()) {
      out += "<div class=\"maps\">\n";
      for (const HeatMap& map : section.maps) {
        out += map_html(map);
      }
      out += "</div>\n";
    }
    for (const PageTable& table : section.tables) {
      out += table_html(table);
    }
    for (const PanelGroup& group : section.groups) {
      out += fmt::format("<details{}><summary>{}</summary><div class=\"panels\">\n",
                         group.open ? " open" : "", escaped(group.title));
      for (const Panel& panel : group.panels) {
        out += "<div>" + panel_svg(panel, kPanelWidth, kPanelHeight, panels++) + "</div>\n";
      }
      out += "</div></details>\n";
    }
    out += "</section>\n";
  }
  return out + "</main></body></html>\n";
}

}  // namespace kolsky
