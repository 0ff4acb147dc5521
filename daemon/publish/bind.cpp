#include "daemon/publish/bind.hpp"

#include <cerrno>

#include "processing/base/error.hpp"
#include "proto/endpoint.hpp"

namespace kolsky {
namespace {

struct Explanation {
  std::string what;
  std::string mend;
};

Explanation explain(const zmq::error_t& error) {
  switch (error.num()) {
    case EADDRINUSE:
      return {"another program listens there",
              "stop it (is a kolskyd running already?) or choose another port"};
    case EADDRNOTAVAIL:
    case ENODEV:
      return {"this machine has no such address",
              "use tcp://127.0.0.1:PORT, or tcp://*:PORT for every address of the machine"};
    case EACCES:
      return {"this port is not permitted", "choose one from 1024 on"};
    case EINVAL:
    case EPROTONOSUPPORT:
    case ENOCOMPATPROTO:
      return {"this is no endpoint to listen on", "write tcp://ADDRESS:PORT"};
    default:
      return {error.what(), "choose another endpoint"};
  }
}

}  // namespace

std::string bind_socket(zmq::socket_t& socket, const std::string& setting,
                        const std::string& endpoint) {
  const std::string place = setting + " = \"" + endpoint + "\"";
  wire::check_port(place, endpoint);
  try {
    socket.bind(endpoint);
  } catch (const zmq::error_t& error) {
    const Explanation explanation = explain(error);
    throw InputError(place, explanation.what, explanation.mend);
  }
  return socket.get(zmq::sockopt::last_endpoint);
}

}  // namespace kolsky
