#pragma once

#include <string>
#include <vector>

#include "processing/base/error.hpp"
#include "processing/base/shot.hpp"

namespace kolsky::cli {

/// Captures named on the command line (files, or folders of them), read; each shot's id is its
/// file's path. @throws InputError, also where two hold one shot: it would count twice and agree
/// with itself
[[nodiscard]] std::vector<Shot> captured_shots(const std::vector<std::string>& places);

/// An error of what captures hold, seen from the command line: after the places they were named by,
/// unless it names the capture itself.
[[nodiscard]] InputError in_captures(const InputError& error,
                                     const std::vector<std::string>& places);

}  // namespace kolsky::cli
