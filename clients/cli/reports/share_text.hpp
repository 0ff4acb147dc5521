#pragma once

#include <string>

namespace kolsky::cli {

/// Two digits: "0.98 %"; whole from a hundred on: "420 %".
[[nodiscard]] std::string share_text(double share);

}  // namespace kolsky::cli
