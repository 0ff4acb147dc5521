#include "processing/base/material.hpp"

namespace kolsky {

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

}  // namespace kolsky
