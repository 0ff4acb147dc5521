#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <span>
#include <string>

#include "drivers/files/sha256.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/unit/tables/table_bench.hpp"

namespace kolsky {
namespace {

using testing::expect_values;
using testing::TableBench;

// Captures of one bench replay as one stream only if their scales are the same.
TEST(TableImport, ScalesByTheBenchAndNotByTheRecord) {
  const Shot strong =
      TableBench(1).import({{"a.csv", "time_s,g1\n0,0.012\n1e-6,-0.001\n2e-6,0\n"}});
  const Shot weak = TableBench(1).import({{"a.csv", "time_s,g1\n0,1e-9\n1e-6,-3e-9\n2e-6,0\n"}});
  EXPECT_EQ(weak.channels[0].scale, strong.channels[0].scale);
  EXPECT_LT(weak.channels[0].scale, 1e-11);
  expect_values(weak, 0, {1e-9, -3e-9, 0.0});
}

TEST(TableImport, GivesARecordBeyondTheUsualACoarserScale) {
  const Shot shot = TableBench(1).import({{"a.csv", "time_s,g1\n0,0.09\n1e-6,-0.09\n2e-6,0\n"}});
  expect_values(shot, 0, {0.09, -0.09, 0.0});
  EXPECT_TRUE(clipped_samples(shot.channels[0]).empty());
}

TEST(TableForms, OwnTable) {
  const Shot shot = TableBench(2).import(
      {{"shot-7.csv", "time_s,g1,g2\n0,1e-3,-2e-3\n1e-6,2e-3,0\n2e-6,3e-3,1e-3\n"}});
  expect_values(shot, 0, {1e-3, 2e-3, 3e-3});
  expect_values(shot, 1, {-2e-3, 0.0, 1e-3});
  EXPECT_EQ(shot.id, "shot-7");
  EXPECT_EQ(shot.rate, (SampleRate{1'000'000, 1}));
  EXPECT_EQ(shot.first_tick, 0);
  EXPECT_FALSE(shot.trigger.has_value());
  EXPECT_FALSE(shot.bar_model.has_value());
  EXPECT_TRUE(shot.gaps.empty());
  EXPECT_EQ(shot.utc_ns, 1'700'000'000'000'000'000);
  EXPECT_EQ(shot.software_version, KOLSKY_VERSION);
  EXPECT_EQ(shot.bench_toml, testing::bench_text(2, "strain"));
  EXPECT_EQ(shot.channels[0].gauge, "g1");
  EXPECT_EQ(shot.channels[0].unit, "strain");
  EXPECT_EQ(shot.channels[0].bits, 32);
  EXPECT_EQ(shot.channels[0].offset, 0.0);
  EXPECT_TRUE(clipped_samples(shot.channels[0]).empty());
}

TEST(TableForms, MetaTravelsWithItsSource) {
  const TableBench bench(1);
  const std::string text = "time_s,g1\n-1e-6,1e-3\n0,1e-3\n1.001e-6,2e-3\n";
  TableImport request = bench.request({{"a.csv", text}});
  request.meta = {{"specimen", "core 3"}, {"striker_speed_m_per_s", "12.5"}};
  const Shot shot = import_tables(request);
  EXPECT_EQ(shot.meta.at("specimen"), "core 3");
  EXPECT_EQ(shot.meta.at("striker_speed_m_per_s"), "12.5");
  EXPECT_EQ(shot.meta.at("source_file"), "a.csv");
  EXPECT_EQ(shot.meta.at("source_sha256"), sha256_hex(std::as_bytes(std::span(text))));
  EXPECT_NEAR(std::stod(shot.meta.at("measured_rate_Hz")), 2.0 / 2.001e-6, 1e-3);
  EXPECT_EQ(std::stod(shot.meta.at("first_sample_s")), -1e-6);
  EXPECT_FALSE(shot.meta.contains("ignored_columns"));
}

// FIPS 180-2, appendix B.1.
TEST(TableForms, DigestIsSha256) {
  const std::string abc = "abc";
  EXPECT_EQ(sha256_hex(std::as_bytes(std::span(abc))),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(TableForms, ImportTakesTheClockOnlyWhenNotTold) {
  const TableBench bench(1);
  TableImport request = bench.request({{"a.csv", "time_s,g1\n0,0\n1e-6,1e-3\n"}});
  request.utc_ns.reset();
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const auto before = std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
  EXPECT_GE(import_tables(request).utc_ns, before);
}

struct Form {
  const char* name;
  const char* text;
};

void PrintTo(const Form& form, std::ostream* out) {
  *out << form.name;
}

class OneStrainTable : public ::testing::TestWithParam<Form> {};
class OneVoltTable : public ::testing::TestWithParam<Form> {};

// Each holds 1, 2 and 3 millistrain for g1 and -1, 0 and 0.5 for g2, a microsecond apart.
TEST_P(OneStrainTable, IsRead) {
  const Shot shot = TableBench(2).import({{"a.csv", GetParam().text}});
  expect_values(shot, 0, {1e-3, 2e-3, 3e-3});
  expect_values(shot, 1, {-1e-3, 0.0, 0.5e-3});
}

// The same numbers in volts.
TEST_P(OneVoltTable, IsRead) {
  const Shot shot = TableBench(2, "V").import({{"a.csv", GetParam().text}});
  expect_values(shot, 0, {1.0, 2.0, 3.0});
  expect_values(shot, 1, {-1.0, 0.0, 0.5});
}

INSTANTIATE_TEST_SUITE_P(
    Headers, OneStrainTable,
    ::testing::Values(
        Form{"Microstrain", "Time/s,g1/με,g2/µε\n0,1000,-1000\n1e-6,2000,0\n2e-6,3000,500\n"},
        Form{"Words", "t (us);g1 [microstrain];g2 (ustrain)\n0;1000;-1000\n1;2000;0\n2;3000;500\n"},
        Form{"Suffix",
             "time_ms,g1_microstrain,g2_strain\n0,1000,-1e-3\n0.001,2000,0\n0.002,3000,5e-4\n"},
        Form{"OtherOrder", "time_s,G2,G1\n0,-1e-3,1e-3\n1e-6,0,2e-3\n2e-6,5e-4,3e-3\n"},
        Form{"OwnNames", "time_s,in (με),out (με)\n0,1000,-1000\n1e-6,2000,0\n2e-6,3000,500\n"},
        Form{"MoreColumns",
             "time_s,x,g2,y,g1\n0,9,-1e-3,9,1e-3\n1e-6,9,0,9,2e-3\n2e-6,9,5e-4,9,3e-3\n"},
        Form{"Percent", "time_s,g1/%,g2/%\n0,0.1,-0.1\n1e-6,0.2,0\n2e-6,0.3,0.05\n"},
        Form{"Comment", "# time_s g1 g2\n0 1e-3 -1e-3\n1e-6  2e-3   0\n  2e-6 3e-3 5e-4 \n"},
        Form{"DecimalComma", "Zeit (us);g1;g2\n0,0;0,001;-0,001\n1,0;0,002;0\n2,0;0,003;5E-04\n"},
        Form{"DecimalCommaTab", "time_us\tg1\tg2\n0\t,001\t-0,001\n1\t+0,002\t0\n2\t3e-3\t,0005"},
        Form{"BlankEnd", "time_s,g1,g2\n0,1e-3,-1e-3\n1e-6,2e-3,0\n2e-6,3e-3,5e-4\n\n,,\n \n"},
        Form{"TrailingSeparator", "time_s,g1,g2,\n0,1e-3,-1e-3,\n1e-6,2e-3,0,\n2e-6,3e-3,5e-4,\n"},
        Form{"Quoted",
             "\"time_s\",\"g1\",\"g2\"\n\"0\",\"1e-3\",-1e-3\n1e-6, 2e-3 ,0\n2e-6,3e-3,5e-4\n"},
        Form{"WindowsEnds", "time_s,g1,g2\r\n0,1e-3,-1e-3\r\n1e-6,2e-3,0\r\n2e-6,3e-3,5e-4\r\n"},
        Form{"MacEnds", "time_s,g1,g2\r0,1e-3,-1e-3\r1e-6,2e-3,0\r2e-6,3e-3,5e-4\r"},
        Form{"Mark", "\xEF\xBB\xBFtime_s,g1,g2\n0,1e-3,-1e-3\n1e-6,2e-3,0\n2e-6,3e-3,5e-4\n"},
        Form{"Latin1",
             "time_s,g1 (\xB5\x65),g2 (\xB5\x65)\n0,1000,-1000\n1e-6,2000,0\n2e-6,3000,"
             "500\n"}));

INSTANTIATE_TEST_SUITE_P(
    Scopes, OneVoltTable,
    ::testing::Values(
        Form{"PicoScope",
             "Time,Channel A,Channel B\n(us),(mV),(V)\n\n-1.00000000,1000.00000000,-1.00000000\n"
             "0.00000000,2000.00000000,0.00000000\n1.00000000,3000.00000000,0.50000000\n"},
        Form{"PicoScopeGerman",
             "Time;Channel A;Channel B\n(us);(mV);(mV)\n\n-1,00000000;1000,0;-1000,0\n"
             "0,00000000;2000,0;0,0\n1,00000000;3000,0;500,0\n"},
        Form{"PicoScopeTabMs",
             "Time\tChannel A\tChannel B\n(ms)\t(mV)\t(µV)\n\n-0,001\t1000,0\t-1000000\n"
             "0,000\t2000,0\t0,0\n0,001\t3000,0\t500000\n"},
        Form{"TektronixMso",
             "Model,MSO44\nFirmware Version,1.2\nTime,14:05:33\nWaveform Type,ANALOG\n"
             "Horizontal Units,s\nSample Interval,1e-06\nLabel,,\n\nTIME,CH1,CH2\n"
             "-1.0e-06,1.0,-1.0\n0,2.0,0.0\n1.0e-06,3.0,0.5\n"},
        Form{"LeCroy",
             "LECROYWS,1234,Waveform\nSegments,1,SegmentSize,3\n"
             "Time,Ampl A,Ampl B\n0,1,-1\n1e-6,2,0\n2e-6,3,0.5\n"},
        Form{"UnitRowBare", "time,a,b\nus,mV,mV\n0,1000,-1000\n1,2000,0\n2,3000,500\n"},
        Form{"Words", "Time/s,in/voltage,out/Volts\n0,1,-1\n1e-6,2,0\n2e-6,3,0.5\n"},
        Form{"Waveforms",
             "Test Date\t1/1/20\tIn/Out Waveform\tOut Waveform\n"
             "Bar, \"3/8\" inch\t\t-5.0E-05\t-5.0E-05\n"
             "Gap\t0\t1.0E-06\t1.0E-06\nMaterial\tCu\t1\t-1\n\t\t2\t0\n\t\t3\t0.5\n"}));

std::string utf16(const std::string& ascii, bool big_endian) {
  std::string bytes = big_endian ? "\xFE\xFF" : "\xFF\xFE";
  for (const char c : ascii) {
    bytes += big_endian ? std::string{'\0', c} : std::string{c, '\0'};
  }
  return bytes;
}

TEST(TableForms, Utf16) {
  const std::string text = "time_s\tg1\n0\t1e-3\n1e-6\t2e-3\n";
  for (const bool big_endian : {false, true}) {
    expect_values(TableBench(1).import({{"a.txt", utf16(text, big_endian)}}), 0, {1e-3, 2e-3});
  }
  // A unit with Greek letters, outside ASCII: U+03BC U+03B5.
  std::string greek = utf16("time_s\tg1/", false);
  greek += "\xBC\x03\xB5\x03";
  greek += utf16("\n0\t1\n1e-6\t2\n", false).substr(2);
  expect_values(TableBench(1).import({{"a.txt", greek}}), 0, {1e-6, 2e-6});
}

TEST(TableForms, TektronixHeaderFieldsOneFilePerChannel) {
  const auto table = [](const std::string& source, double factor) {
    std::string text = "Record Length,3,\"Points\",-1e-06," + std::to_string(factor) +
                       "\nSample Interval,1e-06,s,0," + std::to_string(2 * factor) + "\n";
    text += "Vertical Units,V,,1e-06," + std::to_string(3 * factor) + ",\n";
    text += source.empty() ? "" : "Source," + source + ",,2e-06," + std::to_string(4 * factor);
    return text;
  };
  const TableBench bench(2, "V");
  const Shot by_order = bench.import({{"a_Ch1.csv", table("", 1)}, {"a_Ch2.csv", table("", -1)}});
  expect_values(by_order, 0, {1, 2, 3});
  expect_values(by_order, 1, {-1, -2, -3});
  EXPECT_EQ(by_order.id, "a_Ch1");
  EXPECT_EQ(by_order.meta.at("source_file"), "a_Ch1.csv, a_Ch2.csv");
  // By the files' names, though given the other way round.
  const Shot by_stem = bench.import({{"g2.csv", table("", -1)}, {"g1.csv", table("", 1)}});
  expect_values(by_stem, 0, {1, 2, 3});
  expect_values(by_stem, 1, {-1, -2, -3});
  // By the source the scope filed.
  const Shot by_source = bench.import({{"x.csv", table("G2", -1)}, {"y.csv", table("g1", 1)}});
  expect_values(by_source, 0, {1, 2, 3, 4});
}

TEST(TableForms, SeveralTablesAreChannelsOfOneShot) {
  const Shot shot =
      TableBench(3).import({{"a.csv", "time_s,CH1\n0,1e-3\n1e-6,2e-3\n"},
                            {"b.csv", "time_us,CH1,CH2\n0.01,3e-3,5e-3\n1.01,4e-3,6e-3\n"}});
  expect_values(shot, 0, {1e-3, 2e-3});
  expect_values(shot, 1, {3e-3, 4e-3});
  expect_values(shot, 2, {5e-3, 6e-3});
}

TEST(TableForms, ColumnsLeftOutAreNamed) {
  const Shot shot =
      TableBench(1).import({{"a.csv", "time_s,force,g1,end (V)\n0,7,1e-3,1\n1e-6,8,2e-3,1\n"}});
  EXPECT_EQ(shot.meta.at("ignored_columns"), "force, end (V)");
  EXPECT_FALSE(shot.meta.contains("columns_in_order"));
}

TEST(TableForms, ColumnsThatAreTakenInTheirOrderAreNamed) {
  const Shot shot = TableBench(2).import({{"a.csv", "time_s,left,right\n0,1e-3,0\n1e-6,2e-3,0\n"}});
  EXPECT_EQ(shot.meta.at("columns_in_order"), "left, right");
  EXPECT_FALSE(shot.meta.contains("ignored_columns"));
}

// A gauge's own name wins over a unit that could be read out of it.
TEST(TableForms, AGaugeMayBeCalledLikeAUnit) {
  const testing::ScratchFolder folder;
  std::string bench = testing::bench_text(1, "strain");
  bench.replace(bench.find("\"g1\""), 4, "\"front_V\"");
  TableImport request;
  request.bench = folder.write("bench.toml", bench);
  request.tables = {folder.write("a.csv", "time_s,front_V\n0,1e-3\n1e-6,2e-3\n")};
  expect_values(import_tables(request), 0, {1e-3, 2e-3});
}

TEST(TableForms, IdsAreFileNames) {
  const TableBench bench(1);
  const std::string text = "time_s,g1\n0,1e-3\n1e-6,2e-3\n";
  EXPECT_EQ(bench.import({{"run 3 (µ).csv", text}}).id, "run_3_____");
  EXPECT_EQ(bench.import({{"..csv", text}}).id, "shot.");
  EXPECT_EQ(bench.import({{std::string(200, 'x') + ".csv", text}}).id, std::string(100, 'x'));
}

// A table at a rate of its own, from its ends and not from one step.
TEST(TableForms, RateComesFromTheWholeAxis) {
  std::string text = "time_s,g1\n";
  for (int i = 0; i < 1000; ++i) {
    // The first step is 4 % short, the mean is 0.5 % long.
    const double time_s = i == 0 ? 0.04e-6 : i * 1.005e-6;
    text += std::to_string(time_s * 1e6) + "e-6,1e-3\n";
  }
  const Shot shot = TableBench(1).import({{"a.csv", text}});
  EXPECT_EQ(shot.rate, (SampleRate{1'000'000, 1}));
  EXPECT_NEAR(std::stod(shot.meta.at("measured_rate_Hz")), 999 / (999 * 1.005e-6 - 0.04e-6), 10.0);
}

double bell(double time_s) {
  return 1e-3 * std::exp(-0.5 * std::pow((time_s - 500e-6) / 20e-6, 2));
}

std::string table_of_bell(int samples, const std::function<double(int)>& time_s) {
  std::string text = "time_s,g1\n";
  for (int i = 0; i < samples; ++i) {
    std::array<char, 64> row{};
    std::snprintf(row.data(), row.size(), "%.15e,%.15e\n", time_s(i), bell(time_s(i)));
    text += row.data();
  }
  return text;
}

void expect_bell(const Shot& shot, double first_s) {
  const ChannelRecord& channel = shot.channels[0];
  for (std::size_t n = 0; n < channel.codes.size(); ++n) {
    const double time_s = first_s + 1e-6 * static_cast<double>(n);
    EXPECT_NEAR(channel.scale * channel.codes[n], bell(time_s), 2e-9) << n;
  }
}

// Values belong to the times beside them: at half a per cent off the bench's rate the record has
// what the signal was at the bench's times.
TEST(TableForms, AnotherRateIsInterpolatedToTheBenchs) {
  const auto slower = [](int i) { return 1.005e-6 * i; };
  const Shot shot = TableBench(1).import({{"a.csv", table_of_bell(1001, slower)}});
  EXPECT_EQ(shot.samples(), 1006U);
  EXPECT_NEAR(std::stod(shot.meta.at(kInterpolatedFrom)), 5.0, 1e-6);
  expect_bell(shot, 0.0);
}

// What times scatter by within their tolerance is theirs: the samples stay what they are.
TEST(TableForms, ScatteredTimesLeaveTheSamplesAlone) {
  const auto scattered = [](int i) { return 1e-6 * i + 0.02e-6 * std::sin(2.0 * i); };
  const Shot shot = TableBench(1).import({{"a.csv", table_of_bell(1001, scattered)}});
  EXPECT_FALSE(shot.meta.contains(kInterpolatedFrom));
  const ChannelRecord& channel = shot.channels[0];
  for (int i = 0; i < 1001; ++i) {
    const auto n = static_cast<std::size_t>(i);
    EXPECT_NEAR(channel.scale * channel.codes[n], bell(scattered(i)), 1e-11) << i;
  }
}

TEST(TableForms, FourTablesOfFiftyThousandRowsAreQuick) {
  const TableBench bench(4);
  std::vector<testing::NamedText> tables;
  for (int channel = 0; channel < 4; ++channel) {
    std::string text = "time_s,g" + std::to_string(channel + 1) + "\n";
    for (int i = 0; i < 50'000; ++i) {
      std::array<char, 64> row{};
      (void)std::snprintf(row.data(), row.size(), "%.9e,%.15e\n", (i - 10'000) * 1e-6,
                          1e-3 * std::sin(0.001 * i + channel));
      text += row.data();
    }
    tables.push_back({"c" + std::to_string(channel) + ".csv", text});
  }
  const TableImport request = bench.request(tables);
  const auto start = std::chrono::steady_clock::now();
  const Shot shot = import_tables(request);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  EXPECT_EQ(shot.samples(), 50'000U);
  EXPECT_NEAR(testing::values_of(shot, 3)[40'000], 1e-3 * std::sin(43.0), 4e-12);
#if !defined(KOLSKY_SANITIZED) && defined(NDEBUG)
  EXPECT_LT(took.count(), 0.5);
#endif
  RecordProperty("seconds", std::to_string(took.count()));
}

}  // namespace
}  // namespace kolsky
