#include "daemon/publish/request.hpp"

#include <algorithm>

#include "proto/codec.hpp"

namespace kolsky {
namespace {

constexpr std::size_t kMaxIdBytes = 256;

/// Ids come back in one-line messages and in other people's terminals.
void check_id(const std::string& id, const std::string& field, const std::string& mend) {
  if (id.empty()) {
    throw InputError(field, "it is missing", mend);
  }
  if (id.size() > kMaxIdBytes) {
    throw InputError(field, std::to_string(id.size()) + " bytes are too long",
                     "use at most " + std::to_string(kMaxIdBytes));
  }
  const bool printable = std::ranges::all_of(
      id, [](char c) { return static_cast<unsigned char>(c) >= 0x20 && c != 0x7f; });
  if (!printable) {
    throw InputError(field, "it has control characters", "use printable text");
  }
}

void check_version(const v1::ControlRequest& request) {
  if (request.schema_version() != wire::kSchemaVersion) {
    throw InputError("schema_version",
                     std::to_string(request.schema_version()) + " is not spoken here",
                     "use " + std::to_string(wire::kSchemaVersion) +
                         ", or a client and a kolskyd of the same age");
  }
}

void check_form(const v1::ControlRequest& request) {
  check_id(request.request_id(), "request_id", "draw a new one for each request");
  check_id(request.client_id(), "client_id", "say who asks, as user@host");
  if (request.command_case() == v1::ControlRequest::COMMAND_NOT_SET) {
    throw InputError(
        "command", "there is none that version " + std::to_string(wire::kSchemaVersion) + " knows",
        "set one, as arm or status");
  }
}

void dispatch(const v1::ControlRequest& request, ControlHandler& handler, v1::ControlReply& reply) {
  switch (request.command_case()) {
    case v1::ControlRequest::kStatus:
      return handler.status(*reply.mutable_status());
    case v1::ControlRequest::kArm:
      return handler.arm(*reply.mutable_preflight());
    case v1::ControlRequest::kDisarm:
      return handler.disarm();
    case v1::ControlRequest::kForceTrigger:
      return handler.force_trigger();
    case v1::ControlRequest::kFire:
      return handler.fire();
    case v1::ControlRequest::kListShots:
      return handler.list_shots(request.list_shots().most(), *reply.mutable_shots());
    case v1::ControlRequest::kGetShot:
      return handler.get_shot(request.get_shot().id(), *reply.mutable_shot());
    case v1::ControlRequest::kReload:
      return handler.reload();
    case v1::ControlRequest::kStop:
      return handler.stop();
    case v1::ControlRequest::kDiagnose:
      return handler.diagnose(request.diagnose(), *reply.mutable_diagnosis());
    case v1::ControlRequest::kCancelDiagnosis:
      return handler.cancel_diagnosis();
    case v1::ControlRequest::kDiagnosis:
      return handler.diagnosis(*reply.mutable_diagnosis());
    case v1::ControlRequest::kSnapshot:
      return handler.snapshot(*reply.mutable_snapshot());
    case v1::ControlRequest::kRelease:
    case v1::ControlRequest::COMMAND_NOT_SET:
      return;
  }
}

/// Of a reply that says no, only what explains it stays.
void drop_answer(v1::ControlReply& reply) {
  if (!reply.has_preflight()) {
    reply.clear_body();
  }
}

}  // namespace

void ControlHandler::diagnose(const v1::Diagnose& /*request*/, v1::Diagnosis& /*diagnosis*/) {
  throw InputError("diagnose", "is not done here", "ask a kolskyd that compares its shots");
}

void ControlHandler::cancel_diagnosis() {
  throw InputError("cancel_diagnosis", "there is none under way", "nothing needs to be done");
}

void ControlHandler::diagnosis(v1::Diagnosis& /*diagnosis*/) {
  throw InputError("diagnosis", "there is none", "ask for one with `kolsky diagnose-live`");
}

void refuse(v1::Refusal refusal, const InputError& error, v1::ControlReply& reply) {
  reply.set_ok(false);
  reply.set_refusal(refusal);
  reply.set_error(error.what());
  v1::Problem& problem = *reply.mutable_problem();
  problem.set_place(error.place());
  problem.set_what(error.problem());
  problem.set_mend(error.mend());
}

bool read_request(std::string_view bytes, v1::ControlRequest& request, v1::ControlReply& reply) {
  v1::Refusal refusal = v1::MALFORMED;
  try {
    if (bytes.size() > wire::kMaxRequestBytes) {
      throw InputError("request", std::to_string(bytes.size()) + " bytes are too long",
                       "send at most " + std::to_string(wire::kMaxRequestBytes));
    }
    wire::parse(bytes, "request", request);
    reply.set_request_id(request.request_id());
    refusal = v1::SCHEMA_VERSION;
    check_version(request);
    refusal = v1::MALFORMED;
    check_form(request);
    return true;
  } catch (const InputError& error) {
    refuse(refusal, error.place() == "request" ? error : error.inside("request"), reply);
    return false;
  }
}

void carry_out(const v1::ControlRequest& request, ControlHandler& handler,
               v1::ControlReply& reply) {
  try {
    dispatch(request, handler, reply);
    reply.set_ok(true);
    return;
  } catch (const InputError& error) {
    refuse(v1::NOT_DONE, error, reply);
  } catch (const std::exception& error) {
    refuse(v1::NOT_DONE, InputError(command_name(request), error.what(), "see the log of kolskyd"),
           reply);
  }
  drop_answer(reply);
}

std::string command_name(const v1::ControlRequest& request) {
  const auto* field = v1::ControlRequest::descriptor()->FindFieldByNumber(request.command_case());
  return field == nullptr ? "request" : field->name();
}

}  // namespace kolsky
