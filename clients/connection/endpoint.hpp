#pragma once

#include <string>
#include <zmq.hpp>

namespace kolsky {

/// @throws InputError where the endpoint is none; one that nobody listens on yet is fine
void connect_socket(zmq::socket_t& socket, const std::string& endpoint);

}  // namespace kolsky
