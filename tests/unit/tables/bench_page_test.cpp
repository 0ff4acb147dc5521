// docs/bench-files.md against what is read: its examples, and that it leaves no key out.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "drivers/files/bench_file.hpp"
#include "drivers/files/material_file.hpp"

namespace kolsky {
namespace {

std::string text_of(const std::string& name) {
  std::ifstream file(std::filesystem::path(KOLSKY_SOURCE_DIR) / name);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::vector<std::string> examples() {
  const std::string page = text_of("docs/bench-files.md");
  const std::string fence = "```toml\n";
  std::vector<std::string> list;
  for (std::size_t at = page.find(fence); at != std::string::npos; at = page.find(fence, at)) {
    at += fence.size();
    list.push_back(page.substr(at, page.find("```", at) - at));
  }
  return list;
}

TEST(BenchPage, ItsExamplesAreRead) {
  const std::vector<std::string> list = examples();
  ASSERT_EQ(list.size(), 3U);
  const Bench split = parse_bench(list[0], "page");
  EXPECT_EQ(split.gauges.size(), 2U);
  EXPECT_EQ(split.gauges[0].position_m.sd, 0.0002);

  std::string impact = list[0].substr(0, list[0].find("[bars.output]"));
  impact.replace(impact.find("\"shpb\""), 6, "\"impact\"");
  impact.replace(impact.find("# youngs"), 2, "");
  const std::size_t gauge = list[0].find("[[gauges]]");
  impact += list[0].substr(gauge, list[0].find("[[gauges]]", gauge + 1) - gauge);
  const Bench ball = parse_bench(impact + list[1], "page");
  EXPECT_EQ(ball.photo_sensors.size(), 1U);
  ASSERT_TRUE(ball.striker);

  EXPECT_EQ(parse_material(list[2], "page").E1_Pa.value, 5.66e9);
}

TEST(BenchPage, NamesEveryKey) {
  const std::string page = text_of("docs/bench-files.md");
  int keys = 0;
  for (const char* reader : {"drivers/files/bench_file.cpp", "drivers/files/material_file.cpp"}) {
    const std::string source = text_of(reader);
    const std::regex list("expect\\(\\{([^}]*)\\}\\)");
    const std::regex word("\"([A-Za-z0-9_]+)\"");
    for (std::sregex_iterator lists(source.begin(), source.end(), list), end; lists != end;
         ++lists) {
      const std::string words = (*lists)[1];
      for (std::sregex_iterator key(words.begin(), words.end(), word); key != end; ++key) {
        ++keys;
        EXPECT_NE(page.find((*key)[1].str()), std::string::npos) << (*key)[1];
      }
    }
  }
  EXPECT_GT(keys, 40);
}

}  // namespace
}  // namespace kolsky
