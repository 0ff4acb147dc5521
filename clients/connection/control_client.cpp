#include "clients/connection/control_client.hpp"

#include <pwd.h>
#include <unistd.h>

#include <array>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <random>
#include <utility>
#include <zmq.hpp>

#include "clients/connection/endpoint.hpp"
#include "kolsky/v1/kolsky.pb.h"
#include "processing/base/error.hpp"
#include "proto/codec.hpp"
#include "proto/text.hpp"

namespace kolsky {
namespace {

std::string draw_id() {
  std::random_device random;
  std::array<char, 33> text{};
  std::snprintf(text.data(), text.size(), "%08x%08x%08x%08x", random(), random(), random(),
                random());
  return text.data();
}

void throw_refusal(const v1::ControlReply& reply, const std::string& endpoint) {
  const v1::Problem& problem = reply.problem();
  throw InputError("kolskyd at " + endpoint + ": " + problem.place(),
                   reply.has_problem() ? problem.what() : reply.error(),
                   reply.has_problem() ? problem.mend() : "see the log of kolskyd");
}

}  // namespace

std::string default_client_id() {
  if (const char* name = std::getenv("KOLSKY_OPERATOR"); name != nullptr && *name != '\0') {
    return name;
  }
  std::array<char, HOST_NAME_MAX + 1> host{};
  if (gethostname(host.data(), host.size() - 1) != 0) {
    host = {"localhost"};
  }
  passwd entry{};
  passwd* found = nullptr;
  std::array<char, 4096> memory{};
  const bool known =
      getpwuid_r(getuid(), &entry, memory.data(), memory.size(), &found) == 0 && found != nullptr;
  const std::string user = known ? found->pw_name : "uid" + std::to_string(getuid());
  return user + "@" + host.data();
}

struct ControlClient::State {
  explicit State(ControlClientOptions client_options) : options(std::move(client_options)) {
    connect_fresh();
  }

  void connect_fresh();
  v1::ControlReply exchange(v1::ControlRequest& request);
  [[noreturn]] void give_up(const v1::ControlRequest& request) const;
  std::optional<v1::ControlReply> attempt(const v1::ControlRequest& request);

  /// One command, chosen by `choose`. @throws InputError with the daemon's words if refused
  template <class Choose>
  static v1::ControlReply ask(ControlClient& client, const Choose& choose) {
    v1::ControlRequest command;
    choose(command);
    v1::ControlReply reply = client.request(std::move(command));
    if (!reply.ok()) {
      throw_refusal(reply, client.state_->options.endpoint);
    }
    return reply;
  }

  ControlClientOptions options;
  zmq::context_t context{1};
  zmq::socket_t socket;
  std::uint64_t boot_id = 0;  ///< of the last reply
  int attempts_needed = 0;    ///< by the last exchange
};

/// REQ takes one question and then only its answer: after a missing one it is of no more use.
void ControlClient::State::connect_fresh() {
  socket = zmq::socket_t(context, zmq::socket_type::req);
  socket.set(zmq::sockopt::linger, 0);
  connect_socket(socket, options.endpoint);
}

/// One attempt; nothing if no answer came in time.
std::optional<v1::ControlReply> ControlClient::State::attempt(const v1::ControlRequest& request) {
  const std::string bytes = wire::serialise(request);
  socket.set(zmq::sockopt::sndtimeo, static_cast<int>(options.timeout.count()));
  socket.set(zmq::sockopt::rcvtimeo, static_cast<int>(options.timeout.count()));
  zmq::message_t answer;
  try {
    if (!socket.send(zmq::buffer(bytes)) || !socket.recv(answer)) {
      return std::nullopt;
    }
  } catch (const zmq::error_t& error) {
    if (error.num() != EINTR) {
      throw;
    }
    return std::nullopt;
  }
  v1::ControlReply reply;
  wire::parse({answer.data<char>(), answer.size()}, "reply of " + options.endpoint, reply);
  if (reply.request_id() != request.request_id() && !reply.request_id().empty()) {
    throw InputError("reply of " + options.endpoint, "it answers another request",
                     "give the control endpoint of a kolskyd");
  }
  return reply;
}

v1::ControlReply ControlClient::State::exchange(v1::ControlRequest& request) {
  request.set_request_id(draw_id());
  request.set_client_id(options.client_id);
  request.set_schema_version(wire::kSchemaVersion);
  for (attempts_needed = 1; attempts_needed <= options.attempts; ++attempts_needed) {
    if (std::optional<v1::ControlReply> reply = attempt(request)) {
      boot_id = reply->boot_id();
      return *std::move(reply);
    }
    connect_fresh();
  }
  give_up(request);
}

void ControlClient::State::give_up(const v1::ControlRequest& request) const {
  const auto waited_s = std::chrono::duration<double>(options.timeout * options.attempts).count();
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "no answer in %.1f s", waited_s);
  throw InputError("kolskyd at " + options.endpoint,
                   wire::changes_state(request)
                       ? std::string(text.data()) + ", so nobody knows whether it was done"
                       : text.data(),
                   "start kolskyd, or give its control endpoint");
}

ControlClient::ControlClient(ControlClientOptions options)
    : state_(std::make_unique<State>(std::move(options))) {}
ControlClient::~ControlClient() = default;
ControlClient::ControlClient(ControlClient&&) noexcept = default;
ControlClient& ControlClient::operator=(ControlClient&&) noexcept = default;

v1::ControlReply ControlClient::request(v1::ControlRequest command) {
  if (!wire::changes_state(command)) {
    return state_->exchange(command);
  }
  // A command is tied to the daemon that runs now, so that an attempt of it that was carried out by
  // one daemon is not carried out again by its successor.
  if (state_->boot_id == 0) {
    static_cast<void>(status());
  }
  command.set_boot_id(state_->boot_id);
  v1::ControlReply reply = state_->exchange(command);
  if (reply.refusal() == v1::OTHER_BOOT && state_->attempts_needed == 1) {
    // What we knew was old, and this is the only attempt there was.
    command.set_boot_id(state_->boot_id);
    reply = state_->exchange(command);
  }
  return reply;
}

v1::Status ControlClient::status() {
  return State::ask(*this, [](auto& command) { command.mutable_status(); }).status();
}

v1::Preflight ControlClient::arm() {
  return State::ask(*this, [](auto& command) { command.mutable_arm(); }).preflight();
}

void ControlClient::disarm() {
  State::ask(*this, [](auto& command) { command.mutable_disarm(); });
}

void ControlClient::force_trigger() {
  State::ask(*this, [](auto& command) { command.mutable_force_trigger(); });
}

void ControlClient::fire() {
  State::ask(*this, [](auto& command) { command.mutable_fire(); });
}

void ControlClient::reload() {
  State::ask(*this, [](auto& command) { command.mutable_reload(); });
}

void ControlClient::stop() {
  State::ask(*this, [](auto& command) { command.mutable_stop(); });
}

void ControlClient::release() {
  State::ask(*this, [](auto& command) { command.mutable_release(); });
}

v1::ShotList ControlClient::list_shots(std::size_t most) {
  return State::ask(*this,
                    [most](auto& command) {
                      command.mutable_list_shots()->set_most(static_cast<std::uint32_t>(most));
                    })
      .shots();
}

v1::ShotAndResult ControlClient::get_shot(const std::string& id) {
  return State::ask(*this, [&id](auto& command) { command.mutable_get_shot()->set_id(id); }).shot();
}

v1::Snapshot ControlClient::snapshot() {
  return State::ask(*this, [](auto& command) { command.mutable_snapshot(); }).snapshot();
}

}  // namespace kolsky
