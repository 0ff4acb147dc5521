// The same shot gives the same bits, whatever the program has transformed before.
#include <gtest/gtest.h>

#include "processing/reduction/reducer.hpp"
#include "processing/waves/transform.hpp"
#include "tests/generators/elastic_shpb.hpp"

namespace kolsky {
namespace {

TEST(Repeatability, OtherLengthsPlannedBeforeChangeNoBit) {
  const testing::ElasticShpb model;
  const Shot shot = model.shot(model.solve(), 4e-6, 16, 0.01, 1);
  const Reduction alone = Reducer().reduce(shot);
  for (std::size_t samples = 500; samples < 5000; samples += 173) {
    const DampedTransform other(samples, 1e-6);
  }
  const Reduction after = Reducer().reduce(shot);
  EXPECT_EQ(alone.stress_Pa, after.stress_Pa);
  EXPECT_EQ(alone.strain, after.strain);
  Reducer used;
  testing::ElasticShpb longer = model;
  longer.duration_s = 2.1e-3;
  longer.gauge_to_A_m = 0.3;
  (void)used.reduce(longer.shot(longer.solve(), 1e-6, 16, 0.01, 2));
  EXPECT_EQ(used.reduce(shot).stress_Pa, alone.stress_Pa);
}

}  // namespace
}  // namespace kolsky
