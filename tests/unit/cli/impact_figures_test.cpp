// The paper's figures, on meshes that take a second.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>

#include "clients/cli/reports/impact_run.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/unit/impact/paper_ball.hpp"

namespace kolsky::cli {
namespace {

std::size_t count_of(const std::string& words, const std::string& text) {
  std::size_t count = 0;
  for (std::size_t at = text.find(words); at != std::string::npos;
       at = text.find(words, at + words.size())) {
    ++count;
  }
  return count;
}

class Figures : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = std::make_unique<testing::ScratchFolder>();
    folder_ = scratch_->path() / "figures";
    said_ = write_paper_figures(testing::paper_bench(), {testing::paper_core()},
                                {testing::paper_cover()}, folder_.string(), {240, 512});
  }
  static void TearDownTestSuite() { scratch_.reset(); }

  static std::string text_of(const std::string& name) {
    std::ifstream file(folder_ / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  inline static std::unique_ptr<testing::ScratchFolder> scratch_;
  inline static std::filesystem::path folder_;
  inline static std::string said_;
};

TEST_F(Figures, AreFiveAndATable) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    names.push_back(entry.path().filename());
  }
  std::ranges::sort(names);
  EXPECT_EQ(names, (std::vector<std::string>{"fig11.svg", "fig12.svg", "fig13.svg", "fig14.svg",
                                             "fig15.svg", "table.md"}));
}

/// Two cores, four readings and three speeds; less friction of three sizes at three speeds.
TEST_F(Figures, TheTableHasARowForEveryImpactAndTheTrends) {
  const std::string table = text_of("table.md");
  EXPECT_EQ(said_.find(table), 0U) << "what is printed is what is filed";
  EXPECT_NE(table.find("Of 240 elements; in brackets what 512 elements change"), std::string::npos);
  EXPECT_EQ(count_of("\n| 35.65 | ", table), 21U) << table;
  EXPECT_EQ(count_of("\n| 38.00 | ", table), 12U) << table;
  for (const char* reading : {"full", "bulk-E1", "bulk-Einf", "exact"}) {
    EXPECT_EQ(count_of(std::string("\n| 38.00 | ") + reading + " | 0.3 | ", table), 3U) << reading;
  }
  for (const char* friction : {"0.0", "0.1", "0.2"}) {
    EXPECT_EQ(count_of(std::string("\n| 35.65 | full | ") + friction + " | ", table), 3U);
  }
  const std::string trends = table.substr(table.find("Friction from 0 to 0.3"));
  for (const char* speed : {"\n| 31.1 | ", "\n| 40.3 | ", "\n| 51.0 | "}) {
    EXPECT_EQ(count_of(speed, trends), 1U) << speed;
  }
}

TEST_F(Figures, ShowTheSeriesOfThePaper) {
  EXPECT_GT(count_of("<polygon", text_of("fig11.svg")), 2U * 200U) << "both halves of the ball";
  for (const char* point : {"1 front", "2 centre", "3 rear"}) {
    EXPECT_GT(count_of(point, text_of("fig12.svg")), 0U) << point;
  }
  for (const char* words : {"31.1 m/s", "40.3 m/s", "51.0 m/s"}) {
    EXPECT_GT(count_of(words, text_of("fig13.svg")), 0U) << words;
    EXPECT_GT(count_of(words, text_of("fig14.svg")), 0U) << words;
  }
  EXPECT_EQ(count_of("<path", text_of("fig13.svg")), 12U) << "four frictions, three speeds";
  EXPECT_EQ(count_of("<path", text_of("fig14.svg")), 3U);
  for (const char* reading : {"full", "bulk-E1", "bulk-Einf", "exact"}) {
    EXPECT_GT(count_of(reading, text_of("fig15.svg")), 0U) << reading;
  }
}

}  // namespace
}  // namespace kolsky::cli
