// The paper's bench with linear specimens, solved in the time domain, given to the fit.
#include "processing/specimen/specimen_fit.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "processing/base/error.hpp"
#include "tests/generators/elastic_shpb.hpp"
#include "tests/generators/linear_shpb.hpp"

namespace kolsky {
namespace {

using testing::LinearShpb;

std::vector<Shot> shots_of(const LinearShpb& model, std::size_t count, unsigned first_seed = 1,
                           double noise = 4e-6) {
  const auto records = model.solve();
  std::vector<Shot> shots;
  for (unsigned i = 0; i < count; ++i) {
    shots.push_back(testing::digitise(model.bench(), records, noise, 16, 0.005, first_seed + i));
  }
  return shots;
}

void show(const SpecimenFit& fit) {
  for (const auto& p : fit.parameters) {
    std::printf("%s %.5g +- %.3f %%\n", p.name.c_str(), p.value, 100 * p.sd / p.value);
  }
  for (const auto& t : fit.tried) {
    std::printf("bars %d specimen %s chi2 %.1f\n", static_cast<int>(t.theory.bars),
                name_of(t.theory.specimen).c_str(), t.chi2);
  }
  std::printf("chi2 %.3f dof %zu band %.0f judged %.0f us end %d\n", fit.chi2_reduced,
              fit.degrees_of_freedom, fit.band_limit_Hz, 1e6 * fit.judged_s, fit.to_the_end);
}

TEST(FitSpecimen, Look) {
  for (bool massless : {true, false}) {
    LinearShpb model;
    model.massless = massless;
    const auto shots = shots_of(model, 10);
    const auto t0 = std::chrono::steady_clock::now();
    const SpecimenFit fit = fit_specimen(shots, BarPrior(paper_pmma()), {});
    const auto t1 = std::chrono::steady_clock::now();
    std::printf("%.1f ms\n", std::chrono::duration<double, std::milli>(t1 - t0).count());
    show(fit);
  }
  LinearShpb cover;
  cover.specimen = {960.0, 987e6, 452e6, 6020.0};
  show(fit_specimen(shots_of(cover, 10), BarPrior(paper_pmma()), {}));
}

}  // namespace
}  // namespace kolsky
