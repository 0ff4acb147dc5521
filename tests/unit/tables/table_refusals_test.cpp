#include <gtest/gtest.h>

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <utility>

#include "tests/scratch_folder.hpp"
#include "tests/unit/tables/table_bench.hpp"

namespace kolsky {
namespace {

using testing::TableBench;

struct Refusal {
  const char* name;
  std::string text;
  const char* place;  ///< how the refusal begins
  const char* words;  ///< what it says further on
};

void PrintTo(const Refusal& refusal, std::ostream* out) {
  *out << refusal.name;
}

class StrainTable : public ::testing::TestWithParam<Refusal> {};
class VoltTable : public ::testing::TestWithParam<Refusal> {};

void expect_refusal(const std::string& unit, const Refusal& expected) {
  const std::string line = TableBench(2, unit).refusal({{"a.csv", expected.text}});
  EXPECT_TRUE(line.starts_with(std::string(expected.place) + ": ")) << line;
  EXPECT_NE(line.find(expected.words), std::string::npos) << line;
}

TEST_P(StrainTable, NamesThePlaceAndTheMend) {
  expect_refusal("strain", GetParam());
}

TEST_P(VoltTable, NamesThePlaceAndTheMend) {
  expect_refusal("V", GetParam());
}

const std::string kHead = "time_s,g1,g2\n";

INSTANTIATE_TEST_SUITE_P(
    Cells, StrainTable,
    ::testing::Values(
        Refusal{"Nan", kHead + "0,1e-3,0\n1e-6,nan,0\n", "a.csv:3: column g1",
                "\"nan\" is not a finite number"},
        Refusal{"Infinite", kHead + "0,1e-3,0\n1e-6,0,-inf\n", "a.csv:3: column g2",
                "is not a finite number"},
        Refusal{"OverRange", kHead + "0,1e-3,0\n1e-6,∞,0\n", "a.csv:3: column g1",
                "beyond the scope's range"},
        Refusal{"Empty", kHead + "0,1e-3,0\n1e-6,,0\n2e-6,0,0\n", "a.csv:3: column g1", "is empty"},
        Refusal{"EmptyInFirstRow", kHead + "0,,0\n1e-6,0,0\n", "a.csv:2: column g1", "is empty"},
        Refusal{"EmptyInLastRow", kHead + "0,0,0\n,0,0\n", "a.csv:3: column time", "is empty"},
        Refusal{"Word", kHead + "0,0,0\n1e-6,off,0\n", "a.csv:3: column g1",
                "\"off\" is not a finite number"},
        Refusal{"TooLarge", kHead + "0,0,0\n1e-6,1e999,0\n", "a.csv:3: column g1",
                "is not a finite number"},
        Refusal{"Hexadecimal", kHead + "0,0,0\n1e-6,0x10,0\n", "a.csv:3: column g1",
                "is not a finite number"},
        Refusal{"DoubleSign", kHead + "0,0,0\n1e-6,+-1,0\n", "a.csv:3: column g1",
                "is not a finite number"},
        Refusal{"DecimalCommaAndComma", kHead + "0,0,0,0,0,0\n1,0,0,0,0,0\n", "a.csv:2",
                "with decimal commas, put ; or a tab"},
        Refusal{"ThousandsPoint", "time_us;g1;g2\n0;0;0\n1;1.000,5;0\n", "a.csv:3: column g1",
                "is not a finite number"},
        Refusal{"ShortRow", kHead + "0,0,0\n1e-6,0\n2e-6,0,0\n", "a.csv:3",
                "has 2 cells where the header has 3"},
        Refusal{"LongRow", kHead + "0,0,0\n1e-6,0,0,7\n", "a.csv:3",
                "has 4 cells where the header has 3"},
        Refusal{"CutOff", kHead + "0,0,0\n1e-6,0,0\n2e", "a.csv:4", "has 1 cells"},
        Refusal{"Hole", kHead + "0,0,0\n1e-6,0,0\n\n2e-6,0,0\n", "a.csv:4",
                "is blank with samples after it"},
        Refusal{"SecondHeader", kHead + "0,0,0\n" + kHead + "1e-6,0,0\n", "a.csv:3: column time",
                "\"time_s\" is not a finite number"},
        Refusal{"Microstrain", kHead + "0,0,0\n1e-6,1500,0\n", "a.csv:3: column g1",
                "name the unit in the header"}));

INSTANTIATE_TEST_SUITE_P(
    Times, StrainTable,
    ::testing::Values(Refusal{"Repeated", kHead + "0,0,0\n1e-6,0,0\n1e-6,0,0\n2e-6,0,0\n",
                              "a.csv:4: time", "time must advance"},
                      Refusal{"Backwards", kHead + "0,0,0\n1e-6,0,0\n0.5e-6,0,0\n", "a.csv:4: time",
                              "time must advance"},
                      Refusal{"MissingRow",
                              kHead + "0,0,0\n1e-6,0,0\n3e-6,0,0\n4e-6,0,0\n5e-6,0,0\n",
                              "a.csv:4: time", "rows are missing"},
                      Refusal{"StepSixPercentOff",
                              kHead + "0,0,0\n1e-6,0,0\n2.06e-6,0,0\n3.06e-6,0,0\n4.06e-6,0,0\n",
                              "a.csv:4: time", "steps by 1.06e-06 s"},
                      Refusal{"RateTwoPercentOff", kHead + "0,0,0\n1.02e-6,0,0\n2.04e-6,0,0\n",
                              "a.csv: time", "where the bench has 1e+06 Hz"},
                      Refusal{"TimeStretchedByOnePercent",
                              kHead + "0,0,0\n1.01e-6,0,0\n2.02e-6,0,0\n", "a.csv: time",
                              "where the bench has 1e+06 Hz"},
                      Refusal{"WrongUnit", "time_ms,g1,g2\n0,0,0\n1,0,0\n2,0,0\n", "a.csv: time",
                              "name time's unit"},
                      Refusal{"OneRow", kHead + "0,0,0\n", "a.csv", "has 1 rows of samples"},
                      Refusal{"NoRow", kHead, "a.csv", "has 0 rows of samples"},
                      Refusal{"InfiniteTime", kHead + "0,0,0\ninf,0,0\n", "a.csv:3: column time",
                              "is not a finite number"}));

INSTANTIATE_TEST_SUITE_P(
    Heads, StrainTable,
    ::testing::Values(
        Refusal{"NoHeader", "0,0,0\n1e-6,0,0\n", "a.csv", "give a header row"},
        Refusal{"NoTime", "sample,g1,g2\n0,0,0\n1,0,0\n", "a.csv", "give a header row"},
        Refusal{"OnlyTime", "time_s\n0\n1e-6\n", "a.csv:1", "has a time column and no other"},
        Refusal{"TimeUnit", "time (min),g1,g2\n0,0,0\n1e-6,0,0\n", "a.csv:1",
                "the time unit \"min\" is not known"},
        Refusal{"ColumnUnit", "time_s,g1 (A),g2\n0,0,0\n1e-6,0,0\n", "a.csv:1",
                "the unit \"A\" is not known"},
        Refusal{"UnitRow", "Time,g1,g2\n(us),(A),(A)\n\n0,0,0\n1,0,0\n", "a.csv:2: column g1",
                "the unit \"A\" is not known"},
        Refusal{"UnitRowAgainstHeader", "time_s,g1,g2\n(us),,\n0,0,0\n1,0,0\n", "a.csv:2",
                "differs from the header's"},
        Refusal{"ColumnUnitTwice", "time,g1 (strain),g2\n(us),(microstrain),\n0,0,0\n1,0,0\n",
                "a.csv:2: column g1 (strain)", "differs from the header's"},
        Refusal{"VoltsForStrain", "time_s,g1/V,g2/V\n0,0,0\n1e-6,0,0\n", "a.csv: column g1/V",
                "is in volts, and gauge g1 has unit = \"strain\""},
        Refusal{"GaugeTwice", "time_s,g1,g2,G1\n0,0,0,0\n1e-6,0,0,0\n", "a.csv: column G1",
                "give each gauge one column"},
        Refusal{"ColumnTwice", "time_s,a,a\n0,0,0\n1e-6,0,0\n", "a.csv:1",
                "two columns are called \"a\""},
        Refusal{"GaugeMissing", "time_s,g1,CH2\n0,0,0\n1e-6,0,0\n", "a.csv",
                "has no column for gauge g2 (columns: g1, CH2)"},
        Refusal{"TooManyColumns", "time_s,a,b,c\n0,0,0,0\n1e-6,0,0,0\n", "a.csv",
                "there are 3 columns (a, b, c) for 2 gauges (g1, g2)"},
        Refusal{"TooFewColumns", "time_s,a\n0,0\n1e-6,0\n", "a.csv",
                "there are 1 columns (a) for 2 gauges (g1, g2)"}));

INSTANTIATE_TEST_SUITE_P(
    Files, StrainTable,
    ::testing::Values(
        Refusal{"Empty", "", "a.csv", "is empty"},
        Refusal{"Blank", "\n\n\n", "a.csv", "give a header row"},
        Refusal{"Binary", kHead + "0,0,0\n1e-6,0," + std::string(1, '\0') + "\n", "a.csv:3",
                "binary bytes"},
        Refusal{"Workbook", "PK\x03\x04 rest of a zip", "a.csv", "export it as CSV"},
        Refusal{"Hdf5", "\x89HDF\r\n\x1a\n rest", "a.csv", "export it as CSV"},
        Refusal{"Escape", "time_s,g1,g2\n0,0,0\n\x1B[31m,0,0\n", "a.csv:3", "binary bytes"},
        Refusal{"LongLine", kHead + "0,0," + std::string(70'000, '0') + "\n", "a.csv:2",
                "longer than 64 KiB"},
        Refusal{"BrokenUtf16", std::string("\xFF\xFEt\0i", 5), "a.csv", "broken further on"},
        Refusal{"LoneSurrogate",
                std::string("\xFF\xFE\x00\xDC"
                            "a\0",
                            6),
                "a.csv", "broken further on"}));

INSTANTIATE_TEST_SUITE_P(
    Scopes, VoltTable,
    ::testing::Values(
        Refusal{"StrainForVolts", "time_s,g1/με,g2/με\n0,0,0\n1e-6,0,0\n", "a.csv: column g1/με",
                "is in strain, and gauge g1 has unit = \"V\""},
        Refusal{"Millivolts", kHead + "0,0,0\n1e-6,1200,0\n", "a.csv:3: column g1",
                "name the unit in the header, as \"g1/mV\""},
        Refusal{"TwoChannelsBesideFields",
                "Record Length,3,Points,0,1,,,,,0,2\nSample Interval,1e-6,s,1e-6,1,,,,,1e-6,2\n",
                "a.csv:1", "more than one channel"},
        Refusal{"FieldsInAmperes", "Record Length,3,Points,0,1\nVertical Units,A,,1e-6,1\n",
                "a.csv:2", "the unit \"A\" is not known"},
        Refusal{"FieldsInHertz", "Record Length,3,Points,0,1\nHorizontal Units,Hz,,1e-6,1\n",
                "a.csv:2", "export time in seconds"},
        Refusal{"FieldsRowShort", "Record Length,3,Points,0,1\n,,,1e-6,1\n,,,2e-6\n,,,3e-6,1\n",
                "a.csv:3: column a", "is empty"},
        Refusal{"WaveformsDifferInT0", "Date\tx\tA\tB\n\t\t0\t1\n\t\t1e-6\t1e-6\n\t\t0\t0\n",
                "a.csv:2", "differ in t0"},
        Refusal{"WaveformsDifferInDt", "Date\tx\tA\tB\n\t\t0\t0\n\t\t1e-6\t2e-6\n\t\t0\t0\n",
                "a.csv:3", "differ in dt"},
        Refusal{"WaveformsStandStill", "Date\tx\tA\tB\n\t\t0\t0\n\t\t0\t0\n\t\t0\t0\n", "a.csv:3",
                "dt is not positive"},
        Refusal{"WaveformsWithoutDt", "Date\tx\tA\tB\n\t\t0\t0\n", "a.csv:2", "dt is missing"},
        Refusal{"WaveformsAtAnotherRate",
                "Date\tx\tA\tB\n\t\t0\t0\n\t\t2e-6\t2e-6\n\t\t0\t0\n\t\t0\t0\n", "a.csv: time",
                "where the bench has 1e+06 Hz"}));

const char* const kOne = "time_s,CH1\n0,0\n1e-6,0\n2e-6,0\n";

TEST(SeveralTables, MustShareTheirTimeAxis) {
  const TableBench bench(2);
  const std::string start =
      bench.refusal({{"a.csv", kOne}, {"b.csv", "time_us,CH1\n0.1,0\n1.1,0\n2.1,0\n"}});
  EXPECT_TRUE(start.starts_with("b.csv:2: time: is 1e-07 s where a.csv has 0 s; ")) << start;
  EXPECT_NE(start.find("cut them to the same start"), std::string::npos);
  const std::string end =
      bench.refusal({{"a.csv", kOne}, {"b.csv", "time_us,CH1\n0,0\n1.04,0\n2.08,0\n"}});
  EXPECT_TRUE(end.starts_with("b.csv:4: time: ")) << end;
  const std::string length = bench.refusal({{"a.csv", kOne}, {"b.csv", "time_us,CH1\n0,0\n1,0\n"}});
  EXPECT_TRUE(length.starts_with("b.csv: has 2 samples and a.csv has 3; ")) << length;
}

TEST(SeveralTables, EachIsChecked) {
  const TableBench bench(2);
  const std::string line =
      bench.refusal({{"a.csv", kOne}, {"b.csv", "time_us,CH1\n0,0\n1,0\n1,0\n"}});
  EXPECT_TRUE(line.starts_with("b.csv:4: time: ")) << line;
  const std::string twice =
      bench.refusal({{"a.csv", "time_s,g1\n0,0\n1e-6,0\n"}, {"b.csv", "time_s,g1\n0,0\n1e-6,0\n"}});
  EXPECT_TRUE(twice.starts_with("b.csv: column g1: is gauge g1, and so is a.csv: column g1; "))
      << twice;
}

TEST(Requests, WithoutTablesOrFilesAreRefused) {
  const TableBench bench(1);
  EXPECT_EQ(bench.refusal({}), "import: no table is given; name at least one file");
  TableImport request = bench.request({});
  request.tables = {"/absent/table.csv"};
  EXPECT_EQ(testing::refusal_of([&] { (void)import_tables(request); }),
            "/absent/table.csv: there is no such file; check the path");
  request.tables = {"/dev/zero"};
  EXPECT_EQ(testing::refusal_of([&] { (void)import_tables(request); }),
            "/dev/zero: is not a file; give the path of a file");
  request.bench = "/absent/bench.toml";
  EXPECT_EQ(testing::refusal_of([&] { (void)import_tables(request); }),
            "/absent/bench.toml: there is no such file; check the path");
}

// A sparse file: its length is stated, not stored.
TEST(Requests, WithMoreThanAGibibyteAreRefused) {
  const testing::ScratchFolder folder;
  const auto path = folder.write("big.csv", "time_s,g1\n");
  ASSERT_EQ(::truncate(path.c_str(), (off_t{2} << 30U) + 1), 0);
  TableImport request;
  request.bench = folder.write("bench.toml", testing::bench_text(1, "strain"));
  request.tables = {path};
  const std::string line = testing::refusal_of([&] { (void)import_tables(request); });
  EXPECT_NE(line.find("is larger than 1073741824 bytes"), std::string::npos) << line;
}

/// A table with one fact beside it.
TableImport with_fact(const TableBench& bench, const std::string& key, const std::string& value) {
  TableImport request = bench.request({{"a.csv", "time_s,g1\n0,0\n1e-6,0\n"}});
  request.meta = {{key, value}};
  return request;
}

std::string refused_fact(const TableBench& bench, const std::string& key,
                         const std::string& value) {
  return testing::refusal_of([&] { (void)import_tables(with_fact(bench, key, value)); });
}

TEST(Requests, MetaIsChecked) {
  const TableBench bench(1);
  const auto refusal = [&](const std::string& key, const std::string& value) {
    return refused_fact(bench, key, value);
  };
  EXPECT_TRUE(refusal("", "x").starts_with("meta : ")) << refusal("", "x");
  EXPECT_TRUE(refusal("note", "two\nlines").starts_with("meta note: "));
  EXPECT_TRUE(refusal("source_file", "x").starts_with("meta source_file: "));
  EXPECT_TRUE(
      refusal("incident_speed_m_per_s", "fast").starts_with("meta incident_speed_m_per_s: "));
  EXPECT_TRUE(refusal("rebound_speed_m_per_s", "nan").starts_with("meta rebound_speed_m_per_s: "));
  EXPECT_NE(refusal("temperature_K", "20").find("20 C is 293.15"), std::string::npos);
}

TEST(Requests, WhatCameToTheBarCameWithASpeed) {
  const TableBench bench(1);
  for (const auto& [key, value, said] :
       {std::array{"incident_speed_m_per_s", "-40.3", "-40.3 does not move towards the bar"},
        std::array{"incident_speed_m_per_s", "0", "0 does not move towards the bar"},
        std::array{"striker_speed_m_per_s", "0", "0 does not move towards the bar"},
        std::array{"rebound_speed_m_per_s", "0", "0 is no rebound"},
        std::array{"rebound_speed_m_per_s_sd", "-1", "-1 is no deviation"}}) {
    const std::string line = refused_fact(bench, key, value);
    EXPECT_TRUE(line.starts_with(std::string("meta ") + key + ": " + said)) << line;
  }
  EXPECT_NO_THROW((void)import_tables(with_fact(bench, "rebound_speed_m_per_s", "-30")));
  EXPECT_NO_THROW((void)import_tables(with_fact(bench, "incident_speed_m_per_s_sd", "0")));
}

TEST(Requests, AFactWhoseNameIsNearlyOneThatIsReadIsRefused) {
  const TableBench bench(1);
  for (const auto& [written, meant] :
       {std::pair{"incident_speed", "incident_speed_m_per_s"},
        std::pair{"incident_speed_sd", "incident_speed_m_per_s_sd"},
        std::pair{"incidentspeed_m_per_s", "incident_speed_m_per_s"},
        std::pair{"incident_speed_km_per_h", "incident_speed_m_per_s"},
        std::pair{"rebound_speed_m_s", "rebound_speed_m_per_s"},
        std::pair{"Striker_speed_m_per_s", "striker_speed_m_per_s"},
        std::pair{"temperature_C", "temperature_K"}}) {
    const std::string line = refused_fact(bench, written, "300");
    EXPECT_TRUE(line.starts_with(std::string("meta ") + written + ": ")) << line;
    EXPECT_NE(line.find(std::string("did you mean ") + meant + "?"), std::string::npos) << line;
  }
  for (const char* free : {"specimen", "speed_of_feed_m_per_s", "temperature_of_room_K",
                           "temperature_2_K", "incident_speed_m_per_s"}) {
    EXPECT_NO_THROW((void)import_tables(with_fact(bench, free, "300"))) << free;
  }
}

}  // namespace
}  // namespace kolsky
