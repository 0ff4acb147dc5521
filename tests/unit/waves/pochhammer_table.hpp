#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "processing/waves/pochhammer_chree.hpp"

namespace kolsky::testing {

/// A row of `reference/pochhammer_chree.csv`, in units of the bar's radius a and its speed c0.
struct PochhammerRow {
  double a_over_wavelength, frequency, speed;  ///< f a / c0, cp / c0
  double mean_over_surface;                    ///< of axial strain
  double stress_over_strain;                   ///< means over the section, over E
};

/// The table of reference values, by Poisson's ratio; empty where it is not beside the project.
inline std::map<double, std::vector<PochhammerRow>> pochhammer_table() {
  std::map<double, std::vector<PochhammerRow>> table;
  std::ifstream file(std::filesystem::path(KOLSKY_SHARED_DATA).parent_path() /
                     "reference/pochhammer_chree.csv");
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    double nu = 0.0;
    PochhammerRow row{};
    char comma = 0;
    cells >> nu >> comma >> row.a_over_wavelength >> comma >> row.frequency >> comma >> row.speed >>
        comma >> row.mean_over_surface >> comma >> row.stress_over_strain;
    table[nu].push_back(row);
  }
  return table;
}

/// Modes of an elastic bar with c0 = 1 and a = 1 at a table's rows, reached in small steps.
inline std::vector<BarMode> modes_at(double nu, const std::vector<PochhammerRow>& rows) {
  const ElasticSolid unit(1.0);
  const PochhammerChree bar(1.0, nu, 1.0, unit);
  constexpr int kSteps = 20;
  std::vector<Complex> path;
  double from = 0.0;
  for (const PochhammerRow& row : rows) {
    // The table's frequency has five or six digits; its wavelength is exact and its speed has
    // seven.
    const double to = row.speed * row.a_over_wavelength;
    for (int step = 1; step <= kSteps; ++step) {
      path.emplace_back(0.0, 2.0 * std::numbers::pi * (from + (to - from) * step / kSteps));
    }
    from = to;
  }
  const auto all = bar.along(path);
  std::vector<BarMode> modes;
  for (std::size_t i = kSteps - 1; i < all.size(); i += kSteps) {
    modes.push_back(all[i]);
  }
  return modes;
}

}  // namespace kolsky::testing
