#pragma once

#include <string>

#include "clients/cli/reports/reduced_shot.hpp"
#include "clients/connection/control_client.hpp"

namespace kolsky::cli {

/// A client that fails within three seconds, with the endpoint in its message, where no daemon
/// answers.
[[nodiscard]] ControlClient connect(const std::string& endpoint);

/// The same for commands that may take longer: first makes sure that somebody is there.
[[nodiscard]] ControlClient connect_patiently(const std::string& endpoint);

/// A shot and its result from the daemon. @param id  or "last"
/// @throws InputError where there is no such shot, or it is not reduced yet
[[nodiscard]] ReducedShot fetch_shot(ControlClient& client, const std::string& id);

}  // namespace kolsky::cli
