#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/criticism/fitting/study.hpp"

namespace kolsky {

/// Two claimed effects that nearly undo each other.
struct Cancelling {
  std::string one;
  std::string other;
  double left = 0.0;  ///< of the lesser's change of the residuals, what both together make
};

/// Of a fit's effects the two that undo each other most; nothing with fewer than two. Changes are
/// those of the whitened residuals, less what all that is fitted beside takes up.
[[nodiscard]] std::optional<Cancelling> most_cancelling(const Studied& studied,
                                                        const std::vector<std::string>& effects);

}  // namespace kolsky
