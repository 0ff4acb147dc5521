#include "drivers/files/settings/toml_table.hpp"

#include <gtest/gtest.h>

#include <chrono>

#include "drivers/files/settings/nearest_name.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/unit/tables/refusal.hpp"

namespace kolsky {
namespace {

using testing::refusal_of;
using testing::ScratchFolder;

TomlTable parse(const std::string& text) {
  return TomlTable::parse(text, "f.toml");
}

TEST(TomlTable, ReadsEveryKind) {
  const TomlTable table = parse(R"(
real = -2.5e-3
whole = 3
text = "a \"quoted\" µ"
yes = true
names = ["one", "two"]
row = [1, 2.5]
[part]
inner = 1.0
[[item]]
x = 1
[[item]]
x = 2
)");
  EXPECT_EQ(table.number("real"), -0.0025);
  EXPECT_EQ(table.number("whole"), 3.0);
  EXPECT_EQ(table.integer("whole"), 3);
  EXPECT_EQ(table.text("text"), "a \"quoted\" µ");
  EXPECT_TRUE(table.flag("yes"));
  EXPECT_EQ(table.texts("names"), (std::vector<std::string>{"one", "two"}));
  EXPECT_EQ(table.numbers("row"), (std::vector<double>{1.0, 2.5}));
  EXPECT_EQ(table.table("part").number("inner"), 1.0);
  ASSERT_EQ(table.tables("item").size(), 2U);
  EXPECT_EQ(table.tables("item")[0].integer("x"), 1);
  EXPECT_EQ(table.tables("item")[1].integer("x"), 2);
  table.finish();
}

TEST(TomlTable, OptionalsAreNoneWhenAbsent) {
  const TomlTable table = parse("there = 1");
  EXPECT_EQ(table.optional_number("a"), std::nullopt);
  EXPECT_EQ(table.optional_integer("b"), std::nullopt);
  EXPECT_EQ(table.optional_text("c"), std::nullopt);
  EXPECT_EQ(table.optional_flag("d"), std::nullopt);
  EXPECT_EQ(table.optional_texts("e"), std::nullopt);
  EXPECT_FALSE(table.optional_table("f").has_value());
  EXPECT_FALSE(table.optional_measured("g").has_value());
  EXPECT_TRUE(table.tables("h").empty());
  EXPECT_EQ(table.optional_number("there"), 1.0);
  table.finish();
}

TEST(TomlTable, MeasuredTakesItsDeviation) {
  const TomlTable table = parse("a = 2\na_sd = 1\nb = 3.0");
  EXPECT_EQ(table.measured("a").value, 2.0);
  EXPECT_EQ(table.measured("a").sd, 1.0);
  EXPECT_EQ(table.measured("b").sd, 0.0);
  EXPECT_EQ(table.optional_measured("b")->value, 3.0);
  table.finish();
}

TEST(TomlTable, ChoiceGivesTheIndex) {
  const TomlTable table = parse("kind = \"b\"");
  EXPECT_EQ(table.choice("kind", {"a", "b"}), 1U);
  EXPECT_EQ(refusal_of([&] {
              (void)table.choice("kind", {"x", "y"});
            }),
            "f.toml:1: kind: is \"b\"; give one of \"x\", \"y\"");
}

TEST(TomlTable, LargestAndSmallestNumbersSurvive) {
  const TomlTable table = parse(
      "big = 1.7976931348623157e308\nsmall = 2.2250738585072014e-308\n"
      "most = 9223372036854775807\nleast = -9223372036854775808\nhex = 0x1F\nbits = 0b101\n"
      "grouped = 1_000_000\nsigned = +7");
  EXPECT_EQ(table.number("big"), 1.7976931348623157e308);
  EXPECT_EQ(table.number("small"), 2.2250738585072014e-308);
  EXPECT_EQ(table.integer("most"), INT64_MAX);
  EXPECT_EQ(table.integer("least"), INT64_MIN);
  EXPECT_EQ(table.integer("hex"), 31);
  EXPECT_EQ(table.integer("bits"), 5);
  EXPECT_EQ(table.integer("grouped"), 1000000);
  EXPECT_EQ(table.integer("signed"), 7);
}

struct Refusal {
  const char* text;
  void (*read)(const TomlTable&);
  const char* line;
};

class TomlRefusals : public ::testing::TestWithParam<Refusal> {};

TEST_P(TomlRefusals, NamesThePlaceAndTheMend) {
  const TomlTable table = parse(GetParam().text);
  EXPECT_EQ(refusal_of([&] { GetParam().read(table); }), GetParam().line);
}

INSTANTIATE_TEST_SUITE_P(
    Values, TomlRefusals,
    ::testing::Values(
        Refusal{"a = 1", [](const TomlTable& f) { (void)f.number("b"); },
                "f.toml: b: is missing; add it"},
        Refusal{"\n[p]\nx = 1", [](const TomlTable& f) { (void)f.table("p").number("y"); },
                "f.toml:2: p.y: is missing; add it"},
        Refusal{"a = \"1\"", [](const TomlTable& f) { (void)f.number("a"); },
                "f.toml:1: a: is a text; give a number"},
        Refusal{"\na = inf", [](const TomlTable& f) { (void)f.number("a"); },
                "f.toml:2: a: is not finite; give a finite number"},
        Refusal{"a = nan", [](const TomlTable& f) { (void)f.measured("a"); },
                "f.toml:1: a: is not finite; give a finite number"},
        Refusal{"a = 1\na_sd = -0.1", [](const TomlTable& f) { (void)f.measured("a"); },
                "f.toml:2: a_sd: is negative; give a standard deviation of at least 0"},
        Refusal{"a_sd = 0.1", [](const TomlTable& f) { (void)f.optional_measured("a"); },
                "f.toml:1: a_sd: is the standard deviation of a number that is not there; give "
                "\"a\" too"},
        Refusal{"a = 1.0", [](const TomlTable& f) { (void)f.integer("a"); },
                "f.toml:1: a: is a number; give an integer"},
        Refusal{"a = 1", [](const TomlTable& f) { (void)f.text("a"); },
                "f.toml:1: a: is an integer; give a text in quotes"},
        Refusal{"a = 0", [](const TomlTable& f) { (void)f.flag("a"); },
                "f.toml:1: a: is an integer; give true or false"},
        Refusal{"a = [\"x\", 1]", [](const TomlTable& f) { (void)f.texts("a"); },
                "f.toml:1: a: is not an array of texts; give [\"one\", \"two\"]"},
        Refusal{"a = \"x\"", [](const TomlTable& f) { (void)f.texts("a"); },
                "f.toml:1: a: is not an array of texts; give [\"one\", \"two\"]"},
        Refusal{"a = [1.0, nan]", [](const TomlTable& f) { (void)f.numbers("a"); },
                "f.toml:1: a: is not an array of finite numbers; give [1.0, 2.0]"},
        Refusal{"a = 1", [](const TomlTable& f) { (void)f.table("a"); },
                "f.toml:1: a: is an integer; give a table, [a]"},
        Refusal{"[a]\nx = 1", [](const TomlTable& f) { (void)f.tables("a"); },
                "f.toml:1: a: is not an array of tables; give tables, [[a]]"},
        Refusal{"a = 1979-05-27", [](const TomlTable& f) { (void)f.number("a"); },
                "f.toml:1: a: is a date or time; give a number"},
        Refusal{"[[g]]\nx = 1\n[[g]]\nx = \"b\"",
                [](const TomlTable& f) { (void)f.tables("g")[1].number("x"); },
                "f.toml:4: g[1].x: is a text; give a number"}));

INSTANTIATE_TEST_SUITE_P(
    UnknownKeys, TomlRefusals,
    ::testing::Values(Refusal{"length_m = 1\nlenght_m = 2",
                              [](const TomlTable& f) {
                                (void)f.number("length_m");
                                f.finish();
                              },
                              "f.toml:2: lenght_m: is not a known key; did you mean \"length_m\"?"},
                      Refusal{"x = 1", [](const TomlTable& f) { f.finish(); },
                              "f.toml:1: x: is not a known key; remove it"},
                      Refusal{"a = 1\n[part]\nb = 1\nc = 2",
                              [](const TomlTable& f) {
                                (void)f.number("a");
                                (void)f.table("part").number("b");
                                f.finish();
                              },
                              "f.toml:4: part.c: is not a known key; did you mean \"b\"?"},
                      Refusal{"[[g]]\nx = 1\n[[g]]\ny = 2",
                              [](const TomlTable& f) {
                                for (const TomlTable& item : f.tables("g")) {
                                  (void)item.optional_number("x");
                                }
                                f.finish();
                              },
                              "f.toml:4: g[1].y: is not a known key; did you mean \"x\"?"},
                      // The first line first, though the root's own leftover comes later.
                      Refusal{"z = 1\n[part]\nb = 1\n[other]\n",
                              [](const TomlTable& f) {
                                (void)f.number("z");
                                (void)f.table("part");
                                f.finish();
                              },
                              "f.toml:3: part.b: is not a known key; remove it"},
                      // Read as a table, but nobody looked into it.
                      Refusal{"[part]\nb = 1",
                              [](const TomlTable& f) {
                                (void)f.optional_table("part");
                                f.finish();
                              },
                              "f.toml:2: part.b: is not a known key; remove it"},
                      // has() knows a key and does not read it.
                      Refusal{"a = 1",
                              [](const TomlTable& f) {
                                (void)f.has("a");
                                f.finish();
                              },
                              "f.toml:1: a: is not a known key; did you mean \"a\"?"},
                      Refusal{
                          "lenght_m = 1",
                          [](const TomlTable& f) {
                            f.expect({"length_m", "diameter_m"});
                          },
                          "f.toml:1: lenght_m: is not a known key; did you mean \"length_m\"?"}));

TEST(TomlTable, ExpectTakesDeviations) {
  const TomlTable table = parse("a = 1\na_sd = 0.5\nb = \"x\"");
  table.expect({"a", "b"});
  (void)table.measured("a");
  (void)table.text("b");
  table.finish();
}

TEST(TomlTable, AcceptTakesWhatIsBelow) {
  const TomlTable table = parse("a = 1\n[free]\nanything = 1\n[free.deep]\nx = 2");
  (void)table.number("a");
  table.accept("free");
  table.finish();
}

TEST(TomlTable, LocatesErrorsOfChecks) {
  const TomlTable table = parse("[bars.input]\nlength_m = 1\n\n[[gauges]]\nname = \"g\"");
  const auto located = [&](const std::string& place) {
    return table.located(InputError(place, "what", "mend")).place();
  };
  EXPECT_EQ(located("bars.input.length_m"), "f.toml:2: bars.input.length_m");
  EXPECT_EQ(located("bars.input.absent"), "f.toml:1: bars.input.absent");
  EXPECT_EQ(located("gauges[0].name"), "f.toml:5: gauges[0].name");
  EXPECT_EQ(located("gauges[0].absent"), "f.toml:4: gauges[0].absent");
  EXPECT_EQ(located("absent"), "f.toml: absent");
  EXPECT_EQ(table.tables("gauges")[0].located(InputError("name", "what", "mend")).place(),
            "f.toml:5: gauges[0].name");
}

struct BrokenText {
  const char* text;
  const char* place;
};

class BrokenToml : public ::testing::TestWithParam<BrokenText> {};

TEST_P(BrokenToml, IsRefusedWithItsLine) {
  const std::string line = refusal_of([&] { (void)parse(GetParam().text); });
  EXPECT_TRUE(line.starts_with(std::string(GetParam().place) + ": ")) << line;
}

INSTANTIATE_TEST_SUITE_P(
    Syntax, BrokenToml,
    ::testing::Values(BrokenText{"a = ", "f.toml:1"}, BrokenText{"a = 1 b = 2", "f.toml:1"},
                      BrokenText{"a = 1\na = 2", "f.toml:2"},
                      BrokenText{"[t]\nx=1\n[t]\ny=2", "f.toml:3"},
                      BrokenText{"x = 1\na = \"abc", "f.toml:2"},
                      BrokenText{"x = 1\n\na = tru", "f.toml:3"}, BrokenText{"a\n", "f.toml:1"},
                      BrokenText{"[", "f.toml:1"}, BrokenText{"a = [1, 2", "f.toml:1"},
                      BrokenText{"a = .5", "f.toml:1"}, BrokenText{"a = 01", "f.toml:1"},
                      BrokenText{"a = 1\nb = 1e400", "f.toml:2"},
                      BrokenText{"a = 9223372036854775808", "f.toml:1"},
                      BrokenText{"a = 0xFFFFFFFFFFFFFFFFFF", "f.toml:1"},
                      BrokenText{"a = 1\nb = \"\\u0000\"", "f.toml:2"},
                      BrokenText{"a = 1\nb = \"\xFF\"", "f.toml:2"},
                      BrokenText{"a = 1\nb = \"\xC0\x80\"", "f.toml:2"},
                      BrokenText{"a = 1\nb = \"\xED\xA0\x80\"", "f.toml:2"}));

TEST(TomlTable, RefusesNulBytesAndUtf16) {
  EXPECT_EQ(refusal_of([] { (void)parse(std::string("a = 1\n\0", 7)); }),
            "f.toml:2: has a NUL byte: it is not text; give a TOML file");
  EXPECT_EQ(refusal_of([] { (void)parse("\xFF\xFE" + std::string("a\0", 2)); }),
            "f.toml:1: is not UTF-8 text; save it as UTF-8");
}

TEST(TomlTable, TakesAByteOrderMarkAndWindowsLineEnds) {
  const TomlTable table = parse(
      "\xEF\xBB\xBF"
      "a = 1\r\nb = 2\r\n");
  EXPECT_EQ(table.number("a") + table.number("b"), 3.0);
}

TEST(TomlTable, RefusesDepthWithoutRecursing) {
  const std::string deep(100'000, '[');
  EXPECT_EQ(refusal_of([&] { (void)parse("x = 1\na = " + deep.substr(0, 1000)); }),
            "f.toml:2: is nested more than 32 deep; flatten it");
  std::string dotted = "a";
  for (int i = 0; i < 1000; ++i) {
    dotted += ".a";
  }
  EXPECT_EQ(refusal_of([&] { (void)parse(dotted + " = 1"); }),
            "f.toml:1: is nested more than 32 deep; flatten it");
  // A string that holds brackets nests nothing, and a bracket after one is still counted.
  EXPECT_EQ(parse("a = \"" + deep.substr(0, 100) + "\"").text("a").size(), 100U);
  EXPECT_EQ(
      refusal_of([&] {
        (void)parse("a = [\"]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]\", " + deep.substr(0, 40));
      }),
      "f.toml:1: is nested more than 32 deep; flatten it");
}

TEST(TomlTable, BoundsWhatAFileCanCost) {
  EXPECT_EQ(refusal_of([] { (void)parse("a = \"" + std::string(5000, 'x') + "\""); }),
            "f.toml:1: is longer than 4096 bytes; break the line");
  EXPECT_EQ(refusal_of([] { (void)parse(std::string(300000, '\n')); }),
            "f.toml: is larger than 256 KiB; check that this is the file you mean");
}

#if defined(NDEBUG) && !defined(KOLSKY_SANITIZED)
// Full lines of the shortest values cost the parser most; a real file takes milliseconds.
TEST(TomlTable, TheWorstFileTakesAMomentOnly) {
  std::string worst = "a = [\n";
  while (worst.size() < 250000) {
    worst += "1,";
    worst += worst.size() % 4000 < 2 ? "\n" : "";
  }
  const auto start = std::chrono::steady_clock::now();
  EXPECT_GT(parse(worst + "]").numbers("a").size(), 100'000U);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}
#endif

TEST(TomlTable, OpensFilesAndNamesThem) {
  const ScratchFolder folder;
  const auto path = folder.write("s.toml", "a = 1\n");
  const TomlTable table = TomlTable::open(path);
  EXPECT_EQ(table.number("a"), 1.0);
  EXPECT_EQ(table.file_name(), path.string());
  EXPECT_EQ(table.file_text(), "a = 1\n");
  const auto absent = folder.path() / "absent.toml";
  EXPECT_EQ(refusal_of([&] { (void)TomlTable::open(absent); }),
            absent.string() + ": there is no such file; check the path");
  EXPECT_EQ(refusal_of([&] { (void)TomlTable::open(folder.path()); }),
            folder.path().string() + ": is not a file; give the path of a file");
  EXPECT_EQ(refusal_of([] { (void)TomlTable::open("/dev/zero"); }),
            "/dev/zero: is not a file; give the path of a file");
}

TEST(TomlTable, OutlivesItsRoot) {
  const auto inner = [] { return parse("[p]\nx = 4").table("p"); }();
  EXPECT_EQ(inner.number("x"), 4.0);
}

// Distances of the optimal string alignment, by hand.
TEST(NearestName, CountsEdits) {
  EXPECT_EQ(edit_distance("", ""), 0U);
  EXPECT_EQ(edit_distance("abc", ""), 3U);
  EXPECT_EQ(edit_distance("", "ab"), 2U);
  EXPECT_EQ(edit_distance("lenght", "length"), 1U);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
  EXPECT_EQ(edit_distance("ca", "abc"), 3U);
  EXPECT_EQ(nearest_name("diametre_m", {"length_m", "diameter_m", "density_kg_m3"}), "diameter_m");
  EXPECT_EQ(nearest_name("--band", {"--solid", "--band-limit"}), "--band-limit");
  EXPECT_EQ(nearest_name("x", {}), "");
}

}  // namespace
}  // namespace kolsky
