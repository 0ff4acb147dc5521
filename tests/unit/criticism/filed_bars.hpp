#pragma once

#include <cstddef>
#include <vector>

#include "processing/criticism/fitting/study.hpp"
#include "tests/generators/campaign.hpp"

namespace kolsky {

/// The paper's split bar with the bars' moduli as a campaign files them. @pre truth.filed_bars
inline Model filed_split_bar(const testing::Campaign& truth) {
  Model model = paper_model(BenchKind::shpb, false);
  const Material& filed = *truth.filed_bars;
  const std::vector<Measured> numbers{filed.E1_Pa(), filed.E2_Pa(), filed.eta2_Pa_s()};
  for (std::size_t p = 0; p < numbers.size(); ++p) {
    ModelValue& value = model.find("three-element-bar")->values[p];
    value.value = value.prior_mean = numbers[p].value;
    value.prior_sd = numbers[p].sd;
    value.free = numbers[p].sd > 0.0;
  }
  return model;
}

}  // namespace kolsky
