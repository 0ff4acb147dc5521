#pragma once

#include <string>
#include <vector>

#include "processing/base/shot.hpp"

namespace kolsky::cli {

/// Captures named on the command line (files, or folders of them), read; each shot's id is its
/// file's path. @throws InputError, also where two hold one shot: it would count twice and agree
/// with itself
[[nodiscard]] std::vector<Shot> captured_shots(const std::vector<std::string>& places);

}  // namespace kolsky::cli
