#include "processing/base/material.hpp"

#include <cmath>

#include "processing/base/error.hpp"
#include "processing/base/range.hpp"

namespace kolsky {

namespace {

constexpr Range kModulus{1e5, 1e15, "Pa", "give pascals: 5.66 GPa is 5.66e9"};
constexpr Range kViscosity{1e-2, 1e15, "Pa s", "give pascal seconds: 1.81 MPa s is 1.81e6"};
constexpr Range kRetardation{1e-7, 10.0, "s", ""};
constexpr Range kBand{1.0, 1e9, "Hz", "give hertz"};
constexpr Range kTemperature{1.0, 2000.0, "K", "give kelvins: 20 degrees Celsius are 293.15"};
constexpr std::size_t kParameters = 3;
constexpr double kRounding = 1e-6;

void require_covariance(const std::array<double, kParameters * kParameters>& numbers) {
  const auto at = [&](std::size_t i, std::size_t j) { return numbers.at(i * kParameters + j); };
  for (std::size_t i = 0; i < kParameters; ++i) {
    for (std::size_t j = 0; j < kParameters; ++j) {
      const double most = std::sqrt(at(i, i) * at(j, j));
      if (!(std::abs(at(i, j) - at(j, i)) <= kRounding * most &&
            std::abs(at(i, j)) <= most * (1.0 + kRounding) && std::isfinite(most))) {
        throw InputError("covariance", "is not a covariance",
                         "give a symmetric matrix with no correlation above 1");
      }
    }
  }
}

}  // namespace

Material paper_pmma() {
  Material pmma;
  pmma.density_kg_m3 = {1180.0, 0.0};
  pmma.poisson_ratio = {0.360, 0.0};
  pmma.E1_Pa = {5.66e9, 0.0};
  pmma.E2_Pa = {37.0e9, 0.0};
  pmma.eta2_Pa_s = {1.81e6, 0.0};
  pmma.source = "the paper's PMMA (Table 4, row 1)";
  return pmma;
}

Material paper_golf_core() {
  Material core;
  core.density_kg_m3 = {1140.0, 0.0};
  core.poisson_ratio = {0.376, 0.0};
  core.E1_Pa = {121e6, 0.0};
  core.E2_Pa = {143e6, 0.0};
  core.eta2_Pa_s = {2860.0, 0.0};
  core.source = "paper, Table 3: polybutadiene";
  return core;
}

Material paper_golf_cover() {
  Material cover;
  cover.density_kg_m3 = {960.0, 0.0};
  cover.poisson_ratio = {0.319, 0.0};
  cover.E1_Pa = {987e6, 0.0};
  cover.E2_Pa = {452e6, 0.0};
  cover.eta2_Pa_s = {6020.0, 0.0};
  cover.source = "paper, Table 3: ionomer";
  return cover;
}

void check(const Material& material) {
  require_in_range("density_kg_m3", material.density_kg_m3, ranges::kDensity);
  require_in_range("poisson_ratio", material.poisson_ratio, ranges::kPoissonRatio);
  require_in_range("E1_Pa", material.E1_Pa, kModulus);
  require_in_range("E2_Pa", material.E2_Pa, kModulus);
  require_in_range("eta2_Pa_s", material.eta2_Pa_s, kViscosity);
  const double retardation_s = material.eta2_Pa_s / material.E2_Pa;
  if (retardation_s < kRetardation.least || retardation_s > kRetardation.most) {
    throw InputError("eta2_Pa_s",
                     "makes a retardation time eta2/E2 of " +
                         in_words(retardation_s, kRetardation.unit) + ", outside " +
                         in_words(kRetardation.least, "") + " to " +
                         in_words(kRetardation.most, kRetardation.unit),
                     "check its unit: 2.86 kPa s is 2860, 1.81 MPa s is 1.81e6");
  }
  if (material.covariance) {
    require_covariance(*material.covariance);
  }
  if (material.identified && material.identified->band_limit_Hz) {
    require_in_range("identified.band_limit_Hz", {*material.identified->band_limit_Hz}, kBand);
  }
  if (material.identified && material.identified->temperature_K) {
    require_in_range("identified.temperature_K", {*material.identified->temperature_K},
                     kTemperature);
  }
}

}  // namespace kolsky
