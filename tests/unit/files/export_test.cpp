#include "drivers/files/exports/export.hpp"

#include <hdf5.h>
#include <matio.h>

#include <fstream>
#include <limits>
#include <sstream>

#include "drivers/files/captures/hdf5_handles.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/unit/files/full_disk.hpp"
#include "tests/unit/files/stored_shots.hpp"

namespace kolsky {
namespace {

using testing::bytes_of;
using testing::expect_refused;
using testing::make_shot;
using testing::ScratchFolder;

Reduction make_reduction() {
  Reduction reduction;
  for (int i = 0; i < 20; ++i) {
    const double x = i / 7.0;
    reduction.time_s.push_back(1e-6 * i);
    reduction.stress_Pa.push_back(1e8 * x);
    reduction.strain.push_back(0.01 * x);
    reduction.strain_rate_per_s.push_back(1e3 / (1 + x));
    reduction.force_front_N.push_back(-x);
    reduction.force_back_N.push_back(1e-300 * x);
    reduction.incident.push_back(x * x);
    reduction.reflected.push_back(-1e-3 * x);
    reduction.transmitted.push_back(std::numeric_limits<double>::denorm_min() * i);
  }
  reduction.bar_model = "PMMA";
  reduction.quality.reducible = true;
  reduction.quality.checks = {{"clipping", 2.0, 0.0, "samples", Verdict::warn, "2 codes clipped"}};
  return reduction;
}

struct Table {
  std::string header;
  std::vector<std::vector<double>> columns;
};

Table read_csv(const std::filesystem::path& path) {
  std::ifstream file(path);
  Table table;
  std::getline(file, table.header);
  for (std::string line; std::getline(file, line);) {
    std::istringstream cells(line);
    std::size_t column = 0;
    for (std::string cell; std::getline(cells, cell, ','); ++column) {
      table.columns.resize(std::max(table.columns.size(), column + 1));
      table.columns[column].push_back(std::strtod(cell.c_str(), nullptr));
    }
  }
  return table;
}

TEST(ExportCsv, WritesHistoriesAndGaugesBitForBit) {
  const ScratchFolder folder;
  const Shot shot = make_shot(1);
  const Reduction reduction = make_reduction();
  export_shot(shot, reduction, ExportFormat::csv, folder / "x.csv");
  const Table histories = read_csv(folder / "x.csv");
  EXPECT_EQ(histories.header,
            "time_s,stress_Pa,strain,strain_rate_per_s,force_front_N,force_back_N,incident_strain,"
            "reflected_strain,transmitted_strain");
  ASSERT_EQ(histories.columns.size(), 9U);
  EXPECT_EQ(histories.columns[0], reduction.time_s);
  EXPECT_EQ(histories.columns[1], reduction.stress_Pa);
  EXPECT_EQ(histories.columns[5], reduction.force_back_N);
  EXPECT_EQ(histories.columns[8], reduction.transmitted);
  const Table gauges = read_csv(folder / "x-gauges.csv");
  EXPECT_EQ(gauges.header, "time_s,g1_strain,g2_strain");
  ASSERT_EQ(gauges.columns.size(), 3U);
  for (std::size_t i = 0; i < shot.samples(); ++i) {
    const ChannelRecord& g2 = shot.channels[1];
    EXPECT_EQ(gauges.columns[2][i], (g2.codes[i] + g2.offset) * g2.scale);
    EXPECT_NEAR(gauges.columns[0][i], (static_cast<double>(i) - 40.1) * 3e-6, 1e-17);
  }
}

TEST(ExportCsv, QuotesWhatWouldEndACell) {
  const ScratchFolder folder;
  Shot shot = make_shot(2);
  shot.channels[0].gauge = "in, \"near\"";
  export_shot(shot, make_reduction(), ExportFormat::csv, folder / "x.csv");
  EXPECT_EQ(read_csv(folder / "x-gauges.csv").header, R"(time_s,"in, ""near""_strain",g2_strain)");
}

TEST(ExportCsv, AShotThatCannotBeReducedHasHistoriesWithoutRows) {
  const ScratchFolder folder;
  export_shot(make_shot(3), Reduction{}, ExportFormat::csv, folder / "x.csv");
  EXPECT_TRUE(read_csv(folder / "x.csv").columns.empty());
  EXPECT_EQ(read_csv(folder / "x-gauges.csv").columns.size(), 3U);
}

std::vector<double> mat_column(mat_t* file, const char* name) {
  matvar_t* variable = Mat_VarRead(file, name);
  if (variable == nullptr || variable->class_type != MAT_C_DOUBLE) {
    ADD_FAILURE() << "no column " << name;
    return {};
  }
  const auto* data = static_cast<const double*>(variable->data);
  std::vector<double> values(data, data + variable->nbytes / sizeof(double));
  Mat_VarFree(variable);
  return values;
}

TEST(ExportMat, WritesAColumnPerVariable) {
  const ScratchFolder folder;
  Shot shot = make_shot(4, {2, 300});
  shot.channels[0].gauge = "1st gauge";
  const Reduction reduction = make_reduction();
  export_shot(shot, reduction, ExportFormat::mat, folder / "x.mat");
  // MAT version 5 in little endian: version 0x0100 and "MI" as its bytes lie, at 124.
  const auto bytes = bytes_of(folder / "x.mat");
  EXPECT_EQ((std::vector<std::byte>{bytes.begin() + 124, bytes.begin() + 128}),
            (std::vector<std::byte>{std::byte{0}, std::byte{1}, std::byte{'I'}, std::byte{'M'}}));
  mat_t* file = Mat_Open((folder / "x.mat").c_str(), MAT_ACC_RDONLY);
  ASSERT_NE(file, nullptr);
  EXPECT_EQ(mat_column(file, "stress_Pa"), reduction.stress_Pa);
  EXPECT_EQ(mat_column(file, "transmitted_strain"), reduction.transmitted);
  EXPECT_EQ(mat_column(file, "gauge_time_s").size(), 300U);
  EXPECT_EQ(mat_column(file, "x1st_gauge_strain").size(), 300U);
  const auto g2 = mat_column(file, "g2_strain");
  ASSERT_EQ(g2.size(), 300U);
  EXPECT_EQ(g2[17],
            (shot.channels[1].codes[17] + shot.channels[1].offset) * shot.channels[1].scale);
  matvar_t* id = Mat_VarRead(file, "shot_id");
  ASSERT_NE(id, nullptr);
  EXPECT_EQ(std::string(static_cast<const char*>(id->data), id->nbytes), "shot-4");
  Mat_VarFree(id);
  Mat_Close(file);
}

// With room for nothing, for a part, and for all but the last byte.
TEST(Export, RefusesOnAFullDiskAndLeavesNothing) {
  const ScratchFolder folder;
  const Shot shot = make_shot(4, {2, 3000});
  const Reduction reduction = make_reduction();
  const std::pair<ExportFormat, std::string> formats[] = {{ExportFormat::csv, "whole.csv"},
                                                          {ExportFormat::mat, "whole.mat"},
                                                          {ExportFormat::hdf5, "whole.h5"}};
  for (const auto& [format, whole] : formats) {
    export_shot(shot, reduction, format, folder / whole);
    const auto left = testing::entries_of(folder.path());
    const auto bytes = std::filesystem::file_size(folder / whole);
    for (const auto room : {std::uintmax_t{0}, bytes / 3, bytes - 1}) {
      const testing::FullDisk disk(room);
      const auto message = expect_refused(
          [&] { export_shot(shot, reduction, format, folder / ("x" + whole)); }, {"space"});
      EXPECT_NE(message.find(folder.path().string()), std::string::npos) << message;
      EXPECT_EQ(testing::entries_of(folder.path()), left) << whole << " with room for " << room;
    }
  }
}

TEST(ExportMat, WritesAShotThatCannotBeReduced) {
  const ScratchFolder folder;
  Reduction none;
  none.quality.reason = "no pulse";
  export_shot(make_shot(5), none, ExportFormat::mat, folder / "x.mat");
  mat_t* file = Mat_Open((folder / "x.mat").c_str(), MAT_ACC_RDONLY);
  ASSERT_NE(file, nullptr);
  EXPECT_TRUE(mat_column(file, "stress_Pa").empty());
  EXPECT_EQ(mat_column(file, "g1_strain").size(), 500U);
  Mat_Close(file);
}

std::vector<double> hdf5_column(hid_t file, const char* path) {
  const hdf5::Dataset dataset(H5Dopen2(file, path, H5P_DEFAULT), path);
  const hdf5::Space space(H5Dget_space(dataset), path);
  std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  return values;
}

std::string hdf5_text(hid_t file, const char* path, const char* name) {
  const hdf5::Attribute attribute(H5Aopen_by_name(file, path, name, H5P_DEFAULT, H5P_DEFAULT),
                                  name);
  const hdf5::Type type(H5Aget_type(attribute), name);
  char* text = nullptr;
  H5Aread(attribute, type, static_cast<void*>(&text));
  std::string copy = text == nullptr ? "" : text;
  H5free_memory(text);
  return copy;
}

TEST(ExportHdf5, WritesGroupsThatPlot) {
  const ScratchFolder folder;
  const Reduction reduction = make_reduction();
  export_shot(make_shot(6), reduction, ExportFormat::hdf5, folder / "x.h5");
  const hdf5::Session session;
  const hdf5::File file(H5Fopen((folder / "x.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "x.h5");
  EXPECT_EQ(hdf5_text(file, "/", "default"), "entry");
  EXPECT_EQ(hdf5_text(file, "/entry", "default"), "histories");
  EXPECT_EQ(hdf5_text(file, "/entry/histories", "NX_class"), "NXdata");
  EXPECT_EQ(hdf5_text(file, "/entry/histories", "signal"), "stress_Pa");
  EXPECT_EQ(hdf5_text(file, "/entry/histories", "axes"), "time_s");
  EXPECT_EQ(hdf5_text(file, "/entry/histories/stress_Pa", "units"), "Pa");
  EXPECT_EQ(hdf5_text(file, "/entry/quality/clipping", "verdict"), "warn");
  EXPECT_EQ(hdf5_column(file, "/entry/histories/stress_Pa"), reduction.stress_Pa);
  EXPECT_EQ(hdf5_column(file, "/entry/gauges/g2_strain").size(), 500U);
}

TEST(ExportHdf5, AShotThatCannotBeReducedShowsItsGauges) {
  const ScratchFolder folder;
  Reduction none;
  none.quality.reason = "no pulse";
  export_shot(make_shot(7), none, ExportFormat::hdf5, folder / "x.h5");
  const hdf5::Session session;
  const hdf5::File file(H5Fopen((folder / "x.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "x.h5");
  EXPECT_EQ(hdf5_text(file, "/entry", "default"), "gauges");
  EXPECT_EQ(hdf5_text(file, "/entry/quality", "reason"), "no pulse");
  EXPECT_EQ(H5Lexists(file, "/entry/histories", H5P_DEFAULT), 0);
}

class ExportOver : public ::testing::TestWithParam<ExportFormat> {};

TEST_P(ExportOver, AnExistingFileIsRefusedAndNothingIsLeft) {
  const ScratchFolder folder;
  std::ofstream(folder / "x.out") << "mine";
  expect_refused([&] { export_shot(make_shot(8), make_reduction(), GetParam(), folder / "x.out"); },
                 {"x.out", "exists"});
  EXPECT_EQ(bytes_of(folder / "x.out").size(), 4U);
  const std::filesystem::directory_iterator items(folder.path());
  EXPECT_EQ(std::distance(begin(items), end(items)), 1);
}

INSTANTIATE_TEST_SUITE_P(Formats, ExportOver,
                         ::testing::Values(ExportFormat::csv, ExportFormat::mat,
                                           ExportFormat::hdf5));

TEST(ExportCsv, AnExistingSecondFileIsRefusedToo) {
  const ScratchFolder folder;
  std::ofstream(folder / "x-gauges.csv") << "mine";
  expect_refused(
      [&] { export_shot(make_shot(9), make_reduction(), ExportFormat::csv, folder / "x.csv"); },
      {"x-gauges.csv", "exists"});
  EXPECT_FALSE(std::filesystem::exists(folder / "x.csv"));
}

}  // namespace
}  // namespace kolsky
