#pragma once

#include <cstdint>
#include <string>

namespace kolsky {

/// Tells the service manager, as systemd's notify protocol: a datagram to $NOTIFY_SOCKET. Does
/// nothing where there is none. @param message  as "READY=1"
void sd_notify(const std::string& message) noexcept;

/// How often the service manager wants to hear WATCHDOG=1, in microseconds; 0 where it does not.
[[nodiscard]] std::uint64_t watchdog_interval_us() noexcept;

}  // namespace kolsky
