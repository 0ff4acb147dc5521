#pragma once

#include "kolsky/v1/kolsky.pb.h"

namespace kolsky::wire {

/// "green", "amber" or "red"; "none" of a shot that was not compared.
[[nodiscard]] const char* name_of(v1::Comparison::Light light);

}  // namespace kolsky::wire
