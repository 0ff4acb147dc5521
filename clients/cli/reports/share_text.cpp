#include "clients/cli/reports/share_text.hpp"

#include <fmt/format.h>

namespace kolsky::cli {

std::string share_text(double share) {
  constexpr double kWhole = 0.995;
  return share < kWhole ? fmt::format("{:.2g} %", 100.0 * share)
                        : fmt::format("{:.0f} %", 100.0 * share);
}

}  // namespace kolsky::cli
