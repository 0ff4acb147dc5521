#include "processing/impact/element_kernel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "processing/impact/body.hpp"

namespace kolsky::impact {
namespace {

// A cylinder of 3 x 5 elements, 2 mm in radius and 4 mm long.
constexpr double kRadius_m = 2e-3;
constexpr double kLength_m = 4e-3;

Mesh cylinder() {
  return bar_mesh(2.0 * kRadius_m, kLength_m, 3, 5);
}

Solid viscoelastic(double nonlinearity = 0.0) {
  Solid solid;
  solid.density_kg_m3 = 1000.0;
  solid.shear_relaxed_Pa = 20e6;
  solid.bulk_relaxed_Pa = 90e6;
  solid.arms = {{15e6, 40e6, 1e-5}, {5e6, 0.0, 1e-4}};
  solid.nonlinearity = nonlinearity;
  return solid;
}

struct Placed {
  std::vector<double> radial;
  std::vector<double> axial;
};

// Stretches: radial and axial.
Placed stretched(const Mesh& mesh, double radial, double axial) {
  Placed placed;
  for (std::size_t n = 0; n < mesh.R_m.size(); ++n) {
    placed.radial.push_back((radial - 1.0) * mesh.R_m[n]);
    placed.axial.push_back((axial - 1.0) * mesh.Z_m[n]);
  }
  return placed;
}

Placed shaken(const Mesh& mesh, unsigned seed, double size_m) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(-size_m, size_m);
  Placed placed = stretched(mesh, 1.12, 0.8);
  for (std::size_t n = 0; n < mesh.R_m.size(); ++n) {
    placed.radial[n] += mesh.R_m[n] > 0.0 ? any(random) : 0.0;
    placed.axial[n] += any(random);
  }
  return placed;
}

double face_force(const Body& body) {
  double force = 0.0;
  for (const std::size_t node : body.mesh().surface) {
    force += body.force(node).second;
  }
  return force;
}

// Uniaxial strain state with known Hencky strains: the face's force is the axial Kirchhoff stress
// over the axial stretch, on the reference area.
TEST(Element, ForceOfAHomogeneousDeformationIsTheLaws) {
  for (const auto& [b, law] :
       {std::pair{0.0, FiniteStrain::kirchhoff}, std::pair{0.8, FiniteStrain::kirchhoff},
        std::pair{0.8, FiniteStrain::cauchy}}) {
    Solid solid = viscoelastic(b);
    solid.law = law;
    Body body(cylinder(), {solid});
    const double radial = 1.15;
    const double axial = 0.75;
    const Placed placed = stretched(body.mesh(), radial, axial);
    body.place(placed.radial, placed.axial);
    body.set_steps(0.0, 1e-7);  // at once: no arm has yielded
    (void)body.find_forces(false);
    const double dilatation = 2.0 * std::log(radial) + std::log(axial);
    const double deviator = std::log(axial) - dilatation / 3.0;
    const double equivalent = std::abs(deviator);  // of uniaxial form: |e_zz - e_rr| x 2/3
    const double shear_Pa = 40e6;
    const double bulk_Pa = 130e6;
    const double kirchhoff =
        (2.0 * shear_Pa * (1.0 + b * equivalent) * deviator + bulk_Pa * dilatation) *
        (law == FiniteStrain::cauchy ? std::exp(dilatation) : 1.0);
    const double area_m2 = std::numbers::pi * kRadius_m * kRadius_m;
    EXPECT_NEAR(face_force(body), -kirchhoff / axial * area_m2,
                1e-6 * std::abs(kirchhoff) * area_m2);
  }
}

TEST(Element, ArmsRelaxAsTheyShould) {
  Body body(cylinder(), {viscoelastic()});
  // Strain grows at a constant rate for 20 us, then holds.
  const double step_s = 5e-7;
  constexpr int kRamp = 40;
  double stress_Pa = 0.0;
  for (int n = 0; n <= 120; ++n) {
    const double strain = -1e-5 * std::min(1.0, static_cast<double>(n) / kRamp);
    const Placed placed = stretched(body.mesh(), std::exp(-0.5 * strain), std::exp(strain));
    body.place(placed.radial, placed.axial);
    body.set_steps(n == 0 ? 0.0 : step_s, step_s);
    (void)body.find_forces(false);
    stress_Pa = -face_force(body) / (std::numbers::pi * kRadius_m * kRadius_m);
  }
  // 2 G * strain rate, integrated by hand; no change of volume.
  const double ramp_s = kRamp * step_s;
  const double held_s = 80 * step_s;
  double expected = 2.0 * 20e6 * -1e-5;
  for (const auto& [shear_Pa, time_s] : {std::pair{15e6, 1e-5}, std::pair{5e6, 1e-4}}) {
    expected += 2.0 * shear_Pa * -1e-5 * (time_s / ramp_s) * (1.0 - std::exp(-ramp_s / time_s)) *
                std::exp(-held_s / time_s);
  }
  EXPECT_NEAR(stress_Pa, expected, 2e-5 * std::abs(expected));
}

TEST(Element, NothingComesOfAShiftAlongTheAxis) {
  Body body(cylinder(), {viscoelastic()});
  const std::vector<double> none(body.mesh().R_m.size(), 0.0);
  body.place(none, std::vector<double>(none.size(), 0.1));
  body.set_steps(0.0, 1e-7);
  (void)body.find_forces(false);
  for (std::size_t n = 0; n < none.size(); ++n) {
    EXPECT_NEAR(body.force(n).first, 0.0, 1e-6);
    EXPECT_NEAR(body.force(n).second, 0.0, 1e-6);
  }
}

// A strained body's forces are those it has where it was made: what is rounded is how far its nodes
// are apart, not where they are.
TEST(Element, ForceDoesNotChangeWithAShiftAlongTheAxis) {
  const auto force_at = [](double shift_m) {
    Body body(cylinder(), {viscoelastic()});
    Placed placed = shaken(body.mesh(), 3, 1e-6);
    for (double& axial : placed.axial) {
      axial += shift_m;
    }
    body.place(placed.radial, placed.axial);
    body.set_steps(0.0, 1e-7);
    (void)body.find_forces(false);
    return face_force(body);
  };
  const double here = force_at(0.0);
  EXPECT_NEAR(force_at(0.25), here, 1e-6 * std::abs(here));
}

// A slow arm: a step's decay is as near to 1 as single precision goes.
TEST(Element, SlowArmsRelaxAsTheyShould) {
  Solid solid = viscoelastic();
  solid.arms = {{15e6, 40e6, 0.5}};
  Body body(cylinder(), {solid});
  const double step_s = 1e-7;
  const double strain = -0.01;
  const Placed placed = stretched(body.mesh(), std::exp(-0.5 * strain), std::exp(strain));
  body.place(placed.radial, placed.axial);
  body.set_steps(0.0, step_s);
  (void)body.find_forces(false);
  const double at_once = face_force(body);
  constexpr int kSteps = 4000;
  for (int n = 0; n < kSteps; ++n) {
    body.set_steps(step_s, step_s);
    (void)body.find_forces(false);
  }
  const double relaxed = 15.0 / 35.0 * (1.0 - std::exp(-kSteps * step_s / 0.5));
  EXPECT_NEAR((at_once - face_force(body)) / at_once, relaxed, 0.01 * relaxed + 2e-7);
}

// Forces are the slope of the stored energy: stress and strain conjugate, volume averaging
// included.
TEST(Element, ForcesAreTheSlopeOfTheStoredEnergy) {
  for (const double b : {0.0, 0.6}) {
    Solid solid = viscoelastic(b);
    solid.arms.clear();
    Body body(cylinder(), {solid});
    const Placed placed = shaken(body.mesh(), 7, 1.2e-4);
    const auto energy_at = [&](std::size_t node, double radial_m, double axial_m) {
      Placed moved = placed;
      moved.radial[node] += radial_m;
      moved.axial[node] += axial_m;
      body.place(moved.radial, moved.axial);
      return body.find_forces(true).stored_J;
    };
    const Block& block = body.mesh().blocks.front();
    // Long steps, since the energy is a sum of single precision; so to the sixth order.
    const double step_m = 3e-5;
    const auto slope = [&](std::size_t node, double radial, double axial) {
      double sum = 0.0;
      for (const auto& [steps, weight] :
           {std::pair{1.0, 45.0}, std::pair{2.0, -9.0}, std::pair{3.0, 1.0}}) {
        const double by_m = steps * step_m;
        sum += weight * (energy_at(node, radial * by_m, axial * by_m) -
                         energy_at(node, -radial * by_m, -axial * by_m));
      }
      return sum / (60.0 * step_m);
    };
    for (const std::size_t node : {block.node(1, 2), block.node(3, 0), block.node(2, 5)}) {
      const double by_r = slope(node, 1.0, 0.0);
      const double by_z = slope(node, 0.0, 1.0);
      (void)energy_at(node, 0.0, 0.0);
      EXPECT_NEAR(body.force(node).first, -by_r, 2e-5 * std::abs(by_r) + 1e-3);
      EXPECT_NEAR(body.force(node).second, -by_z, 2e-5 * std::abs(by_z) + 1e-3);
    }
  }
}

TEST(Element, EveryKernelGivesTheSame) {
  std::size_t count = 0;
  const ElementKernel* const* const kernels = runnable_kernels(count);
  ASSERT_GE(count, 1U);
  for (const double b : {0.0, -0.4}) {
    std::vector<std::vector<double>> forces(count);
    std::vector<ElementSums> sums(count);
    for (std::size_t k = 0; k < count; ++k) {
      Body body(cylinder(), {viscoelastic(b)}, *kernels[k]);
      for (unsigned n = 0; n < 3; ++n) {
        const Placed placed = shaken(body.mesh(), n, 1e-4);
        body.place(placed.radial, placed.axial);
        body.set_steps(n == 0 ? 0.0 : 1e-6, 1e-6);
        sums[k] = body.find_forces(true);
      }
      for (std::size_t n = 0; n < body.mesh().R_m.size(); ++n) {
        forces[k].push_back(body.force(n).first);
        forces[k].push_back(body.force(n).second);
      }
    }
    double largest = 0.0;
    for (const double force : forces[0]) {
      largest = std::max(largest, std::abs(force));
    }
    for (std::size_t k = 1; k < count; ++k) {
      for (std::size_t i = 0; i < forces[0].size(); ++i) {
        EXPECT_NEAR(forces[k][i], forces[0][i], 1e-6 * largest) << kernels[k]->name;
      }
      EXPECT_NEAR(sums[k].stored_J, sums[0].stored_J, 1e-6 * sums[0].stored_J);
      EXPECT_NEAR(sums[k].dissipated_W, sums[0].dissipated_W, 1e-6 * sums[0].dissipated_W);
      EXPECT_NEAR(sums[k].least_area_ratio, sums[0].least_area_ratio, 1e-6);
    }
  }
}

TEST(Element, AnInvertedOneShowsInTheSums) {
  Body body(cylinder(), {viscoelastic()});
  Placed placed = stretched(body.mesh(), 1.0, 1.0);
  const Block& block = body.mesh().blocks.front();
  placed.axial[block.node(1, 2)] += 3e-3;
  body.place(placed.radial, placed.axial);
  EXPECT_LE(body.find_forces(false).least_area_ratio, 0.0);
  const ElementIndex worst = body.most_squeezed();
  EXPECT_TRUE(worst.row == 1 || worst.row == 2);
  EXPECT_LE(worst.column, 1U);
  EXPECT_NE(body.describe(worst).find("R "), std::string::npos);
}

TEST(Element, AxialStressIsTheLaws) {
  Body body(cylinder(), {viscoelastic(0.5)});
  const double radial = 1.1;
  const double axial = 0.8;
  const Placed placed = stretched(body.mesh(), radial, axial);
  body.place(placed.radial, placed.axial);
  body.set_steps(0.0, 1e-7);
  (void)body.find_forces(false);
  const double dilatation = 2.0 * std::log(radial) + std::log(axial);
  const double deviator = std::log(axial) - dilatation / 3.0;
  const double kirchhoff =
      2.0 * 40e6 * (1.0 + 0.5 * std::abs(deviator)) * deviator + 130e6 * dilatation;
  EXPECT_NEAR(body.axial_stress_Pa({0, 1, 2}), kirchhoff / std::exp(dilatation),
              3e-7 * std::abs(kirchhoff));
  EXPECT_NEAR(body.axial_log_stretch({0, 1, 2}), std::log(axial), 1e-12);
}

// What the velocities have grown to after a thousand steps from noise.
double growth(double share_of_critical) {
  Body body(cylinder(), {elastic_solid(1000.0, 50e6, 0.3)});
  const double step_s = share_of_critical * 2.0 / body.highest_frequency();
  std::vector<double> radial(body.mesh().R_m.size(), 0.0);
  std::vector<double> axial(body.mesh().R_m.size(), 0.0);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1e-6, 1e-6);
  for (std::size_t n = 0; n < radial.size(); ++n) {
    const bool there = body.nodal_mass_kg(n) > 0.0;
    radial[n] = there && body.mesh().R_m[n] > 0.0 ? any(random) : 0.0;
    axial[n] = there ? any(random) : 0.0;
  }
  body.set_velocity(radial, axial);
  for (int n = 0; n < 1000; ++n) {
    (void)body.find_forces(false);
    body.advance(step_s, step_s);
  }
  double largest = 0.0;
  for (std::size_t n = 0; n < radial.size(); ++n) {
    largest = std::max(largest, std::abs(body.axial_velocity(n)));
  }
  return largest / 1e-6;
}

TEST(Body, CriticalStepIsTheEdgeOfStability) {
  EXPECT_LT(growth(0.99), 100.0);
  const double beyond = growth(1.02);
  EXPECT_FALSE(beyond < 1e4);  // huge, or not a number any more
}

}  // namespace
}  // namespace kolsky::impact
