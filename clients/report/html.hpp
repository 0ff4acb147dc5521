#pragma once

#include <string>
#include <vector>

#include "clients/figure/figure.hpp"

namespace kolsky {

struct PageTable {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

/// Numbers over two lists of names, shown as colours: pale at `calm`, deep from `alarm` on, on a
/// scale of ratios. What is not finite stays blank.
struct HeatMap {
  std::string rows_name;
  std::string columns_name;
  std::vector<std::string> rows;
  std::vector<std::string> columns;
  std::vector<std::vector<double>> values;  ///< by row and column
  double calm = 1.0;
  double alarm = 10.0;
};

/// Shares of a whole over many decades, as bars on a logarithmic scale.
struct ShareBar {
  std::string name;
  double share = 0.0;  ///< 0 to 1
};

/// What can be folded away: panels under one heading.
struct PanelGroup {
  std::string title;
  bool open = false;
  std::vector<Panel> panels;  ///< two by two
};

struct PageSection {
  std::string title;
  std::vector<std::string> text;  ///< paragraphs
  std::vector<ShareBar> bars{};
  std::vector<HeatMap> maps{};
  std::vector<PageTable> tables{};
  std::vector<PanelGroup> groups{};
  std::vector<std::string> pictures{};  ///< <svg> elements, as they are
};

/// Prose may have commands between backquotes.
struct Page {
  std::string title;
  std::string headline;            ///< what the page has to say, in a sentence
  bool good = false;               ///< whether that is good news
  std::vector<std::string> notes;  ///< smaller print below
  std::vector<PageSection> sections;
};

/// One HTML file that needs nothing else: no network, no script.
[[nodiscard]] std::string render_html(const Page& page);

}  // namespace kolsky
