#include "tests/generators/solid_specimen.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "processing/base/error.hpp"
#include "tests/generators/paper_split_bar.hpp"

namespace kolsky::testing {
namespace {

/// Of 4 microstrain of noise on pulses of 3000.
constexpr double kAllowed = 0.3 * 4.0 / 3000.0;

/// Struck so that the specimen's strains are small.
ShpbWorld bench() {
  return paper_split_bar(2e6);
}

ShpbWorld solid(ShpbWorld world) {
  world.specimen.solid = true;
  return world;
}

using Record = std::vector<double>;

/// What the output bar reads over the largest that either bar does.
Record transmitted(const ShpbWorld& world) {
  Readings read = shpb_readings(world);
  double largest = 0.0;
  for (const double value : read[0][0]) {
    largest = std::max(largest, std::abs(value));
  }
  for (double& value : read[0][1]) {
    value /= largest;
  }
  return read[0][1];
}

Record less(Record one, const Record& other) {
  for (std::size_t n = 0; n < one.size(); ++n) {
    one[n] -= other[n];
  }
  return one;
}

double largest(const Record& record) {
  double found = 0.0;
  for (const double value : record) {
    found = std::max(found, std::abs(value));
  }
  return found;
}

/// How much of a change there is in another until the load is highest, by least squares.
double share_of(const Record& change, const Record& in) {
  static const Record load = transmitted(bench());
  const auto end = static_cast<std::size_t>(std::ranges::max_element(load) - load.begin());
  double product = 0.0;
  double square = 0.0;
  for (std::size_t n = 0; n < end; ++n) {
    product += change[n] * in[n];
    square += change[n] * change[n];
  }
  return product / square;
}

// Without lateral strain nothing goes sideways: the solid is a rod that waves cross.
TEST(SolidSpecimen, WithoutLateralStrainIsARod) {
  ShpbWorld world = bench();
  world.specimen.poisson_ratio = 0.0;
  const Record body = transmitted(solid(world));
  const Record lump = transmitted(world);
  world.specimen.inertia = 1.0;
  const Record rod = transmitted(world);
  EXPECT_LT(largest(less(body, rod)), 0.3 * kAllowed);
  EXPECT_GT(largest(less(body, lump)), kAllowed);
}

/// Struck by a half wave, of a length over which a specimen widens alike throughout.
ShpbWorld struck_gently() {
  constexpr double kLength_s = 300e-6;
  ShpbWorld world = bench();
  std::vector<double>& source = world.base.shots[0].source;
  for (std::size_t k = 0; k < source.size(); ++k) {
    const double since_s = static_cast<double>(k) * world.base.timing.knot_s() - 400e-6;
    const bool during = since_s > 0.0 && since_s < kLength_s;
    source[k] = during ? 2e6 * std::pow(std::sin(std::numbers::pi * since_s / kLength_s), 2) : 0.0;
  }
  return world;
}

// The definition is the kinetic energy of a body that widens alike throughout.
TEST(SolidSpecimen, WidensAgainstItsOwnMass) {
  ShpbWorld still = struck_gently();
  still.specimen.poisson_ratio = 0.0;
  ShpbWorld moving = struck_gently();
  moving.specimen.radial_inertia = 1.0;
  const Record defined = less(transmitted(moving), transmitted(struck_gently()));
  const Record body = less(transmitted(solid(struck_gently())), transmitted(solid(still)));
  EXPECT_NEAR(share_of(defined, body), 1.0, 0.05);
  EXPECT_GT(largest(defined), kAllowed);
}

// Betti's theorem with the state of uniform stress: while all of a face slides outwards, friction
// raises the force by 2 nu mu d/(3 h) at the same shortening, to first order. The definition,
// mu d/(3 h), is that of a body which keeps its volume. When it slides back the force falls.
TEST(SolidSpecimen, RubsByTwicePoissonsRatioOfWhatTheDefinitionSays) {
  constexpr double kFriction = 0.02;
  ShpbWorld defined = bench();
  defined.specimen.friction = kFriction;
  const Record law = less(transmitted(defined), transmitted(bench()));
  for (const double nu : {0.25, 0.376, 0.45}) {
    ShpbWorld smooth = solid(bench());
    smooth.specimen.poisson_ratio = nu;
    ShpbWorld rough = smooth;
    rough.specimen.friction = kFriction;
    EXPECT_NEAR(share_of(law, less(transmitted(rough), transmitted(smooth))), 2.0 * nu, 0.1 * nu)
        << nu;
  }
  EXPECT_GT(largest(law), kAllowed);
}

TEST(SolidSpecimen, SettlesAsItsCellsGetSmaller) {
  ShpbWorld world = solid(bench());
  world.specimen.friction = 0.2;
  const Record usual = transmitted(world);
  // Its shortest wave takes as many steps, of half the length.
  Readings finer = shpb_readings(world, {0.125e-6});
  double top = 0.0;
  for (const double value : finer[0][0]) {
    top = std::max(top, std::abs(value));
  }
  for (double& value : finer[0][1]) {
    value /= top;
  }
  EXPECT_LT(largest(less(usual, finer[0][1])), kAllowed);
}

TEST(SolidSpecimen, RefusesABodyThatAWaveCrossesInAFewSteps) {
  ShpbWorld world = solid(bench());
  world.specimen.E1_Pa = 70e9;
  EXPECT_THROW((void)SolidSpecimen(world, 0.25e-6), InputError);
}

}  // namespace
}  // namespace kolsky::testing
