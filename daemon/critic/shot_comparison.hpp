#pragma once

#include "daemon/critic/active_model.hpp"
#include "processing/base/shot.hpp"
#include "proto/forward.hpp"

namespace kolsky {

/// One shot beside the active model as it is: what `kolsky compare` says of its capture, to the
/// bit. Fills all but `trend` and `duration_s`. A shot that cannot be compared says why.
void compare_with_model(const Shot& shot, const ActiveModel& model, v1::Comparison& message);

}  // namespace kolsky
