#pragma once

#include <string>
#include <zmq.hpp>

namespace kolsky {

/// Binds and gives the endpoint as it came out, with the port.
/// @param setting  where the endpoint comes from, as "endpoints.results"
/// @throws InputError naming both
std::string bind_socket(zmq::socket_t& socket, const std::string& setting,
                        const std::string& endpoint);

}  // namespace kolsky
