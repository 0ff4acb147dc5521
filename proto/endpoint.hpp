#pragma once

#include <string>

namespace kolsky::wire {

/// Checks what ZeroMQ does not: it takes port 99999 for 34463 and 5600x for 5600.
/// @param place  where the endpoint was given
/// @throws InputError where a tcp endpoint's port is none
void check_port(const std::string& place, const std::string& endpoint);

}  // namespace kolsky::wire
