// Whatever is wrong: exit code 2 and one line that names it and what would be right.
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <future>

#include "tests/end_to_end/cli/kolsky.hpp"
#include "tests/end_to_end/process.hpp"
#include "tests/scratch_folder.hpp"

namespace kolsky {
namespace {

using scene::refused;

struct Misuse {
  std::vector<std::string> words;
  std::vector<std::string> named;
};

class Usage : public ::testing::TestWithParam<Misuse> {};

TEST_P(Usage, IsRefused) {
  EXPECT_TRUE(refused(scene::kolsky(GetParam().words), GetParam().named));
}

INSTANTIATE_TEST_SUITE_P(
    Commands, Usage,
    ::testing::Values(Misuse{{}, {"no command"}},
                      Misuse{{"statsu"}, {"\"statsu\"", "did you mean status?"}},
                      Misuse{{"redcue", "shot.h5"}, {"did you mean reduce?"}},
                      Misuse{{"import"}, {"did you mean import csv?"}},
                      Misuse{{"import", "cvs", "a.csv"}, {"\"import cvs\"", "import csv"}},
                      Misuse{{"--json"}, {"\"--json\" is not a command"}}));

INSTANTIATE_TEST_SUITE_P(
    Options, Usage,
    ::testing::Values(
        Misuse{{"reduce"}, {"kolsky reduce", "CAPTURE is missing"}},
        Misuse{{"verify", "a", "b"}, {"\"b\" is one word too many"}},
        Misuse{{"reduce", "a.h5", "--bandlimit", "3"},
               {"--bandlimit", "the nearest is --band-limit"}},
        Misuse{{"reduce", "a.h5", "--sgv=x"}, {"--sgv=x", "--svg"}},
        Misuse{{"reduce", "a.h5", "--arrival"}, {"--arrival"}},
        Misuse{{"reduce", "a.h5", "--arrival", "early"}, {"--arrival", "early"}},
        Misuse{{"reduce", "a.h5", "--arrival", "nan"}, {"--arrival", "finite"}},
        Misuse{{"reduce", "a.h5", "--band-limit", "inf"}, {"--band-limit", "finite"}},
        Misuse{{"reduce", "a.h5", "--band-limit", "0"}, {"--band-limit", "above 0 Hz"}},
        Misuse{{"reduce", "a.h5", "--duration", "-1"}, {"--duration", "above 0 s"}},
        Misuse{{"reduce", "a.h5", "--json=7"}, {"json"}},
        Misuse{{"export", "a.h5", "--format", "xls", "-o", "b"},
               {"--format", "xls", "csv", "mat", "hdf5"}},
        Misuse{{"export", "a.h5", "-o", "b"}, {"--format is missing"}},
        Misuse{{"import", "csv", "a.csv", "-o", "b.h5"}, {"--bench is missing"}},
        Misuse{{"import", "csv", "a.csv", "--bench", "b.toml", "-o", "b.h5", "--meta", "speed"},
               {"--meta", "\"speed\" is not key=value"}},
        Misuse{
            {"import", "csv", "a.csv", "--bench", "b.toml", "-o", "b.h5", "--meta", "v=1", "v=2"},
            {"--meta", "v is given twice"}},
        Misuse{{"shots", "--most", "-1"}, {"--most", "not negative"}},
        Misuse{{"shots", "--most", "1.5"}, {"--most"}},
        Misuse{{"watch", "--json"}, {"--json", "--count"}},
        Misuse{{"watch", "--count", "0"}, {"--count", "1 or more"}},
        Misuse{{"watch", "--for", "-1"}, {"--for", "more than 0"}},
        Misuse{{"shots", "--most", "0"}, {"--most", "1 or more"}},
        Misuse{{"fire", "--wait", "-1"}, {"--wait", "more than 0"}},
        Misuse{{"reduce", "a.h5", "--softening", "-1"}, {"--softening", "0 to 1"}},
        Misuse{{"reduce", "a.h5", "--save", "b.h5"}, {"--save", "give --bench beside it"}},
        Misuse{{"reduce", "a.h5", "--svg", "x", "--csv", "./x"}, {"x", "two files"}},
        Misuse{{"fire", "now"}, {"\"now\" is one word too many"}}));

INSTANTIATE_TEST_SUITE_P(
    MissingFiles, Usage,
    ::testing::Values(Misuse{{"reduce", "/nowhere/shot.h5"}, {"/nowhere/shot.h5", "No such file"}},
                      Misuse{{"reduce", "/nowhere"}, {"/nowhere"}},
                      Misuse{{"export", "/nowhere/shot.h5", "--format", "csv", "-o", "/tmp/x.csv"},
                             {"/nowhere/shot.h5"}},
                      Misuse{{"verify", "/nowhere"}, {"/nowhere"}},
                      Misuse{{"import", "csv", "/nowhere/a.csv", "--bench", "/nowhere/b.toml", "-o",
                              "/nowhere/c.h5"},
                             {"/nowhere/"}}));

// Port 1 is nobody's; the address is one of this machine.
constexpr const char* kNobody = "tcp://127.0.0.1:1";

TEST(NoDaemon, EveryCommandSaysWhereItLookedWithinFourSeconds) {
  const std::vector<std::vector<std::string>> commands = {
      {"status"}, {"arm"}, {"fire"}, {"shots"}, {"get", "last"}, {"watch", "--once"}};
  const auto begin = std::chrono::steady_clock::now();
  std::vector<std::future<scene::Answer>> answers;
  for (std::vector<std::string> words : commands) {
    words.insert(words.end(), {"--endpoint", kNobody});
    answers.push_back(std::async(std::launch::async, [words] { return scene::kolsky(words); }));
  }
  answers.push_back(std::async(std::launch::async, [] {
    return scene::kolsky({"status"}, {std::string("KOLSKY_ENDPOINT=") + kNobody});
  }));
  for (std::future<scene::Answer>& answer : answers) {
    EXPECT_TRUE(refused(answer.get(), {kNobody, "no answer", "start kolskyd"}));
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(4));
}

TEST(NoDaemon, AnEndpointThatIsNoneIsRefused) {
  EXPECT_TRUE(
      refused(scene::kolsky({"status", "--endpoint", "5602"}), {"5602", "tcp://HOST:PORT"}));
}

class BadFiles : public ::testing::Test {
 protected:
  [[nodiscard]] scene::Answer import(const std::string& table, const std::string& bench) const {
    return scene::kolsky({"import", "csv", bench_.file(table), "--bench", bench_.file(bench), "-o",
                          bench_.file("x.h5")});
  }
  scene::Bench bench_;
};

TEST_F(BadFiles, ATableThatIsNoneLeavesNoCapture) {
  bench_.write("empty.csv", "");
  bench_.write("words.csv", "time_s,g1,g2\n0,zero,0\n1e-6,0,0\n");
  EXPECT_TRUE(refused(import("empty.csv", "bench.toml"), {"empty.csv"}));
  EXPECT_TRUE(refused(import("words.csv", "bench.toml"), {"words.csv", "2"}));
  EXPECT_FALSE(std::filesystem::exists(bench_.file("x.h5")));
}

TEST_F(BadFiles, ATableGivenTwiceIsRefused) {
  EXPECT_TRUE(
      refused(scene::kolsky({"import", "csv", bench_.file("shot.csv"), bench_.file("./shot.csv"),
                             "--bench", bench_.file("bench.toml"), "-o", bench_.file("x.h5")}),
              {"shot.csv", "twice"}));
  EXPECT_FALSE(std::filesystem::exists(bench_.file("x.h5")));
}

TEST_F(BadFiles, ABenchKeyThatIsUnknownNamesItsNeighbour) {
  std::ifstream good(bench_.file("bench.toml"));
  const std::string text{std::istreambuf_iterator<char>(good), {}};
  bench_.write("typo.toml", text + "lenght_m = 1.0\n");
  EXPECT_TRUE(refused(import("shot.csv", "typo.toml"), {"typo.toml", "lenght_m", "length_m"}));
}

TEST_F(BadFiles, NothingStoredIsOverwritten) {
  const std::string capture = bench_.capture();
  EXPECT_TRUE(refused(scene::kolsky({"import", "csv", bench_.file("shot.csv"), "--bench",
                                     bench_.file("bench.toml"), "-o", capture}),
                      {capture, "exists"}));
  bench_.write("mine.svg", "precious");
  EXPECT_TRUE(refused(scene::kolsky({"reduce", capture, "--svg", bench_.file("mine.svg")}),
                      {"mine.svg", "exists"}));
  bench_.write("mine.csv", "precious");
  EXPECT_TRUE(refused(scene::kolsky({"reduce", capture, "--csv", bench_.file("mine.csv")}),
                      {"mine.csv", "exists"}));
  EXPECT_TRUE(
      refused(scene::kolsky({"export", capture, "--format", "csv", "-o", bench_.file("mine.csv")}),
              {"mine.csv", "exists"}));
  for (const char* name : {"mine.svg", "mine.csv"}) {
    std::ifstream file(bench_.file(name));
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "precious") << name;
  }
}

TEST_F(BadFiles, ADamagedCaptureIsNotReduced) {
  const std::string capture = bench_.capture();
  const std::string damaged = bench_.file("damaged.h5");
  std::filesystem::copy_file(capture, damaged);
  std::filesystem::permissions(damaged, std::filesystem::perms::owner_all);
  std::fstream file(damaged, std::ios::in | std::ios::out | std::ios::binary);
  const auto middle = static_cast<std::streamoff>(std::filesystem::file_size(damaged) / 2);
  file.seekg(middle);
  const char flipped = static_cast<char>(file.get() ^ 0x10);
  file.seekp(middle);
  file.put(flipped);
  file.close();
  EXPECT_TRUE(refused(scene::kolsky({"reduce", damaged}), {"damaged.h5"}));
}

TEST_F(BadFiles, ARecordThatHoldsNoShotIsRefusedAndNothingIsWritten) {
  const auto table_of = [&](double share, std::size_t most_rows) {
    std::string cut;
    for (const std::string& line : scene::lines_of(bench_.table(share, 4e-6, 1))) {
      cut += most_rows-- > 0 ? line + "\n" : "";
      if (most_rows == 0) {
        break;
      }
    }
    return cut;
  };
  // The pulse is at the gauge from 300 us on, its answer from 495 us on.
  const struct {
    const char* name;
    double share;
    std::size_t rows;
    std::vector<std::string> named;
  } records[] = {
      {"silent", 0.0, 1500, {"no incident pulse stands out", "whole record"}},
      {"short", 1.0, 420, {"ends before", "record for longer"}},
      {"early", 1.0, 250, {"no incident pulse stands out", "whole record"}},
  };
  for (const auto& [name, share, rows, named] : records) {
    SCOPED_TRACE(name);
    const std::string capture = bench_.file(std::string(name) + ".h5");
    bench_.write(std::string(name) + ".csv", table_of(share, rows));
    (void)scene::json_of(
        scene::kolsky({"import", "csv", bench_.file(std::string(name) + ".csv"), "--bench",
                       bench_.file("bench.toml"), "-o", capture, "--json"}));
    std::vector<std::string> parts = named;
    parts.push_back(capture + ": record: ");
    const std::string table = bench_.file(std::string(name) + "-out.csv");
    EXPECT_TRUE(refused(scene::kolsky({"reduce", capture, "--csv", table}), parts));
    EXPECT_TRUE(refused(scene::kolsky({"reduce", capture, "--json"}), parts));
    EXPECT_FALSE(std::filesystem::exists(table));
  }
}

TEST_F(BadFiles, AnOutputThatCannotBeWrittenIsAnError) {
  // /dev/full takes nothing; the shell points stdout at it.
  const testing::ScratchFolder folder;
  scene::Process process({"/bin/sh", "-c", "exec \"$0\" --help > /dev/full", KOLSKY},
                         folder / "err");
  EXPECT_EQ(process.wait(std::chrono::seconds(10)), 1);
  EXPECT_NE(process.output().find("could not be written"), std::string::npos);
}

}  // namespace
}  // namespace kolsky
