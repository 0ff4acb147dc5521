#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "drivers/files/settings/bench_file.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/unit/tables/table_bench.hpp"

namespace kolsky {
namespace {

const std::filesystem::path kReal = std::filesystem::path(KOLSKY_SHARED_DATA) / "real";
const std::filesystem::path kFiniteElement = std::filesystem::path(KOLSKY_SHARED_DATA) / "fe";
const std::filesystem::path kBenches = std::filesystem::path(KOLSKY_SOURCE_DIR) / "docs/benches";

Shot import_set(const std::string& bench, const std::vector<std::filesystem::path>& tables) {
  TableImport request;
  request.bench = kBenches / bench;
  request.tables = tables;
  return import_tables(request);
}

// The cells of a row, the plain way.
std::vector<std::string> cells_of(std::string line, char separator) {
  if (!line.empty() && line.back() == '\r') {
    line.pop_back();
  }
  std::vector<std::string> cells;
  std::istringstream row(line);
  for (std::string cell; std::getline(row, cell, separator);) {
    cells.push_back(cell);
  }
  return cells;
}

std::vector<double> column_of(const std::filesystem::path& path, char separator,
                              std::size_t skipped, std::size_t cell) {
  std::ifstream file(path);
  std::vector<double> values;
  std::string line;
  for (std::size_t row = 0; std::getline(file, line); ++row) {
    if (row >= skipped) {
      values.push_back(std::strtod(cells_of(line, separator).at(cell).c_str(), nullptr));
    }
  }
  return values;
}

void expect_column(const Shot& shot, std::size_t channel, const std::vector<double>& column,
                   double factor) {
  const std::vector<double> values = testing::values_of(shot, channel);
  ASSERT_EQ(values.size(), column.size());
  double largest = 0.0;
  double worst = 0.0;
  for (std::size_t i = 0; i < column.size(); ++i) {
    largest = std::max(largest, std::abs(column[i] * factor));
    worst = std::max(worst, std::abs(values[i] - column[i] * factor));
  }
  // Beside 14 to 16 bits of an oscilloscope.
  EXPECT_LE(worst, 1e-6 * largest);
  EXPECT_LE(worst, 0.5 * shot.channels[channel].scale * (1.0 + 1e-9));
  EXPECT_TRUE(clipped_samples(shot.channels[channel]).empty());
}

class MeasuredSets : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kReal)) {
      GTEST_SKIP() << "no measured records at " << kReal;
    }
  }
};

TEST_F(MeasuredSets, SixShotsOnSteel) {
  for (int shot_number = 1; shot_number <= 6; ++shot_number) {
    const auto path = kReal / "steel-20mm-bars/steel-945" /
                      ("945steel_compression_0" + std::to_string(shot_number) + ".csv");
    const Shot shot = import_set("steel-945.toml", {path});
    EXPECT_EQ(shot.samples(), 20'000U);
    EXPECT_EQ(shot.rate, (SampleRate{31'250'000, 1}));
    expect_column(shot, 0, column_of(path, ',', 1, 1), 1e-6);
    expect_column(shot, 1, column_of(path, ',', 1, 2), 1e-6);
    EXPECT_EQ(shot.channels[0].unit, "strain");
  }
}

TEST_F(MeasuredSets, TwoShotsOnEpoxy) {
  for (const char* const name : {"sample_01_voltage.csv", "sample_02_voltage.csv"}) {
    const auto path = kReal / "steel-20mm-bars/epoxy" / name;
    const Shot shot = import_set("epoxy.toml", {path});
    EXPECT_EQ(shot.samples(), 20'000U);
    EXPECT_EQ(shot.rate, (SampleRate{12'500'000, 1}));
    expect_column(shot, 0, column_of(path, ',', 1, 1), 1.0);
    expect_column(shot, 1, column_of(path, ',', 1, 2), 1.0);
    EXPECT_EQ(shot.channels[1].unit, "V");
  }
}

TEST_F(MeasuredSets, CopperWaveforms) {
  const auto path = kReal / "lanl-ti-bar-copper/20061201_1148HE_CuOFE_273K.raw";
  const Shot shot = import_set("lanl-copper.toml", {path});
  EXPECT_EQ(shot.samples(), 5000U);
  EXPECT_EQ(shot.rate, (SampleRate{10'000'000, 1}));
  EXPECT_NEAR(std::stod(shot.meta.at("first_sample_s")), -5e-5, 1e-12);
  expect_column(shot, 0, column_of(path, '\t', 3, 2), 1.0);
  expect_column(shot, 1, column_of(path, '\t', 3, 3), 1.0);
}

TEST_F(MeasuredSets, FourChannelsOfTheMiniBars) {
  std::vector<std::filesystem::path> paths;
  for (const char channel : {'1', '2', '3', '4'}) {
    paths.push_back(kReal / "lanl-mini-kolsky-pmma" /
                    (std::string("180303_171828_Ch") + channel + ".csv"));
  }
  const Shot shot = import_set("lanl-pmma.toml", paths);
  EXPECT_EQ(shot.samples(), 50'000U);
  EXPECT_EQ(shot.rate, (SampleRate{125'000'000, 1}));
  EXPECT_NEAR(std::stod(shot.meta.at("first_sample_s")), -8e-5, 1e-12);
  for (std::size_t i = 0; i < paths.size(); ++i) {
    expect_column(shot, i, column_of(paths[i], ',', 0, 4), 1.0);
  }
}

// The steps of the finite-element records scatter by 2 %; their columns are found by name among
// eleven.
TEST_F(MeasuredSets, FiniteElementRecords) {
  const auto path = kFiniteElement / "wave-separation/copper/gauge_strain_records.csv";
  const testing::ScratchFolder folder;
  std::string bench = testing::bench_text(2, "strain");
  const auto replace = [&](const std::string& what, const std::string& with) {
    bench.replace(bench.find(what), what.size(), with);
  };
  replace("= 1.0e6", "= 400e3");
  replace("\"g1\"", "\"gauge1_incident_bar_strain\"");
  replace("\"g2\"", "\"gauge2_transmission_bar_strain\"");
  TableImport request;
  request.bench = folder.write("bench.toml", bench);
  request.tables = {path};
  const Shot shot = import_tables(request);
  expect_column(shot, 0, column_of(path, ',', 1, 1), 1.0);
  expect_column(shot, 1, column_of(path, ',', 1, 2), 1.0);
  EXPECT_NE(shot.meta.at("ignored_columns").find("incident_end_mean_v3_mm_per_s"),
            std::string::npos);
}

// One bench for another's table: the rate tells.
TEST_F(MeasuredSets, TheWrongBenchIsRefused) {
  const auto path = kReal / "steel-20mm-bars/epoxy/sample_01_voltage.csv";
  const std::string line = testing::refusal_of([&] { (void)import_set("steel-945.toml", {path}); });
  EXPECT_NE(line.find("sample_01_voltage.csv: time: gives 1.25e+07"), std::string::npos) << line;
}

TEST(ExampleBenches, AllRead) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kBenches)) {
    EXPECT_NO_THROW((void)read_bench(entry.path())) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 6);
}

// Distances the sources give from the specimen.
TEST(ExampleBenches, GaugesStandWhereTheSourcesSay) {
  const auto distance_mm = [](const std::string& name, std::size_t gauge) {
    const Bench bench = read_bench(kBenches / name).bench;
    return 1e3 * bench.distance_to_specimen_m(bench.gauges.at(gauge));
  };
  EXPECT_NEAR(distance_mm("paper-shpb.toml", 0), 300.0, 1e-9);
  EXPECT_NEAR(distance_mm("paper-shpb.toml", 1), 50.0, 1e-9);
  EXPECT_NEAR(distance_mm("steel-945.toml", 0), 1020.0, 1e-9);
  EXPECT_NEAR(distance_mm("steel-945.toml", 1), 770.0, 1e-9);
  EXPECT_NEAR(distance_mm("epoxy.toml", 0), 1018.0, 1e-9);
  EXPECT_NEAR(distance_mm("epoxy.toml", 1), 741.0, 1e-9);
  EXPECT_NEAR(distance_mm("lanl-copper.toml", 0), 381.0, 1e-9);
  EXPECT_NEAR(distance_mm("lanl-copper.toml", 1), 381.0, 1e-9);
  EXPECT_NEAR(distance_mm("lanl-pmma.toml", 0), 102.02, 1e-9);
  EXPECT_NEAR(distance_mm("lanl-pmma.toml", 3), 101.35, 1e-9);
}

}  // namespace
}  // namespace kolsky
