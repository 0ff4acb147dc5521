#pragma once

#include <string>

namespace google::protobuf {
class Message;
}

namespace kolsky::wire {

/// Serialises what may hold text from anywhere: file names, device descriptions, tables in Latin-1.
/// A receiver refuses a whole message for one byte that is not UTF-8, so such bytes go out as "?".
[[nodiscard]] std::string serialise(const google::protobuf::Message& message);

}  // namespace kolsky::wire
