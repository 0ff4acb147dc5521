#include "drivers/files/settings/bench_edit.hpp"

#include <gtest/gtest.h>

#include "drivers/files/settings/bench_file.hpp"
#include "processing/base/error.hpp"

namespace kolsky {
namespace {

const char* const kText = R"(kind = "bar"
sampling_frequency_Hz = 1e6

[bars.input]  # the long one
length_m = 2.0
diameter_m = 0.020
density_kg_m3 = 1180.0
poisson_ratio = 0.36

[[gauges]]
name = "g1"
bar = "input"
position_m = 0.100   # tape
unit = "strain"

[[gauges]]
name = "g2"
bar = "input"
position_m = 0.300
position_m_sd = 0.001
unit = "strain"
)";

TEST(BenchEdit, ChangesWhatIsNamedAndNothingElse) {
  const std::string text = edit_bench(kText, {{"gauges", 0, "position_m", "0.105"},
                                              {"gauges", 0, "position_m_sd", "0.0002"},
                                              {"gauges", 1, "position_m_sd", std::nullopt},
                                              {"bars.input", 0, "length_m_sd", "0.001"}});
  const Bench bench = parse_bench(text, "edited");
  EXPECT_EQ(bench.gauges[0].position_m.value, 0.105);
  EXPECT_EQ(bench.gauges[0].position_m.sd, 0.0002);
  EXPECT_EQ(bench.gauges[1].position_m.value, 0.3);
  EXPECT_EQ(bench.gauges[1].position_m.sd, 0.0);
  EXPECT_EQ(bench.input.length_m.value, 2.0);
  EXPECT_EQ(bench.input.length_m.sd, 0.001);
  EXPECT_NE(text.find("# tape"), std::string::npos);
  EXPECT_NE(text.find("[bars.input]  # the long one"), std::string::npos);
  EXPECT_EQ(edit_bench(kText, {}), kText);
}

TEST(BenchEdit, RefusesTablesThatAreNotWrittenOut) {
  EXPECT_THROW((void)edit_bench("bars = { input = { length_m = 2.0 } }\n",
                                {{"bars.input", 0, "length_m", "2.1"}}),
               InputError);
  EXPECT_THROW((void)edit_bench(kText, {{"gauges", 2, "position_m", "1"}}), InputError);
}

}  // namespace
}  // namespace kolsky
