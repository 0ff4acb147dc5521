#include "tests/generators/bar_response.hpp"

#include <algorithm>
#include <cmath>

#include "tests/generators/interpolation.hpp"
#include "tests/generators/rod1d.hpp"

namespace kolsky::testing {

namespace {

// What is this much smaller than the largest strain seen no longer matters for any record.
constexpr double kSilence = 1e-10;
constexpr double kSilentFor_s = 150e-6;

struct Grid {
  double length_m;
  int cells;
  std::vector<double> relative_area;
};

Grid lay_out(const BarProblem& problem, double step_s) {
  const double c = std::sqrt(problem.material.glassy_Pa / problem.density_kg_m3);
  const double last_m = *std::ranges::max_element(problem.stations_m);
  // Whatever the cut end returns comes too late to be seen.
  double reach_m = 0.5 * (c * problem.window_s + last_m) + 20.0 * c * step_s;
  double cell_m = c * step_s;
  int bar_cells = 0;
  if (problem.far_end) {
    bar_cells = static_cast<int>(std::lround(problem.far_end->bar_length_m / cell_m));
    cell_m = problem.far_end->bar_length_m / bar_cells;
    const bool joined = problem.far_end->r > 0.0 && problem.far_end->r < 2.0;
    reach_m = joined ? std::max(reach_m, problem.far_end->bar_length_m + 20.0 * cell_m)
                     : problem.far_end->bar_length_m;
  }
  const int cells = std::max(static_cast<int>(std::lround(reach_m / cell_m)), bar_cells);
  Grid grid{cell_m * cells, cells, std::vector<double>(static_cast<std::size_t>(cells), 1.0)};
  if (problem.relative_area) {
    for (int i = 0; i < cells; ++i) {
      grid.relative_area[static_cast<std::size_t>(i)] = problem.relative_area((i + 0.5) * cell_m);
    }
  }
  if (problem.far_end && cells > bar_cells) {
    const double r = problem.far_end->r;
    std::fill(grid.relative_area.begin() + bar_cells, grid.relative_area.end(), r / (2.0 - r));
  }
  return grid;
}

Responses run(const BarProblem& problem, const UnitSource& source, double step_s) {
  const Grid grid = lay_out(problem, step_s);
  Rod rod(problem.material, problem.density_kg_m3, grid.length_m, grid.cells, grid.relative_area);
  const bool rigid = problem.far_end && problem.far_end->r >= 2.0;
  Responses out{rod.step_s(), std::vector<std::vector<double>>(problem.stations_m.size())};
  const auto steps = static_cast<std::size_t>(problem.window_s / rod.step_s()) + 16;
  const auto silent_steps = static_cast<std::size_t>(kSilentFor_s / rod.step_s());
  const double last_m = *std::ranges::max_element(problem.stations_m);
  const double c = rod.length_m() / rod.cells() / rod.step_s();
  const double passed_s = source.duration_s() + last_m / c;
  double largest = 0.0;
  std::size_t silent = 0;
  for (auto& history : out.strain) {
    history.push_back(0.0);
  }
  for (std::size_t n = 1; n < steps && silent < silent_steps; ++n) {
    const double time_s = static_cast<double>(n) * rod.step_s();
    rod.forget_beyond(last_m + c * (problem.window_s - time_s));
    rod.advance();
    rod.close_left(source.at(time_s));
    rod.close_right(rigid ? rod.right().free : 0.0);
    double now = 0.0;
    for (std::size_t g = 0; g < out.strain.size(); ++g) {
      out.strain[g].push_back(rod.strain_at(problem.stations_m[g]));
      now = std::max(now, std::abs(out.strain[g].back()));
    }
    largest = std::max(largest, now);
    const bool over = time_s > passed_s && !problem.far_end && !problem.relative_area;
    silent = over && largest > 0.0 && now < kSilence * largest ? silent + 1 : 0;
  }
  return out;
}

std::vector<double> resampled(const std::vector<double>& history, double from_step, double to_step,
                              std::size_t count) {
  std::vector<double> out(count);
  for (std::size_t n = 0; n < count; ++n) {
    out[n] = sample_at(history, static_cast<double>(n) * to_step / from_step);
  }
  return out;
}

}  // namespace

Responses bar_response(const BarProblem& problem, const UnitSource& source,
                       const BarNumerics& numerics) {
  const auto count = static_cast<std::size_t>(problem.window_s / numerics.output_step_s) + 2;
  const Responses coarse = run(problem, source, numerics.step_s);
  Responses fine = numerics.extrapolate ? run(problem, source, 0.5 * numerics.step_s) : coarse;
  Responses out{numerics.output_step_s, {}};
  for (std::size_t g = 0; g < coarse.strain.size(); ++g) {
    std::vector<double> history =
        resampled(fine.strain[g], fine.step_s, numerics.output_step_s, count);
    if (numerics.extrapolate) {
      const std::vector<double> rough =
          resampled(coarse.strain[g], coarse.step_s, numerics.output_step_s, count);
      for (std::size_t n = 0; n < count; ++n) {
        history[n] += (history[n] - rough[n]) / 3.0;
      }
    }
    out.strain.push_back(std::move(history));
  }
  return out;
}

}  // namespace kolsky::testing
