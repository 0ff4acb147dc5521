#pragma once

#include <span>
#include <vector>

#include "processing/models/model.hpp"
#include "processing/models/scene.hpp"
#include "processing/models/transfers.hpp"

namespace kolsky {

/// An effect with the numbers it has for one shot and, where its strengths differ by gauge, one
/// gauge.
struct AppliedEffect {
  const Effect* effect = nullptr;
  std::size_t gauge = 0;
  std::vector<double> values{};

  bool operator==(const AppliedEffect&) const = default;
};

/// Lets effects shape the scene of one shot, stage by stage.
void shape(const std::vector<AppliedEffect>& effects, Scene& scene);

}  // namespace kolsky
