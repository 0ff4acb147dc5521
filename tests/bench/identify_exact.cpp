// What a bar with lateral inertia is found to be made of, beside the bound of Cramer and Rao and
// what the paper's elementary waves make of the same records: identify_exact [--repeats 40]
// [--row 1..4]
#include <charconv>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "processing/identification/bar_fit.hpp"
#include "processing/identification/bar_spectrum.hpp"
#include "tests/generators/solid_bar_shots.hpp"

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

struct Sums {
  double error = 0.0, square = 0.0, stated = 0.0;
  int inside = 0;
  void add(const FittedNumber& found, double truth) {
    const double off = (found.value - truth) / truth;
    error += off;
    square += off * off;
    stated += found.sd / truth;
    inside += std::abs(found.value - truth) < 1.96 * found.sd ? 1 : 0;
  }
};

void judge(std::size_t row, int repeats) {
  const testing::SolidBarShots shots(testing::kTable4[row]);
  const testing::SolidBarShots::Tolerances tolerances;
  const auto bound = shots.bound(tolerances);
  std::mt19937_64 random(row + 1);
  Sums exact[3];
  Sums elementary[3];
  Sums paper[3];
  for (int repeat = 0; repeat < repeats; ++repeat) {
    BarData data(shots.draw(tolerances, random), 0.0);
    const BarFit fit = fit_bar(data, {.waves = WaveTheory::exact});
    const BarFit plain = fit_bar(data, {.waves = WaveTheory::elementary});
    const auto lines = three_elements_through(straight_line_spectrum(data, plain), 15e3);
    for (std::size_t i = 0; i < 3; ++i) {
      exact[i].add(fit.parameters[i], shots.truth()[i]);
      elementary[i].add(plain.parameters[i], shots.truth()[i]);
      if (lines.size() == 3) {
        paper[i].add(lines[i], shots.truth()[i]);
      }
    }
  }
  std::printf("%s, %d repeats of ten shots\n", testing::kTable4[row].source, repeats);
  const char* const names[3] = {"E1", "E2", "eta2"};
  for (std::size_t i = 0; i < 3; ++i) {
    std::printf(
        "  %-5s inside 95 %%: %3d of %d   error rms %.4f %% (mean %+.4f)   stated %.4f %%   bound "
        "%.4f %%   elementary waves, bias: ML %+.2f %%, straight lines %+.2f %%\n",
        names[i], exact[i].inside, repeats, 100.0 * std::sqrt(exact[i].square / repeats),
        100.0 * exact[i].error / repeats, 100.0 * exact[i].stated / repeats, 100.0 * bound[i],
        100.0 * elementary[i].error / repeats, 100.0 * paper[i].error / repeats);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::vector<std::string> words(argv + 1, argv + argc);
    const auto repeats = static_cast<int>(argument(words, "--repeats", 40));
    const auto only = static_cast<std::size_t>(argument(words, "--row", 0));
    for (std::size_t row = 0; row < testing::kTable4.size(); ++row) {
      if (only == 0 || only == row + 1) {
        judge(row, repeats);
      }
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "identify_exact: %s\n", error.what());
    return 2;
  }
}
