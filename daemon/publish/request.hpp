#pragma once

#include <string_view>

#include "daemon/publish/control_server.hpp"
#include "kolsky/v1/kolsky.pb.h"
#include "processing/base/error.hpp"

// A control request without the sockets: reading it, carrying it out, saying no. For the .cpp files
// of the control server and its tests.
namespace kolsky {

/// Reads and checks the bytes of a request.
/// @return whether it can be carried out; if not, `reply` says why not
[[nodiscard]] bool read_request(std::string_view bytes, v1::ControlRequest& request,
                                v1::ControlReply& reply);

/// Has the handler do it and fills the reply's outcome and body; what the handler throws becomes a
/// refusal. @pre read_request found nothing wrong
void carry_out(const v1::ControlRequest& request, ControlHandler& handler, v1::ControlReply& reply);

void refuse(v1::Refusal refusal, const InputError& error, v1::ControlReply& reply);

/// The command's name in the schema, as "arm".
[[nodiscard]] std::string command_name(const v1::ControlRequest& request);

}  // namespace kolsky
