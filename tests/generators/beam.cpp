#include "tests/generators/beam.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/generators/spectral.hpp"

namespace kolsky::testing {

namespace {

constexpr std::size_t kPoints = 7;
constexpr std::size_t kOrder = kPoints - 1;
using Line = std::array<double, kPoints>;

struct Field {
  std::vector<double> value, speed, value_store, speed_store, force, mass;
  explicit Field(std::size_t nodes) {
    for (auto* part : {&value, &speed, &value_store, &speed_store, &force, &mass}) {
      part->assign(nodes, 0.0);
    }
  }
  void move(double A, double B, double step_s, std::size_t nodes) {
    for (std::size_t n = 0; n < nodes; ++n) {
      value_store[n] = A * value_store[n] + step_s * speed[n];
      speed_store[n] = A * speed_store[n] + step_s * force[n] / mass[n];
      value[n] += B * value_store[n];
      speed[n] += B * speed_store[n];
    }
  }
};

// Curvature or shear of one element, with its internal variables.
struct Viscous {
  Line strain{}, store{};
};

class Beam {
 public:
  Beam(const BeamProblem& problem, double element_m, std::size_t elements)
      : element_m_(element_m),
        rule_(lobatto(kPoints)),
        chain_(problem.material),
        deflection_(elements * kOrder + 1),
        turn_(elements * kOrder + 1),
        elements_(elements) {
    const double nu = problem.poisson_ratio;
    const double area = std::numbers::pi * problem.radius_m * problem.radius_m;
    const double inertia = 0.25 * area * problem.radius_m * problem.radius_m;
    const double E = chain_.glassy_Pa;
    bending_ = E * inertia;
    shear_ = E / (2.0 * (1.0 + nu)) * area * 6.0 * (1.0 + nu) / (7.0 + 6.0 * nu);
    moment_per_Pa_m_ = area;
    radius_m_ = problem.radius_m;
    of_deflection_ = problem.of_deflection;
    for (std::size_t e = 0; e < elements; ++e) {
      for (std::size_t k = 0; k < kPoints; ++k) {
        const double length = 0.5 * element_m * rule_.weight[k];
        deflection_.mass[e * kOrder + k] += problem.density_kg_m3 * area * length;
        turn_.mass[e * kOrder + k] += problem.density_kg_m3 * inertia * length;
      }
    }
    viscous_.assign(elements, std::vector<std::array<Viscous, 2>>(chain_.elements.size()));
  }

  void advance(double time_s, double step_s, const UnitSource& source, std::size_t active) {
    using RK = LowStorageRungeKutta;
    const std::size_t elements = std::min(active, elements_);
    for (std::size_t stage = 0; stage < RK::kA.size(); ++stage) {
      std::ranges::fill(deflection_.force, 0.0);
      std::ranges::fill(turn_.force, 0.0);
      turn_.force[0] -= moment_per_Pa_m_ * source.at(time_s + RK::kC[stage] * step_s);
      for (std::size_t e = 0; e < elements; ++e) {
        element_forces(e, RK::kA[stage], RK::kB[stage], step_s);
      }
      deflection_.move(RK::kA[stage], RK::kB[stage], step_s, elements * kOrder);
      turn_.move(RK::kA[stage], RK::kB[stage], step_s, elements * kOrder);
    }
  }

  [[nodiscard]] double surface_strain(double x_m) const {
    const auto element = std::min(static_cast<std::size_t>(x_m / element_m_), elements_ - 1);
    const double x = 2.0 * (x_m / element_m_ - static_cast<double>(element)) - 1.0;
    const std::vector<double> slopes = lagrange_slopes(rule_, x);
    const Line turn = of_deflection_ ? deflection_slopes(element) : turns(element);
    double curvature = 0.0;
    for (std::size_t m = 0; m < kPoints; ++m) {
      curvature += slopes[m] * 2.0 / element_m_ * turn[m];
    }
    return radius_m_ * curvature;
  }

 private:
  [[nodiscard]] Line turns(std::size_t element) const {
    Line out{};
    for (std::size_t k = 0; k < kPoints; ++k) {
      out[k] = turn_.value[element * kOrder + k];
    }
    return out;
  }

  [[nodiscard]] Line deflection_slopes(std::size_t element) const {
    Line out{};
    for (std::size_t k = 0; k < kPoints; ++k) {
      for (std::size_t m = 0; m < kPoints; ++m) {
        out[k] +=
            2.0 / element_m_ * rule_.derivative[k][m] * deflection_.value[element * kOrder + m];
      }
    }
    return out;
  }

  void element_forces(std::size_t element, double A, double B, double step_s) {
    const double scale = 2.0 / element_m_;
    const std::size_t first = element * kOrder;
    std::array<Line, 2> sprung{};
    for (std::size_t k = 0; k < kPoints; ++k) {
      sprung[1][k] = -turn_.value[first + k];
      for (std::size_t m = 0; m < kPoints; ++m) {
        sprung[0][k] += scale * rule_.derivative[k][m] * turn_.value[first + m];
        sprung[1][k] += scale * rule_.derivative[k][m] * deflection_.value[first + m];
      }
    }
    flow(element, sprung, A, B, step_s);
    for (std::size_t k = 0; k < kPoints; ++k) {
      const double length = 0.5 * element_m_ * rule_.weight[k];
      const double moment = bending_ * sprung[0][k] * length;
      const double shear = shear_ * sprung[1][k] * length;
      turn_.force[first + k] += shear;
      for (std::size_t m = 0; m < kPoints; ++m) {
        turn_.force[first + m] -= scale * rule_.derivative[k][m] * moment;
        deflection_.force[first + m] -= scale * rule_.derivative[k][m] * shear;
      }
    }
  }

  // Takes the internal variables' strain off and lets them run on.
  void flow(std::size_t element, std::array<Line, 2>& sprung, double A, double B, double step_s) {
    for (const auto& pair : viscous_[element]) {
      for (std::size_t c = 0; c < 2; ++c) {
        for (std::size_t k = 0; k < kPoints; ++k) {
          sprung[c][k] -= pair[c].strain[k];
        }
      }
    }
    for (std::size_t n = 0; n < chain_.elements.size(); ++n) {
      const KelvinElement& element_n = chain_.elements[n];
      for (std::size_t c = 0; c < 2; ++c) {
        Viscous& viscous = viscous_[element][n][c];
        for (std::size_t k = 0; k < kPoints; ++k) {
          const double drive =
              chain_.glassy_Pa * sprung[c][k] - element_n.stiffness_Pa * viscous.strain[k];
          viscous.store[k] = A * viscous.store[k] + step_s / element_n.viscosity_Pa_s * drive;
          viscous.strain[k] += B * viscous.store[k];
        }
      }
    }
  }

  double element_m_;
  SpectralRule rule_;
  KelvinChain chain_;
  Field deflection_, turn_;
  std::size_t elements_;
  double bending_, shear_, moment_per_Pa_m_, radius_m_;
  bool of_deflection_ = false;
  std::vector<std::vector<std::array<Viscous, 2>>> viscous_;
};

}  // namespace

Responses beam_response(const BeamProblem& problem, const UnitSource& source,
                        double output_step_s) {
  const double c = std::sqrt(problem.material.glassy_Pa / problem.density_kg_m3);
  const double last_m = *std::ranges::max_element(problem.stations_m);
  const double element_m = 0.9 * problem.radius_m;
  const auto elements =
      static_cast<std::size_t>((0.5 * (c * problem.window_s + last_m)) / element_m + 6.0);
  // The closest two nodes bound the step; shear against turning adds to it on slender elements.
  const double closest_m = 0.5 * element_m * (lobatto(kPoints).node[1] + 1.0);
  const double divisions = std::ceil(output_step_s * c / (0.8 * closest_m));
  const double step_s = output_step_s / divisions;
  Beam beam(problem, element_m, elements);
  const auto count = static_cast<std::size_t>(problem.window_s / output_step_s) + 2;
  Responses out{output_step_s, std::vector<std::vector<double>>(problem.stations_m.size(), {0.0})};
  for (std::size_t n = 1; n < count; ++n) {
    const double begin_s = static_cast<double>(n - 1) * output_step_s;
    const double reached_m = c * (begin_s + output_step_s);
    const double needed_m = last_m + c * (problem.window_s - begin_s);
    const auto active = static_cast<std::size_t>(std::min(reached_m, needed_m) / element_m) + 4;
    for (int i = 0; i < static_cast<int>(divisions); ++i) {
      beam.advance(begin_s + i * step_s, step_s, source, active);
    }
    for (std::size_t g = 0; g < out.strain.size(); ++g) {
      out.strain[g].push_back(beam.surface_strain(problem.stations_m[g]));
    }
  }
  return out;
}

}  // namespace kolsky::testing
