#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "processing/identification/bar_fit.hpp"
#include "tests/generators/bar_shots.hpp"
using namespace kolsky;
int main(int argc, char** argv) {
  const int repeats = argc > 1 ? std::atoi(argv[1]) : 3;
  const double gain_sd = argc > 2 ? std::atof(argv[2]) : 0.0;
  const double pos_sd = argc > 3 ? std::atof(argv[3]) : 0.0;
  const double corr = argc > 4 ? std::atof(argv[4]) : 0.0;
  const std::size_t count = argc > 5 ? std::atoi(argv[5]) : 10;
  testing::BarShots::Setup setup;
  setup.material = {1180, 5.66e9, 37e9, 1.81e6};
  const testing::BarShots gen(setup);
  std::mt19937_64 random(7);
  const double truth[3] = {5.66e9, 37e9, 1.81e6};
  double inside[3] = {}, z2[3] = {}, zm[3] = {}, sd[3] = {}, chi = 0, ms = 0;
  for (int r = 0; r < repeats; ++r) {
    const auto shots = gen.draw(count, {.noise_correlation = corr, .gain_sd = gain_sd, .position_sd_m = pos_sd}, random);
    const auto t0 = std::chrono::steady_clock::now();
    const BarFit fit = fit_bar(shots, {.theory = WaveTheory::elementary});
    ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - t0).count();
    chi += fit.chi2_reduced;
    for (int i = 0; i < 3; ++i) {
      const double z = (fit.parameters[i].value - truth[i]) / fit.parameters[i].sd;
      inside[i] += std::abs(z) < 1.96;
      z2[i] += z * z; zm[i] += z;
      sd[i] += fit.parameters[i].sd / truth[i];
    }
    if (r == 0) std::printf("band %g dof %zu\n", fit.band_limit_Hz, fit.degrees_of_freedom);
  }
  std::printf("ms %.2f chi2 %.4f\n", ms / repeats, chi / repeats);
  for (int i = 0; i < 3; ++i)
    std::printf("cover %.4f mean z %.3f rms z %.3f sd %.5f %%\n", inside[i] / repeats, zm[i]/repeats, std::sqrt(z2[i] / repeats), 100 * sd[i] / repeats);
}
