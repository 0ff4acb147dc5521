#pragma once

#include <optional>

#include "processing/criticism/records/campaign.hpp"
#include "processing/models/model.hpp"

namespace kolsky {

/// The model beside a hum of every shot's own, alike at all gauges, all else held: where the
/// samples before the pulses slope together as noise of gauges does once in ten thousand campaigns.
/// What it explains follows no source and is slow, so that it would pass for slow noise.
/// @return nothing where they do not slope so, or the model has a hum
[[nodiscard]] std::optional<Model> beside_common_hum(const Model& model, const Campaign& campaign);

}  // namespace kolsky
