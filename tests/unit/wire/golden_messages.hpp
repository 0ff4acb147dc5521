#pragma once

#include <google/protobuf/message.h>

#include <memory>
#include <string>
#include <vector>

namespace kolsky::golden {

/// A message as version 1 of the schema sends it, and the file its bytes were once written to.
/// Between them the fixtures have every field of the schema. Never change one: add another.
struct Fixture {
  std::string name;
  std::shared_ptr<const google::protobuf::Message> message;
};

[[nodiscard]] std::vector<Fixture> fixtures();

/// The message's bytes with maps in a fixed order.
[[nodiscard]] std::string deterministic_bytes(const google::protobuf::Message& message);

/// Every field and enumerator of the schema with its number and type, one a line, sorted.
[[nodiscard]] std::vector<std::string> schema_lines();

}  // namespace kolsky::golden
