// How often the stated 95 % intervals of a specimen's parameters hold the truth, over many repeats
// of one experiment.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/bench/held_coverage.hpp"
#include "tests/generators/specimen_repeats.hpp"
#include "tests/generators/spectrum_coverage.hpp"

namespace {

using namespace kolsky;

constexpr double kCovered = 1.959964;

testing::LinearShpb model_of(const std::string& name) {
  testing::LinearShpb model;
  if (name == "cover") {
    model.specimen = {960.0, 987e6, 452e6, 6020.0};
  }
  if (name == "elastic") {
    model.input = {4430.0, 113e9, 0.0, 0.0};
    model.output = model.input;
    model.input_length_m = model.output_length_m = 1.2;
    model.gauge_in_m = 0.6;
    model.gauge_out_m = 0.3;
  }
  return model;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("How often the truth lies inside the stated 95 % interval of a specimen's numbers.");
  unsigned repeats = 2000;
  std::string name = "core";
  std::size_t shots = 10;
  double noise_microstrain = 4.0;
  bool exact_bench = false;
  std::vector<double> hold;
  app.add_option("repeats", repeats)->check(CLI::PositiveNumber);
  app.add_option("specimen", name)->check(CLI::IsMember({"core", "cover", "elastic"}));
  app.add_option("--shots", shots, "of each")->check(CLI::PositiveNumber);
  app.add_option("--noise", noise_microstrain, "rms")->check(CLI::PositiveNumber);
  app.add_flag("--exact-bench", exact_bench, "nothing of bench and bars is off");
  HeldCoverage::add_option(app, hold);
  CLI11_PARSE(app, argc, argv);
  const double noise = 1e-6 * noise_microstrain;
  HeldCoverage held(hold, repeats);
  held.state();
  testing::SpecimenRepeats::Filed filed;
  if (exact_bench) {
    filed = {0.0, 0.0, 0.0, {0.0, 0.0, 0.0}};
  }
  const testing::LinearShpb model = model_of(name);
  const testing::SpecimenRepeats experiment(model, filed, shots, noise);
  testing::SpectrumCoverage spectrum;
  SpecimenFitOptions options;
  options.bars = WaveTheory::elementary;
  options.specimen = SpecimenWaves::massless;
  std::array<double, 3> sum{}, squares{}, stated{};
  std::array<unsigned, 3> inside{};
  double chi2 = 0.0;
  for (unsigned repeat = 0; repeat < repeats; ++repeat) {
    const SpecimenFit fit = experiment.fit(repeat, options);
    const auto off = experiment.deviations(fit);
    spectrum.take(fit.spectrum, model.specimen, 15e3);
    chi2 += fit.chi2_reduced / repeats;
    for (std::size_t i = 0; i < 3; ++i) {
      sum[i] += off[i] / repeats;
      squares[i] += off[i] * off[i] / repeats;
      stated[i] += fit.parameters[i].sd / fit.parameters[i].value / repeats;
      inside[i] += std::abs(off[i]) < kCovered ? 1U : 0U;
    }
  }
  std::printf("%s, %zu shots, %.1f microstrain, %u repeats: chi2 per degree of freedom %.4f\n",
              name.c_str(), shots, 1e6 * noise, repeats, chi2);
  const char* names[] = {"E1", "E2", "eta2"};
  for (std::size_t i = 0; i < 3; ++i) {
    std::printf(
        "%-5s stated sd %.3f %%  mean %+.3f sd  rms %.3f sd  in the 95 %% interval %.2f %%%s\n",
        names[i], 100 * stated[i], sum[i], std::sqrt(squares[i]), 100.0 * inside[i] / repeats,
        held.judge(100.0 * inside[i] / repeats));
  }
  std::printf("J1, J2 to 15 kHz  rms %.3f sd  in the 95 %% interval %.2f %% of %zu\n",
              std::sqrt(spectrum.mean_square()), 100.0 * spectrum.inside_share(), spectrum.count());
  return held.missed() > 0 ? 1 : 0;
}
