#pragma once

#include <string>

#include "daemon/config.hpp"

namespace kolsky {

/// What `kolskyd --check` prints: what the daemon would do with this configuration, for people.
[[nodiscard]] std::string check_report(const DaemonConfig& config, const Apparatus& apparatus);

}  // namespace kolsky
