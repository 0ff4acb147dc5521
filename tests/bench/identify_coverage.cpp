// How often the truth lies inside the stated 95 % interval of a ten-shot identification, and how
// wide the intervals are: identify_coverage [--repeats 2000] [--row 1..4] [--noise correlation]
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

double argument(const std::vector<std::string>& words, const std::string& name, double otherwise) {
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    if (words[i] == name) {
      double value = 0.0;
      const char* end = words[i + 1].data() + words[i + 1].size();
      if (std::from_chars(words[i + 1].data(), end, value).ptr != end) {
        throw std::invalid_argument(name + " needs a number");
      }
      return value;
    }
  }
  return otherwise;
}

void cover(std::size_t row, int repeats, const testing::BarShots::Recording& recording,
           double alone_m) {
  constexpr double kLength_sd_m = 0.5e-3;
  testing::BarShots::Setup setup;
  if (alone_m > 0.0) {
    setup.position_m = {alone_m};
  }
  setup.material = testing::kTable4[row].material;
  setup.poisson_ratio = testing::kTable4[row].poisson_ratio;
  const testing::BarShots shots(setup);
  const double truth[3] = {setup.material.E1_Pa, setup.material.E2_Pa, setup.material.eta2_Pa_s};
  int inside[3] = {};
  double squares[3] = {};
  double stated[3] = {};
  std::mt19937_64 random(row + 1);
  std::normal_distribution<double> normal(0.0, 1.0);
  for (int repeat = 0; repeat < repeats; ++repeat) {
    std::vector<Shot> ten = shots.draw(10, recording, random);
    if (alone_m > 0.0) {
      const double filed_m = setup.length_m + kLength_sd_m * normal(random);
      for (Shot& shot : ten) {
        shot.bench.input.length_m = {filed_m, kLength_sd_m};
      }
    }
    const BarFit fit = fit_bar(ten, {.theory = WaveTheory::elementary});
    for (std::size_t i = 0; i < 3; ++i) {
      const double error = fit.parameters[i].value - truth[i];
      inside[i] += std::abs(error) < 1.96 * fit.parameters[i].sd ? 1 : 0;
      squares[i] += error * error;
      stated[i] += fit.parameters[i].sd / repeats;
    }
  }
  std::printf("%s, %d repeats\n", testing::kTable4[row].source, repeats);
  const char* const names[3] = {"E1", "E2", "eta2"};
  for (std::size_t i = 0; i < 3; ++i) {
    std::printf("  %-5s inside 95 %%: %5.2f %%   error rms %.4f %%   stated sd %.4f %%\n", names[i],
                100.0 * inside[i] / repeats, 100.0 * std::sqrt(squares[i] / repeats) / truth[i],
                100.0 * stated[i] / truth[i]);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::vector<std::string> words(argv + 1, argv + argc);
    const auto repeats = static_cast<int>(argument(words, "--repeats", 2000));
    const auto only = static_cast<std::size_t>(argument(words, "--row", 0));
    testing::BarShots::Recording recording;
    recording.gain_sd = 0.01;
    recording.position_sd_m = 0.2e-3;
    recording.noise_correlation = argument(words, "--noise", 0.0);
    for (std::size_t row = 0; row < testing::kTable4.size(); ++row) {
      if (only == 0 || only == row + 1) {
        cover(row, repeats, recording, argument(words, "--alone", 0.0));
      }
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "identify_coverage: %s\n", error.what());
    return 2;
  }
}
