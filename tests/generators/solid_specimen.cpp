#include "tests/generators/solid_specimen.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "processing/base/error.hpp"

namespace kolsky::testing {

namespace {

constexpr std::array<double, 2> kGauss{0.21132486540518712, 0.78867513459481288};

double longitudinal_speed(const TrueSpecimen& specimen) {
  const double nu = specimen.poisson_ratio;
  const double modulus =
      specimen.E1_Pa * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));  // of laterally held waves
  return std::sqrt(modulus / specimen.density_kg_m3);
}

/// As many cells as asked for, or as few as the bars' step allows.
std::size_t cells_within(std::size_t asked, double size_m, double shortest_m) {
  const auto most = static_cast<std::size_t>(std::max(1.0, std::floor(size_m / shortest_m)));
  return std::min(asked, most);
}

}  // namespace

SolidSpecimen::SolidSpecimen(const ShpbWorld& world, double step_s, Cells cells)
    : chain_(world.specimen.chain(), step_s),
      poisson_ratio_(world.specimen.poisson_ratio),
      friction_(world.specimen.friction),
      length_m_(world.specimen.length_m),
      density_kg_m3_(world.specimen.density_kg_m3),
      bar_area_m2_(std::numbers::pi * world.base.radius_m * world.base.radius_m),
      step_s_(step_s) {
  constexpr double kStable = 2.0;  // cells' sizes over what a wave travels in a step, at least
  const double shortest_m = kStable * longitudinal_speed(world.specimen) * step_s;
  const double radius_m = 0.5 * world.specimen.diameter_m;
  cells_ = {cells_within(cells.across, radius_m, shortest_m),
            cells_within(cells.along, length_m_, shortest_m)};
  constexpr std::size_t kFewest = 3;
  if (std::min(cells_.across, cells_.along) < kFewest) {
    throw InputError("solid specimen", "is crossed by a wave in a few steps",
                     "give a longer one, a softer one or a shorter step");
  }
  cell_r_m_ = radius_m / static_cast<double>(cells_.across);
  cell_z_m_ = length_m_ / static_cast<double>(cells_.along);
  for (const KelvinStep::Element& element : chain_.elements()) {
    fresh_ += element.from_new;
  }
  for (std::size_t i = 0; i < cells_.across; ++i) {
    lay_points(i);
  }
  memory_.assign(cells_.across * cells_.along * kCorners,
                 Memory{std::vector<Tensor>(chain_.elements().size(), Tensor{}), {}});
  const std::size_t nodes = (cells_.across + 1) * (cells_.along + 1);
  for (Motion* motion : {&radial_, &axial_}) {
    *motion = {std::vector<double>(nodes), std::vector<double>(nodes), std::vector<double>(nodes),
               std::vector<double>(nodes)};
  }
  weigh();
}

std::size_t SolidSpecimen::node(std::size_t across, std::size_t along) const {
  return along * (cells_.across + 1) + across;
}

// Corners in the order (0,0), (1,0), (0,1), (1,1) of (r, z).
void SolidSpecimen::lay_points(std::size_t column) {
  std::array<Point, kCorners> points;
  for (std::size_t q = 0; q < kCorners; ++q) {
    const double x = kGauss.at(q % 2);
    const double y = kGauss.at(q / 2);
    const double r = (static_cast<double>(column) + x) * cell_r_m_;
    Point& point = points.at(q);
    point.weight = 0.25 * cell_r_m_ * cell_z_m_ * 2.0 * std::numbers::pi * r;
    for (std::size_t c = 0; c < kCorners; ++c) {
      const double in_r = c % 2 == 1 ? x : 1.0 - x;
      const double in_z = c / 2 == 1 ? y : 1.0 - y;
      point.along_r.at(c) = (c % 2 == 1 ? 1.0 : -1.0) / cell_r_m_ * in_z;
      point.along_z.at(c) = (c / 2 == 1 ? 1.0 : -1.0) / cell_z_m_ * in_r;
      point.hoop.at(c) = in_r * in_z / r;
    }
  }
  points_.push_back(points);
}

void SolidSpecimen::weigh() {
  mass_.assign(radial_.moved.size(), 0.0);
  for (std::size_t j = 0; j < cells_.along; ++j) {
    for (std::size_t i = 0; i < cells_.across; ++i) {
      for (const Point& point : points_[i]) {
        for (std::size_t c = 0; c < kCorners; ++c) {
          // hoop holds the shape over r.
          const double r = 1.0 / (point.hoop[0] + point.hoop[1] + point.hoop[2] + point.hoop[3]);
          mass_[node(i + c % 2, j + c / 2)] += density_kg_m3_ * point.weight * point.hoop.at(c) * r;
        }
      }
    }
  }
}

SolidSpecimen::Tensor SolidSpecimen::stress_of(Memory& memory, const Tensor& strain) const {
  Tensor unit{};
  for (std::size_t t = 0; t < unit.size(); ++t) {
    double sprung = strain.at(t);
    for (std::size_t k = 0; k < memory.viscous.size(); ++k) {
      const KelvinStep::Element& element = chain_.elements()[k];
      double& viscous = memory.viscous[k].at(t);
      viscous = element.keep * viscous + element.from_old * memory.stress.at(t);
      sprung -= viscous;
    }
    unit.at(t) = chain_.glassy_Pa() * sprung / (1.0 + chain_.glassy_Pa() * fresh_);
    for (std::size_t k = 0; k < memory.viscous.size(); ++k) {
      memory.viscous[k].at(t) += chain_.elements()[k].from_new * unit.at(t);
    }
  }
  memory.stress = unit;
  const double nu = poisson_ratio_;
  const double pressed = nu / ((1.0 + nu) * (1.0 - 2.0 * nu)) * (unit[0] + unit[1] + unit[2]);
  const double sheared = 1.0 / (1.0 + nu);
  return {pressed + sheared * unit[0], pressed + sheared * unit[1], pressed + sheared * unit[2],
          0.5 * sheared * unit[3]};
}

void SolidSpecimen::add_cell(std::size_t across, std::size_t along) {
  std::array<std::size_t, kCorners> corner{};
  for (std::size_t c = 0; c < kCorners; ++c) {
    corner.at(c) = node(across + c % 2, along + c / 2);
  }
  for (std::size_t q = 0; q < kCorners; ++q) {
    const Point& point = points_[across].at(q);
    Tensor strain{};
    for (std::size_t c = 0; c < kCorners; ++c) {
      const double r = radial_.moved[corner.at(c)];
      const double z = axial_.moved[corner.at(c)];
      strain[0] += point.along_r.at(c) * r;
      strain[1] += point.along_z.at(c) * z;
      strain[2] += point.hoop.at(c) * r;
      strain[3] += point.along_z.at(c) * r + point.along_r.at(c) * z;
    }
    const std::size_t at = ((along * cells_.across) + across) * kCorners + q;
    const Tensor stress = stress_of(memory_[at], strain);
    for (std::size_t c = 0; c < kCorners; ++c) {
      radial_.force[corner.at(c)] +=
          point.weight * (point.along_r.at(c) * stress[0] + point.hoop.at(c) * stress[2] +
                          point.along_z.at(c) * stress[3]);
      axial_.force[corner.at(c)] +=
          point.weight * (point.along_z.at(c) * stress[1] + point.along_r.at(c) * stress[3]);
    }
  }
}

/// What the material resists the nodes' motion with.
void SolidSpecimen::gather_forces() {
  for (Motion* motion : {&radial_, &axial_}) {
    for (std::size_t n = 0; n < mass_.size(); ++n) {
      motion->moved[n] +=
          step_s_ * motion->velocity[n] + 0.5 * step_s_ * step_s_ * motion->acceleration[n];
    }
    std::ranges::fill(motion->force, 0.0);
  }
  for (std::size_t j = 0; j < cells_.along; ++j) {
    for (std::size_t i = 0; i < cells_.across; ++i) {
      add_cell(i, j);
    }
  }
}

void SolidSpecimen::move_inside() {
  const auto free_motion = [&](Motion& motion, std::size_t n) {
    const double acceleration = -motion.force[n] / mass_[n];
    motion.velocity[n] += 0.5 * step_s_ * (motion.acceleration[n] + acceleration);
    motion.acceleration[n] = acceleration;
  };
  for (std::size_t j = 0; j <= cells_.along; ++j) {
    const bool face = j == 0 || j == cells_.along;
    for (std::size_t i = 0; i <= cells_.across; ++i) {
      if (!face) {
        free_motion(axial_, node(i, j));
      }
      if (!face && i > 0) {  // the axis stays where it is
        free_motion(radial_, node(i, j));
      }
    }
  }
}

void SolidSpecimen::slide(std::size_t n, double pressing_N) {
  const double most_N = friction_ * std::max(0.0, pressing_N);
  const double freely = -radial_.force[n] / mass_[n];
  const double velocity = radial_.velocity[n] + 0.5 * step_s_ * (radial_.acceleration[n] + freely);
  if (std::abs(velocity) * 2.0 * mass_[n] / step_s_ <= most_N) {
    radial_.velocity[n] = radial_.acceleration[n] = 0.0;
    return;
  }
  const double held = std::copysign(most_N / mass_[n], velocity);
  radial_.velocity[n] = velocity - 0.5 * step_s_ * held;
  radial_.acceleration[n] = freely - held;
}

double SolidSpecimen::move_face(std::size_t along, const Rod::EndRelation& bar, double sense) {
  double mass = 0.0;
  double resisting = 0.0;
  for (std::size_t i = 0; i <= cells_.across; ++i) {
    mass += mass_[node(i, along)];
    resisting += axial_.force[node(i, along)];
  }
  const std::size_t first = node(0, along);
  const double pushed = (sense * bar_area_m2_ * bar.free - resisting) / mass;
  const double velocity =
      (axial_.velocity[first] + 0.5 * step_s_ * (axial_.acceleration[first] + pushed)) /
      (1.0 + 0.5 * step_s_ * bar_area_m2_ * bar.slope / mass);
  const double stress = bar.free - sense * bar.slope * velocity;
  const double acceleration = (sense * bar_area_m2_ * stress - resisting) / mass;
  for (std::size_t i = 0; i <= cells_.across; ++i) {
    const std::size_t n = node(i, along);
    axial_.velocity[n] = velocity;
    axial_.acceleration[n] = acceleration;
    if (i > 0) {
      slide(n, sense * (mass_[n] * acceleration + axial_.force[n]));
    }
  }
  return stress;
}

void SolidSpecimen::close(Rod& input, Rod& output) {
  gather_forces();
  move_inside();
  const double front = move_face(0, input.right(), 1.0);
  const double back = move_face(cells_.along, output.left(), -1.0);
  input.close_right(front);
  output.close_left(back);
  force_N_ = back * bar_area_m2_;
  strain_ = (axial_.moved[node(0, 0)] - axial_.moved[node(0, cells_.along)]) / length_m_;
}

}  // namespace kolsky::testing
