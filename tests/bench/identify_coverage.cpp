#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "processing/identification/bar_fit.hpp"
#include "tests/bench/held_coverage.hpp"
#include "tests/generators/bar_shots.hpp"
#include "tests/generators/table4.hpp"

namespace {

using namespace kolsky;

struct Wishes {
  int repeats = 2000;
  std::size_t shots = 10;
  unsigned seed = 1;
  double alone_m = 0.0;  ///< 0: four gauges
};

void cover(std::size_t row, const Wishes& wishes, const testing::BarShots::Recording& recording,
           HeldCoverage& held) {
  constexpr double kLength_sd_m = 0.5e-3;
  testing::BarShots::Setup setup;
  if (wishes.alone_m > 0.0) {
    setup.position_m = {wishes.alone_m};
  }
  setup.material = testing::kTable4[row].material;
  setup.poisson_ratio = testing::kTable4[row].poisson_ratio;
  const testing::BarShots shots(setup);
  const int repeats = wishes.repeats;
  const double truth[3] = {setup.material.E1_Pa, setup.material.E2_Pa, setup.material.eta2_Pa_s};
  int inside[3] = {};
  double squares[3] = {};
  double stated[3] = {};
  double deviations[3] = {};
  double bias[3] = {};
  std::mt19937_64 random(row + wishes.seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  for (int repeat = 0; repeat < repeats; ++repeat) {
    std::vector<Shot> drawn = shots.draw(wishes.shots, recording, random);
    if (wishes.alone_m > 0.0) {
      const double filed_m = setup.length_m + kLength_sd_m * normal(random);
      for (Shot& shot : drawn) {
        shot.bench.input.length_m = {filed_m, kLength_sd_m};
      }
    }
    const BarFit fit = fit_bar(drawn, {.theory = WaveTheory::elementary});
    for (std::size_t i = 0; i < 3; ++i) {
      const double error = fit.parameters[i].value - truth[i];
      inside[i] += std::abs(error) < 1.96 * fit.parameters[i].sd ? 1 : 0;
      squares[i] += error * error;
      deviations[i] += error * error / (fit.parameters[i].sd * fit.parameters[i].sd);
      bias[i] += error / fit.parameters[i].sd / repeats;
      stated[i] += fit.parameters[i].sd / repeats;
    }
  }
  std::printf("%s, %d repeats\n", testing::kTable4[row].source, repeats);
  const char* const names[3] = {"E1", "E2", "eta2"};
  for (std::size_t i = 0; i < 3; ++i) {
    std::printf(
        "  %-5s inside 95 %%: %5.2f %%   error rms %.4f %%   stated sd %.4f %%   deviations' mean "
        "%+.3f, "
        "mean square %.3f%s\n",
        names[i], 100.0 * inside[i] / repeats, 100.0 * std::sqrt(squares[i] / repeats) / truth[i],
        100.0 * stated[i] / truth[i], bias[i], deviations[i] / repeats,
        held.judge(100.0 * inside[i] / repeats));
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "How often the truth lies inside the stated 95 % interval of an identification, and how\n"
      "wide the intervals are.");
  Wishes wishes;
  std::size_t only = 0;
  std::string colour = "white";
  testing::BarShots::Recording recording;
  recording.gain_sd = 0.01;
  recording.position_sd_m = 0.2e-3;
  app.add_option("--repeats", wishes.repeats, "identifications")->check(CLI::PositiveNumber);
  app.add_option("--shots", wishes.shots, "of each")->check(CLI::PositiveNumber);
  app.add_option("--seed", wishes.seed, "of the noise and of what is off");
  app.add_option("--alone", wishes.alone_m,
                 "one gauge at this place [m], the bar's length off within a filed 0.5 mm");
  app.add_option("--row", only, "of Table 4; else all")->check(CLI::Range(1, 4));
  app.add_option("--noise", recording.noise_correlation, "from one sample to the next");
  app.add_option("--colour", colour)->check(CLI::IsMember({"white", "coloured", "pink"}));
  std::vector<double> hold;
  HeldCoverage::add_option(app, hold);
  CLI11_PARSE(app, argc, argv);
  HeldCoverage held(hold, wishes.repeats);
  held.state();
  recording.colour = testing::colour_named(colour);
  for (std::size_t row = 0; row < testing::kTable4.size(); ++row) {
    if (only == 0 || only == row + 1) {
      cover(row, wishes, recording, held);
    }
  }
  return held.missed() > 0 ? 1 : 0;
}
