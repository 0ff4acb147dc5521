// Whoever reads a verdict looks there for what it means.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>

namespace kolsky {
namespace {

const std::filesystem::path kRoot = KOLSKY_SOURCE_DIR;

std::string content(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// As the sources of the reduction name them: check("band", ...), Check check{.name = "band".
std::set<std::string> checks_in_sources() {
  const std::regex named(R"re(\bcheck(?:\(|\{\.name =)\s*"([a-z_]+)")re");
  std::set<std::string> names;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(kRoot / "processing/reduction")) {
    if (entry.path().extension() != ".cpp") {
      continue;
    }
    const std::string text = content(entry.path());
    for (std::sregex_iterator found(text.begin(), text.end(), named), end; found != end; ++found) {
      names.insert((*found)[1]);
    }
  }
  return names;
}

TEST(QualityPage, HoldsEveryCheck) {
  const std::string page = content(kRoot / "docs/quality.md");
  const std::set<std::string> names = checks_in_sources();
  for (const char* known : {"equilibrium", "quiet_start", "restitution_possible", "momentum"}) {
    EXPECT_TRUE(names.contains(known)) << known;
  }
  for (const std::string& name : names) {
    EXPECT_NE(page.find("| `" + name + "` |"), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace kolsky
