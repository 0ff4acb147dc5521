// docs/bench-files.md against what is read: its examples, and that it leaves no key out.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "drivers/files/settings/bench_file.hpp"
#include "drivers/files/settings/material_file.hpp"

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

  EXPECT_EQ(parse_material(list[2], "page").E1_Pa().value, 5.66e9);
}

/// The words in quotes within every list of keys that a reader expects.
std::vector<std::string> keys_of(const std::string& source) {
  const std::string list = "expect({";
  std::vector<std::string> keys;
  for (std::size_t at = source.find(list); at != std::string::npos; at = source.find(list, at)) {
    const std::size_t end = source.find('}', at += list.size());
    for (std::size_t open = source.find('"', at); open < end; open = source.find('"', at)) {
      at = source.find('"', open + 1);
      keys.push_back(source.substr(open + 1, at - open - 1));
      ++at;
    }
    at = end;
  }
  return keys;
}

TEST(BenchPage, NamesEveryKey) {
  const std::string page = text_of("docs/bench-files.md");
  std::size_t keys = 0;
  for (const char* reader :
       {"drivers/files/settings/bench_file.cpp", "drivers/files/settings/material_file.cpp"}) {
    for (const std::string& key : keys_of(text_of(reader))) {
      ++keys;
      EXPECT_NE(page.find(key), std::string::npos) << key;
    }
  }
  EXPECT_GT(keys, 40U);
}

}  // namespace
}  // namespace kolsky
