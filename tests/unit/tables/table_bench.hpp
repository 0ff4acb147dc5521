#pragma once

#include <string>
#include <vector>

#include "drivers/files/tables/table_import.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/unit/tables/refusal.hpp"

namespace kolsky::testing {

/// A bench with gauges g1, g2, ... of one unit on the input bar, sampled at 1 MHz.
inline std::string bench_text(int gauges, const std::string& unit) {
  std::string text = R"(kind = "bar"
sampling_frequency_Hz = 1.0e6
[bars.input]
length_m = 2.0
diameter_m = 0.02
density_kg_m3 = 1180
poisson_ratio = 0.36
)";
  for (int i = 1; i <= gauges; ++i) {
    text += "[[gauges]]\nname = \"g" + std::to_string(i) + "\"\nbar = \"input\"\nposition_m = 0." +
            std::to_string(i) + "\nunit = \"" + unit + "\"\n";
    text += unit == "V" ? "strain_per_V = 1e-3\n" : "";
  }
  return text;
}

struct NamedText {
  std::string name;
  std::string text;
};

/// Imports tables, written to a folder of their own, for such a bench.
class TableBench {
 public:
  explicit TableBench(int gauges, const std::string& unit = "strain")
      : bench_(folder_.write("bench.toml", bench_text(gauges, unit))) {}

  [[nodiscard]] Shot import(const std::vector<NamedText>& tables) const {
    return import_tables(request(tables));
  }

  [[nodiscard]] TableImport request(const std::vector<NamedText>& tables) const {
    TableImport request;
    request.bench = bench_;
    request.utc_ns = 1'700'000'000'000'000'000;
    for (const NamedText& table : tables) {
      request.tables.push_back(folder_.write(table.name, table.text));
    }
    return request;
  }

  /// The refusal without the folder's name.
  [[nodiscard]] std::string refusal(const std::vector<NamedText>& tables) const {
    std::string line = refusal_of([&] { (void)import(tables); });
    const std::string folder = folder_.path().string() + "/";
    for (std::size_t at = line.find(folder); at != std::string::npos; at = line.find(folder)) {
      line.erase(at, folder.size());
    }
    return line;
  }

 private:
  ScratchFolder folder_;
  std::filesystem::path bench_;
};

/// A channel's samples in its unit.
inline std::vector<double> values_of(const Shot& shot, std::size_t channel) {
  std::vector<double> values;
  for (const std::int32_t code : shot.channels.at(channel).codes) {
    values.push_back(shot.channels[channel].value(code));
  }
  return values;
}

inline void expect_values(const Shot& shot, std::size_t channel,
                          const std::vector<double>& expected) {
  const std::vector<double> values = values_of(shot, channel);
  ASSERT_EQ(values.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const double half_step = 0.5 * shot.channels[channel].scale;
    EXPECT_NEAR(values[i], expected[i], half_step + 1e-12 * std::abs(expected[i]))
        << "sample " << i;
  }
}

}  // namespace kolsky::testing
