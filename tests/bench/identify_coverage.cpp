// How often the truth lies inside the stated 95 % interval of a ten-shot identification, and how
// wide the intervals are: identify_coverage [--repeats 2000] [--row 1..4] [--shots 10]
// [--colour white|coloured|pink] [--noise correlation] [--seed 1]
// [--alone metres]: of one gauge at that place, the bar's length off within a filed 0.5 mm.
#include <charconv>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "processing/identification/bar_fit.hpp"
#include "tests/generators/bar_shots.hpp"
#include "tests/generators/table4.hpp"

namespace {

using namespace kolsky;

std::string word(const std::vector<std::string>& words, const std::string& name,
                 const std::string& otherwise) {
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    if (words[i] == name) {
      return words[i + 1];
    }
  }
  return otherwise;
}

double argument(const std::vector<std::string>& words, const std::string& name, double otherwise) {
  const std::string text = word(words, name, "");
  if (text.empty()) {
    return otherwise;
  }
  double value = 0.0;
  const char* end = text.data() + text.size();
  if (std::from_chars(text.data(), end, value).ptr != end) {
    throw std::invalid_argument(name + " needs a number");
  }
  return value;
}

struct Wishes {
  int repeats = 2000;
  std::size_t shots = 10;
  unsigned seed = 1;
  double alone_m = 0.0;  ///< 0: four gauges
};

void cover(std::size_t row, const Wishes& wishes, const testing::BarShots::Recording& recording) {
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
      stated[i] += fit.parameters[i].sd / repeats;
    }
  }
  std::printf("%s, %d repeats\n", testing::kTable4[row].source, repeats);
  const char* const names[3] = {"E1", "E2", "eta2"};
  for (std::size_t i = 0; i < 3; ++i) {
    std::printf(
        "  %-5s inside 95 %%: %5.2f %%   error rms %.4f %%   stated sd %.4f %%   mean square of "
        "deviations %.3f\n",
        names[i], 100.0 * inside[i] / repeats, 100.0 * std::sqrt(squares[i] / repeats) / truth[i],
        100.0 * stated[i] / truth[i], deviations[i] / repeats);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::vector<std::string> words(argv + 1, argv + argc);
    Wishes wishes;
    wishes.repeats = static_cast<int>(argument(words, "--repeats", 2000));
    wishes.shots = static_cast<std::size_t>(argument(words, "--shots", 10));
    wishes.seed = static_cast<unsigned>(argument(words, "--seed", 1));
    wishes.alone_m = argument(words, "--alone", 0.0);
    const auto only = static_cast<std::size_t>(argument(words, "--row", 0));
    testing::BarShots::Recording recording;
    recording.gain_sd = 0.01;
    recording.position_sd_m = 0.2e-3;
    recording.noise_correlation = argument(words, "--noise", 0.0);
    recording.colour = testing::colour_named(word(words, "--colour", "white"));
    for (std::size_t row = 0; row < testing::kTable4.size(); ++row) {
      if (only == 0 || only == row + 1) {
        cover(row, wishes, recording);
      }
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "identify_coverage: %s\n", error.what());
    return 2;
  }
}
