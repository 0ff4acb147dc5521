// Incident records of other laboratories. What the trigger should find is told apart from it: the
// first time at which the mean over a microsecond stays beyond a share of the incident pulse's
// height.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "processing/trigger/incident_trigger.hpp"

namespace kolsky {
namespace {

struct Record {
  const char* file;  ///< below real/
  int header_lines;
  char separator;
  int column;     ///< of the incident gauge
  double step_s;  ///< from one sample to the next
  double unit_per_code;
};

constexpr Record kRecords[] = {
    {"steel-20mm-bars/steel-945/945steel_compression_01.csv", 1, ',', 1, 32e-9, 0.1},
    {"steel-20mm-bars/steel-945/945steel_compression_02.csv", 1, ',', 1, 32e-9, 0.1},
    {"steel-20mm-bars/steel-945/945steel_compression_03.csv", 1, ',', 1, 32e-9, 0.1},
    {"steel-20mm-bars/steel-945/945steel_compression_04.csv", 1, ',', 1, 32e-9, 0.1},
    {"steel-20mm-bars/steel-945/945steel_compression_05.csv", 1, ',', 1, 32e-9, 0.1},
    {"steel-20mm-bars/steel-945/945steel_compression_06.csv", 1, ',', 1, 32e-9, 0.1},
    {"steel-20mm-bars/epoxy/sample_01_voltage.csv", 1, ',', 1, 80e-9, 1e-4},
    {"steel-20mm-bars/epoxy/sample_02_voltage.csv", 1, ',', 1, 80e-9, 1e-4},
    {"lanl-mini-kolsky-pmma/180303_171828_Ch1.csv", 0, ',', 4, 8e-9, 1e-4},
    {"lanl-ti-bar-copper/20061201_1148HE_CuOFE_273K.raw", 3, '\t', 2, 100e-9, 2e-4},
};

std::vector<double> read(const std::filesystem::path& path, const Record& record) {
  std::ifstream file(path);
  std::vector<double> values;
  std::string line;
  for (int skipped = 0; skipped < record.header_lines; ++skipped) std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream fields(line);
    std::string field;
    for (int column = 0; column <= record.column; ++column)
      std::getline(fields, field, record.separator);
    if (!field.empty() && field != "\r") values.push_back(std::stod(field));
  }
  return values;
}

double mean(const std::vector<double>& values, std::size_t first, std::size_t count) {
  double sum = 0.0;
  for (std::size_t i = first; i < first + count; ++i) sum += values[i];
  return sum / static_cast<double>(count);
}

// First sample from which the running mean stays beyond a share of the first pulse's height for 3
// us.
std::size_t beyond(const std::vector<double>& values, double share, double step_s) {
  const auto window = static_cast<std::size_t>(1e-6 / step_s) + 1;
  const auto stay = static_cast<std::size_t>(3e-6 / step_s);
  const double base = mean(values, 0, static_cast<std::size_t>(20e-6 / step_s));
  double peak = 0.0;
  for (std::size_t i = 0; i + window < values.size(); ++i) {
    peak = std::max(peak, std::abs(mean(values, i, window) - base));
  }
  std::size_t held = 0;
  for (std::size_t i = 0; i + window < values.size(); ++i) {
    held = std::abs(mean(values, i, window) - base) > share * peak ? held + 1 : 0;
    if (held > stay) return i + window / 2 - held;
  }
  return values.size();
}

class Measured : public testing::TestWithParam<Record> {};

TEST_P(Measured, IncidentPulseIsFoundOnItsFlank) {
  const Record& record = GetParam();
  const auto path = std::filesystem::path(KOLSKY_SHARED_DATA) / "real" / record.file;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no measured records at " << path;
  const std::vector<double> values = read(path, record);
  std::vector<std::int16_t> codes;
  codes.reserve(values.size());
  for (const double value : values) {
    codes.push_back(static_cast<std::int16_t>(std::lround(value / record.unit_per_code)));
  }

  IncidentTrigger trigger(TriggerOptions::for_rate(1.0 / record.step_s));
  std::vector<TriggerEvent> events;
  const std::span<const std::int16_t> all(codes);
  for (std::size_t at = 0; at < all.size(); at += 500) {
    const auto block = all.subspan(at, std::min<std::size_t>(500, all.size() - at));
    const auto event = trigger.feed(static_cast<Tick>(at), block, run_statistics(block));
    if (event) events.push_back(*event);
  }
  ASSERT_EQ(events.size(), 1U);
  const auto slack = static_cast<Tick>(1e-6 / record.step_s);
  EXPECT_GE(events[0].tick, static_cast<Tick>(beyond(values, 0.01, record.step_s)) - slack);
  EXPECT_LE(events[0].tick, static_cast<Tick>(beyond(values, 0.35, record.step_s)) + slack);
  EXPECT_LT(events[0].sigma_samples * record.step_s, 1e-6);
  RecordProperty("time_us",
                 std::to_string((static_cast<double>(events[0].tick) + events[0].fraction) *
                                record.step_s * 1e6));
  RecordProperty("sigma_us", std::to_string(events[0].sigma_samples * record.step_s * 1e6));
}

INSTANTIATE_TEST_SUITE_P(Records, Measured, testing::ValuesIn(kRecords), [](const auto& tested) {
  return std::filesystem::path(tested.param.file).stem().string();
});

}  // namespace
}  // namespace kolsky
