// Whoever reads a verdict looks there for what it means.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>

#include "tests/unit/page.hpp"

namespace kolsky {
namespace {

/// What stands in quotes right after each place of a word.
void add_quoted_after(const std::string& word, const std::string& text,
                      std::set<std::string>& names) {
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    const std::size_t quote = text.find_first_not_of(" \n", at + word.size());
    if (quote != std::string::npos && text[quote] == '"') {
      names.insert(text.substr(quote + 1, text.find('"', quote + 1) - quote - 1));
    }
  }
}

/// As the sources of the reduction name them: check("band", ...), Check check{.name = "band".
std::set<std::string> checks_in_sources() {
  std::set<std::string> names;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(testing::kProject / "processing/reduction")) {
    if (entry.path().extension() == ".cpp") {
      const std::string text = testing::content(entry.path());
      add_quoted_after("check(", text, names);
      add_quoted_after("check{.name =", text, names);
    }
  }
  return names;
}

TEST(QualityPage, HoldsEveryCheck) {
  const std::string page = testing::page("docs/quality.md");
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
