#pragma once

#include <cstddef>
#include <cstdint>

#include "processing/trigger/incident_trigger.hpp"

namespace kolsky {

/// What the acquisition thread watches for and cuts out.
struct AcquisitionPlan {
  std::size_t trigger_channel = 0;
  TriggerOptions trigger;
  std::int64_t pre_samples = 0;
  std::int64_t post_samples = 0;
};

}  // namespace kolsky
