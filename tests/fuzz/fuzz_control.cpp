// Any bytes are a control request and get a reply, or are refused with one line; any bytes are a
// shot, a result or a trigger that goes out as it came in, or are refused.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "daemon/publish/request.hpp"
#include "proto/codec.hpp"
#include "proto/text.hpp"

namespace {

using namespace kolsky;

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

/// Does nothing, now and then not even that.
class IdleHandler : public ControlHandler {
 public:
  void status(v1::Status& /*status*/) override {}
  void snapshot(v1::Snapshot& /*snapshot*/) override {}
  void arm(v1::Preflight& preflight) override {
    preflight.add_checks();
    throw InputError("disk", "it is full", "free some of it");
  }
  void disarm() override {}
  void force_trigger() override {}
  void fire() override { throw std::runtime_error("\xff stuck"); }
  void reload() override {}
  void stop() override {}
  void list_shots(std::size_t /*most*/, v1::ShotList& /*shots*/) override {}
  void get_shot(const std::string& id, v1::ShotAndResult& /*shot*/) override {
    throw InputError(id, "there is no such shot", "see the list");
  }
};

void try_request(std::string_view bytes) {
  v1::ControlRequest request;
  v1::ControlReply reply;
  const bool readable = read_request(bytes, request, reply);
  if (readable) {
    IdleHandler handler;
    carry_out(request, handler, reply);
    require(!request.request_id().empty() && !request.client_id().empty());
  } else {
    require(reply.error().find('\n') == std::string::npos);
  }
  require(reply.ok() == reply.error().empty());
  require(reply.ok() == (reply.refusal() == v1::REFUSAL_UNSPECIFIED));
  v1::ControlReply received;
  require(received.ParseFromString(wire::serialise(reply)));
}

/// Reads, decodes, encodes and compares the bytes of what comes out with those of doing it once
/// more.
template <class Message, class Encode>
void try_round_trip(std::string_view bytes, const Encode& encode) {
  Message received;
  wire::parse(bytes, "input", received);
  Message once;
  encode(wire::decode(received), once);
  Message twice;
  encode(wire::decode(once), twice);
  require(once.ByteSizeLong() == twice.ByteSizeLong());
}

template <class Try>
void refused_or_done(const Try& attempt) {
  try {
    attempt();
  } catch (const InputError& error) {
    require(std::string_view(error.what()).find('\n') == std::string_view::npos);
    require(!error.mend().empty());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try_request(bytes);
  refused_or_done([&] {
    try_round_trip<v1::Shot>(bytes, [](const Shot& shot, v1::Shot& message) {
      wire::encode(shot, "capture.h5", message);
    });
  });
  refused_or_done([&] {
    try_round_trip<v1::Result>(bytes, [](const Reduction& reduction, v1::Result& message) {
      wire::encode(reduction, "id", message);
    });
  });
  refused_or_done([&] {
    try_round_trip<v1::TriggerInfo>(bytes, [](const TriggerEvent& event, v1::TriggerInfo& message) {
      wire::encode(event, message);
    });
  });
  return 0;
}
