#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "processing/identification/bar_fit.hpp"
#include "processing/identification/bar_spectrum.hpp"
#include "tests/bench/held_coverage.hpp"
#include "tests/generators/solid_bar_shots.hpp"

namespace {

using namespace kolsky;

struct Sums {
  double error = 0.0, square = 0.0, stated = 0.0, deviations = 0.0;
  int inside = 0;
  void add(const FittedNumber& found, double truth) {
    const double off = (found.value - truth) / truth;
    error += off;
    square += off * off;
    stated += found.sd / truth;
    deviations += std::pow((found.value - truth) / found.sd, 2);
    inside += std::abs(found.value - truth) < 1.96 * found.sd ? 1 : 0;
  }
};

void judge(std::size_t row, int repeats, testing::NoiseColour colour, unsigned seed,
           HeldCoverage& held) {
  const testing::SolidBarShots shots(testing::kTable4[row]);
  const testing::SolidBarShots::Tolerances tolerances;
  const auto bound = shots.bound(tolerances, colour);
  std::mt19937_64 random(row + seed);
  Sums exact[3];
  Sums elementary[3];
  Sums paper[3];
  int said_not_to_fit[2] = {};
  for (int repeat = 0; repeat < repeats; ++repeat) {
    BarData data(shots.draw(tolerances, random, colour), 0.0);
    const BarFit fit = fit_bar(data, {.waves = WaveTheory::exact});
    const BarFit plain = fit_bar(data, {.waves = WaveTheory::elementary});
    const auto lines = three_elements_through(straight_line_spectrum(data, plain), 15e3);
    said_not_to_fit[0] += fit.misfit ? 1 : 0;
    said_not_to_fit[1] += plain.misfit ? 1 : 0;
    for (std::size_t i = 0; i < 3; ++i) {
      exact[i].add(fit.parameters[i], shots.truth()[i]);
      elementary[i].add(plain.parameters[i], shots.truth()[i]);
      if (lines.size() == 3) {
        paper[i].add(lines[i], shots.truth()[i]);
      }
    }
  }
  std::printf("%s, %d repeats of ten shots; said not to fit: exact waves %d, elementary %d\n",
              testing::kTable4[row].source, repeats, said_not_to_fit[0], said_not_to_fit[1]);
  const char* const names[3] = {"E1", "E2", "eta2"};
  for (std::size_t i = 0; i < 3; ++i) {
    std::printf(
        "  %-5s inside 95 %%: %3d of %d   error rms %.4f %% (mean %+.4f)   stated %.4f %%   bound "
        "%.4f %%   mean square of deviations %.2f%s\n",
        names[i], exact[i].inside, repeats, 100.0 * std::sqrt(exact[i].square / repeats),
        100.0 * exact[i].error / repeats, 100.0 * exact[i].stated / repeats, 100.0 * bound[i],
        exact[i].deviations / repeats, held.judge(100.0 * exact[i].inside / repeats));
  }
  for (std::size_t i = 0; i < 3; ++i) {
    std::printf(
        "  %-5s elementary waves: bias %+.2f %%, stated %.2f %%, inside 95 %%: %3d of %d; straight "
        "lines: bias %+.2f %%\n",
        names[i], 100.0 * elementary[i].error / repeats, 100.0 * elementary[i].stated / repeats,
        elementary[i].inside, repeats, 100.0 * paper[i].error / repeats);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "What a bar with lateral inertia is found to be made of, beside the bound of Cramer and\n"
      "Rao and what the paper's elementary waves make of the same records.");
  int repeats = 40;
  unsigned seed = 1;
  std::size_t only = 0;
  std::string colour = "white";
  app.add_option("--repeats", repeats, "identifications")->check(CLI::PositiveNumber);
  app.add_option("--seed", seed, "of the noise and of what is off");
  app.add_option("--row", only, "of Table 4; else all")->check(CLI::Range(1, 4));
  app.add_option("--colour", colour)->check(CLI::IsMember({"white", "coloured", "pink"}));
  std::vector<double> hold;
  HeldCoverage::add_option(app, hold);
  CLI11_PARSE(app, argc, argv);
  HeldCoverage held(hold, repeats);
  held.state();
  for (std::size_t row = 0; row < testing::kTable4.size(); ++row) {
    if (only == 0 || only == row + 1) {
      judge(row, repeats, testing::colour_named(colour), seed, held);
    }
  }
  return held.missed() > 0 ? 1 : 0;
}
