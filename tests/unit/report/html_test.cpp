#include "clients/report/html.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kolsky {
namespace {

Page page() {
  Page page;
  page.title = "a <b> & \"c\"";
  page.headline = "fails at g2";
  PageSection section{"places", {"one paragraph"}, {{"signal", 1.0}, {"noise", 1e-6}}};
  section.maps.push_back({"gauge", "shot", {"g1"}, {"s1", "s2"}, {{1.0, NAN}}});
  section.tables.push_back({{"effect"}, {{"<script>alert(1)</script>"}}});
  Panel panel{"g1", {"time", "s"}, {"strain", "strain"}, {{"measured", {0.0, 1.0}, {0.0, 1e-3}}}};
  panel.shaded = 1e-4;
  section.groups.push_back({"shot 1", true, {panel, panel}});
  page.sections.push_back(section);
  return page;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++n;
  }
  return n;
}

TEST(Html, NeedsNothingElse) {
  const std::string html = render_html(page());
  EXPECT_EQ(count(html, "http"), 0U);
  EXPECT_EQ(count(html, "src="), 0U);
  EXPECT_EQ(count(html, "<script"), 0U);
  EXPECT_EQ(count(html, "@import"), 0U);
}

TEST(Html, WritesMarkupInTextOut) {
  const std::string html = render_html(page());
  EXPECT_NE(html.find("<h1>a &lt;b&gt; &amp; &quot;c&quot;</h1>"), std::string::npos);
  EXPECT_NE(html.find("&lt;script&gt;"), std::string::npos);
}

TEST(Html, ClosesWhatItOpens) {
  const std::string html = render_html(page());
  for (const char* tag : {"section", "table", "details", "svg", "div", "tr", "td"}) {
    EXPECT_EQ(count(html, "<" + std::string(tag) + ">") + count(html, "<" + std::string(tag) + " "),
              count(html, "</" + std::string(tag) + ">"))
        << tag;
  }
}

TEST(Html, HasEveryPanelWithItsShadedBandUnderItsOwnName) {
  const std::string html = render_html(page());
  EXPECT_EQ(count(html, "<svg "), 2U);
  EXPECT_EQ(count(html, "class=\"shaded\""), 2U);
  EXPECT_EQ(count(html, "id=\"panel0\""), 1U);
  EXPECT_EQ(count(html, "id=\"panel1\""), 1U);
}

TEST(Html, LeavesCellsBlankThatHoldNoNumber) {
  const std::string html = render_html(page());
  EXPECT_EQ(count(html, "<td></td>"), 1U);
  EXPECT_EQ(count(html, "nan"), 0U);
}

}  // namespace
}  // namespace kolsky
