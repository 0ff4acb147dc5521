#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "processing/waves/bar_modes.hpp"
#include "processing/waves/pochhammer_chree.hpp"
#include "tests/accuracy/table.hpp"
#include "tests/unit/waves/pochhammer_table.hpp"

namespace kolsky::accuracy {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

struct Checked {
  WaveTheory theory;
  const char* name;
  double frequency_Hz, alpha_per_m, speed_m_per_s;
};

}  // namespace

std::optional<Section> elastic_waves() {
  const auto table = testing::pochhammer_table();
  if (table.empty()) {
    return std::nullopt;
  }
  Section section{
      "Elastic bars: Pochhammer and Chree, first mode",
      "Against `reference/pochhammer_chree.csv`: largest difference over each Poisson's "
      "ratio's rows. The table gives the speed to seven digits.",
      {"ν", "rows", "up to a/Λ", "cp/c0 off by", "surface over mean strain off by"},
      {}};
  for (const auto& [nu, rows] : table) {
    const auto modes = testing::modes_at(nu, rows);
    double speed = 0.0;
    double ratio = 0.0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double omega = kTwoPi * rows[i].speed * rows[i].a_over_wavelength;
      speed = std::max(speed, std::abs(omega / modes[i].gamma.imag() - rows[i].speed));
      ratio = std::max(ratio, std::abs(1.0 / modes[i].mean_over_surface.real() -
                                       1.0 / rows[i].mean_over_surface));
    }
    section.rows.push_back({digits(nu, 4), std::to_string(rows.size()),
                            digits(rows.back().a_over_wavelength, 3), digits(speed, 2),
                            digits(ratio, 2)});
  }
  return section;
}

std::optional<Section> viscoelastic_waves() {
  constexpr WaveTheory kElementary = WaveTheory::elementary;
  const std::vector<Checked> list{{kElementary, "elementary", 10e3, 0.64074, 2173.72},
                                  {kElementary, "elementary", 20e3, 0.69408, 2185.65},
                                  {kElementary, "elementary", 40e3, 0.70884, 2188.97},
                                  {WaveTheory::love, "Love", 10e3, 0.64598, 2167.84},
                                  {WaveTheory::love, "Love", 20e3, 0.71700, 2162.13},
                                  {WaveTheory::love, "Love", 40e3, 0.81044, 2093.41},
                                  {WaveTheory::exact, "exact", 10e3, 0.64610, 2167.76},
                                  {WaveTheory::exact, "exact", 20e3, 0.71924, 2160.79},
                                  {WaveTheory::exact, "exact", 40e3, 0.86723, 2066.61}};
  Section section{
      "Viscoelastic bars",
      "PMMA of Table 4, row 1, 20 mm in diameter: values checked in high precision "
      "outside the project (`physics.md`), as many digits as it gives.",
      {"waves", "kHz", "α reference", "α ours [1/m]", "c reference", "c ours [m/s]", "digits of c"},
      {}};
  Bar bar;
  bar.diameter_m = {0.020};
  bar.density_kg_m3 = {1180.0};
  bar.poisson_ratio = {0.36};
  const ThreeElementSolid pmma(paper_pmma());
  std::vector<Complex> path;
  for (int step = 1; step <= 800; ++step) {
    path.emplace_back(0.0, kTwoPi * 50.0 * step);
  }
  for (const Checked& row : list) {
    const auto modes = bar_modes(row.theory, bar, pmma, path);
    const Complex gamma = modes[static_cast<std::size_t>(row.frequency_Hz / 50.0) - 1].gamma;
    const double speed = kTwoPi * row.frequency_Hz / gamma.imag();
    section.rows.push_back(
        {row.name, digits(1e-3 * row.frequency_Hz, 3), fmt::format("{:.5f}", row.alpha_per_m),
         fmt::format("{:.5f}", gamma.real()), fmt::format("{:.2f}", row.speed_m_per_s),
         fmt::format("{:.2f}", speed), agreed(row.speed_m_per_s, speed)});
  }
  return section;
}

}  // namespace kolsky::accuracy
