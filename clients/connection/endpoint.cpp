#include "clients/connection/endpoint.hpp"

#include "processing/base/error.hpp"
#include "proto/endpoint.hpp"

namespace kolsky {

void connect_socket(zmq::socket_t& socket, const std::string& endpoint) {
  const std::string place = "endpoint " + endpoint;
  wire::check_port(place, endpoint);
  try {
    socket.connect(endpoint);
  } catch (const zmq::error_t& error) {
    throw InputError(place, error.what(), "write tcp://HOST:PORT, as tcp://127.0.0.1:5602");
  }
}

}  // namespace kolsky
