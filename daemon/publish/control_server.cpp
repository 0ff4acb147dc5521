#include "daemon/publish/control_server.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <mutex>
#include <system_error>
#include <utility>
#include <vector>
#include <zmq.hpp>

#include "daemon/publish/bind.hpp"
#include "daemon/publish/lease.hpp"
#include "daemon/publish/reply_memory.hpp"
#include "daemon/publish/request.hpp"
#include "daemon/publish/worker.hpp"
#include "daemon/thread.hpp"
#include "kolsky/v1/kolsky.pb.h"
#include "proto/codec.hpp"
#include "proto/text.hpp"

namespace kolsky {
namespace {

constexpr int kPeerQueue = 32;  // replies held for a client that does not read them
constexpr std::int64_t kMaxFrameBytes = 1 << 20;  // longer ones cost the peer its connection
constexpr int kLinger_ms = 500;                   // for the reply to `stop`
constexpr int kRequestsPerTurn = 64;              // then finished replies are sent, whoever floods
constexpr std::size_t kMostFrames = 16;
constexpr std::size_t kMaxWaitingPerRequest = 8;
constexpr std::chrono::milliseconds kPollTimeout{1000};

/// Lets other threads interrupt the server's poll.
class WakeUp {
 public:
  WakeUp() : descriptor_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
    if (descriptor_ < 0) {
      throw std::system_error(errno, std::generic_category(), "eventfd");
    }
  }
  ~WakeUp() { close(descriptor_); }
  WakeUp(const WakeUp&) = delete;
  WakeUp& operator=(const WakeUp&) = delete;

  [[nodiscard]] int descriptor() const { return descriptor_; }
  void ring() const { static_cast<void>(eventfd_write(descriptor_, 1)); }
  void clear() const {
    eventfd_t rings = 0;
    static_cast<void>(eventfd_read(descriptor_, &rings));
  }

 private:
  int descriptor_;
};

/// A request as it came in.
struct Incoming {
  Route from;
  std::string bytes;
  bool one_frame = false;
};

/// What a worker hands back to the server's thread.
struct Outcome {
  RequestKey key;
  bool command = false;  ///< not a question
  bool release = false;
  v1::ControlReply reply;
};

/// The same for all that the client may vary between two attempts at one request.
std::string command_of(const v1::ControlRequest& request) {
  v1::ControlRequest bare = request;
  bare.clear_boot_id();
  return bare.SerializeAsString();
}

std::string frame_text(const zmq::message_t& frame) {
  return {frame.data<char>(), frame.size()};
}

}  // namespace

struct ControlServer::State {
  State(const ControlServerOptions& server_options, ControlHandler& control_handler)
      : options(server_options),
        handler(control_handler),
        socket(context, zmq::socket_type::router),
        lease(options.lease),
        commands(options.remembered_replies, options.remembered_bytes),
        questions(options.remembered_replies, options.remembered_bytes),
        command_worker("kolsky-command", options.most_waiting),
        reading_worker("kolsky-answer", options.most_waiting) {
    socket.set(zmq::sockopt::sndhwm, kPeerQueue);
    socket.set(zmq::sockopt::maxmsgsize, kMaxFrameBytes);
    socket.set(zmq::sockopt::linger, kLinger_ms);
    endpoint = bind_socket(socket, "endpoints.control", options.endpoint);
    thread = Thread("kolsky-control", [this] { serve(); });
  }

  ~State() {
    stopping = true;
    command_worker.finish();
    reading_worker.finish();
    finished = true;
    wake.ring();
    thread.join();
  }

  void serve();
  void take_requests();
  bool receive(Incoming& incoming);
  void answer(const Incoming& incoming);
  void answer_known(ReplyMemory::Entry& entry, const v1::ControlRequest& request, Route from);
  bool may_change(const v1::ControlRequest& request, v1::ControlReply& reply);
  void start(const v1::ControlRequest& request, const RequestKey& key);
  Outcome run(const v1::ControlRequest& request, const RequestKey& key);
  void hand_back(Outcome outcome);
  void send_outcomes();
  void conclude(Outcome outcome);
  void send(const Route& to, const std::string& reply);
  [[nodiscard]] std::string seal(v1::ControlReply& reply);
  [[nodiscard]] std::string operator_id() const;

  ReplyMemory& memory(bool command) { return command ? commands : questions; }

  const ControlServerOptions options;
  ControlHandler& handler;
  zmq::context_t context{1};
  zmq::socket_t socket;
  std::string endpoint;
  WakeUp wake;

  mutable std::mutex lease_mutex;
  Lease lease;

  // Only the server's thread.
  ReplyMemory commands;
  ReplyMemory questions;
  std::size_t commands_under_way = 0;

  std::mutex outbox_mutex;
  std::vector<Outcome> outbox;

  std::atomic<bool> stopping = false;  ///< nothing is carried out any more
  std::atomic<bool> finished = false;  ///< and nothing will be handed back
  Worker command_worker;
  Worker reading_worker;
  Thread thread;
};

void ControlServer::State::serve() {
  while (!finished) {
    zmq::pollitem_t items[] = {{socket.handle(), 0, ZMQ_POLLIN, 0},
                               {nullptr, wake.descriptor(), ZMQ_POLLIN, 0}};
    try {
      zmq::poll(items, std::size(items), kPollTimeout);
      wake.clear();
      send_outcomes();
      take_requests();
    } catch (const zmq::error_t& error) {
      if (error.num() != EINTR) {
        throw;
      }
    }
  }
  send_outcomes();
}

void ControlServer::State::take_requests() {
  for (int i = 0; i < kRequestsPerTurn; ++i) {
    Incoming incoming;
    if (!receive(incoming)) {
      return;
    }
    answer(incoming);
  }
}

/// Takes one message as REP does: what comes before an empty frame is the way back. A peer may also
/// send its request alone. Of frames beyond any sensible number, only the last is kept.
bool ControlServer::State::receive(Incoming& incoming) {
  zmq::message_t frame;
  if (!socket.recv(frame, zmq::recv_flags::dontwait)) {
    return false;
  }
  incoming.from = {frame_text(frame)};
  std::vector<std::string> frames;
  while (frame.more()) {
    static_cast<void>(socket.recv(frame, zmq::recv_flags::dontwait));
    if (frames.size() == kMostFrames) {
      frames.pop_back();
    }
    frames.push_back(frame_text(frame));
  }
  if (frames.empty()) {
    return true;
  }
  const auto last = frames.end() - 1;
  const auto delimiter = std::find(frames.begin(), last, std::string());
  const auto body = delimiter == last ? frames.begin() : delimiter + 1;
  incoming.from.insert(incoming.from.end(), frames.begin(), body);
  incoming.one_frame = body == last;
  incoming.bytes = frames.back();
  return true;
}

void ControlServer::State::answer(const Incoming& incoming) {
  v1::ControlRequest request;
  v1::ControlReply reply;
  if (!incoming.one_frame) {
    refuse(v1::MALFORMED, InputError("request", "it is not one frame", "send one ControlRequest"),
           reply);
    return send(incoming.from, seal(reply));
  }
  if (!read_request(incoming.bytes, request, reply)) {
    return send(incoming.from, seal(reply));
  }
  {
    const std::lock_guard lock(lease_mutex);
    lease.heard_from(request.client_id(), Lease::Clock::now());
  }
  const bool command = wire::changes_state(request);
  const RequestKey key{request.client_id(), request.request_id()};
  if (ReplyMemory::Entry* known = memory(command).find(key)) {
    return answer_known(*known, request, incoming.from);
  }
  memory(command).begin(key, command_of(request), incoming.from);
  if (command && !may_change(request, reply)) {
    return conclude({key, true, false, std::move(reply)});
  }
  start(request, key);
}

void ControlServer::State::answer_known(ReplyMemory::Entry& entry,
                                        const v1::ControlRequest& request, Route from) {
  v1::ControlReply reply;
  if (entry.command != command_of(request)) {
    reply.set_request_id(request.request_id());
    refuse(v1::ID_REUSED,
           InputError("request: request_id", "it was used for another command",
                      "draw a new one for each request"),
           reply);
  } else if (entry.finished) {
    wire::parse(entry.reply, "reply", reply);
    reply.set_repeated_request(true);
  } else {
    // Answered when it is done. Of a client that asks again and again, only the latest sockets
    // matter.
    if (entry.waiting.size() >= kMaxWaitingPerRequest) {
      entry.waiting.erase(entry.waiting.begin() + 1);
    }
    entry.waiting.push_back(std::move(from));
    return;
  }
  send(from, seal(reply));
}

bool ControlServer::State::may_change(const v1::ControlRequest& request, v1::ControlReply& reply) {
  const std::string command = command_name(request);
  if (request.boot_id() != 0 && request.boot_id() != options.boot_id) {
    refuse(v1::OTHER_BOOT,
           InputError(command, "it was meant for a kolskyd that ended; another runs since",
                      "look at its status, then ask again"),
           reply);
    return false;
  }
  const std::lock_guard lock(lease_mutex);
  const auto now = Lease::Clock::now();
  if (commands_under_way > 0) {
    // A holder that waits for its own command is not silent.
    lease.heard_from(lease.holder(now), now);
  }
  if (lease.take(request.client_id(), now)) {
    return true;
  }
  refuse(v1::LEASE_HELD,
         InputError(command, lease.holder(now) + " is the operator",
                    "wait until that client releases the lease or has been silent for " +
                        std::to_string(options.lease.count() / 1000) + " s"),
         reply);
  return false;
}

void ControlServer::State::start(const v1::ControlRequest& request, const RequestKey& key) {
  if (request.has_status() || request.has_snapshot()) {
    return conclude(run(request, key));
  }
  const bool command = wire::changes_state(request);
  Worker& worker = command ? command_worker : reading_worker;
  if (!worker.post([this, request, key] { hand_back(run(request, key)); })) {
    Outcome outcome{key, command, false, {}};
    refuse(v1::BUSY,
           InputError(command_name(request), "too many requests wait", "ask again in a moment"),
           outcome.reply);
    return conclude(std::move(outcome));
  }
  commands_under_way += command ? 1 : 0;
}

/// In whichever thread the request is carried out.
Outcome ControlServer::State::run(const v1::ControlRequest& request, const RequestKey& key) {
  Outcome outcome{key, wire::changes_state(request), request.has_release(), {}};
  if (stopping) {
    refuse(v1::STOPPING,
           InputError(command_name(request), "kolskyd is ending", "ask again once it runs"),
           outcome.reply);
  } else {
    carry_out(request, handler, outcome.reply);
  }
  return outcome;
}

void ControlServer::State::hand_back(Outcome outcome) {
  {
    const std::lock_guard lock(outbox_mutex);
    outbox.push_back(std::move(outcome));
  }
  wake.ring();
}

void ControlServer::State::send_outcomes() {
  std::vector<Outcome> ready;
  {
    const std::lock_guard lock(outbox_mutex);
    ready.swap(outbox);
  }
  for (Outcome& outcome : ready) {
    if (outcome.command) {
      --commands_under_way;
      const std::lock_guard lock(lease_mutex);
      lease.heard_from(outcome.key.client_id, Lease::Clock::now());
      if (outcome.release) {
        lease.release(outcome.key.client_id);
      }
    }
    conclude(std::move(outcome));
  }
}

/// Answers everyone who asked: the first plainly, the others as repeated.
void ControlServer::State::conclude(Outcome outcome) {
  outcome.reply.set_request_id(outcome.key.request_id);
  const std::string bytes = seal(outcome.reply);
  const std::vector<Route> waiting = memory(outcome.command).finish(outcome.key, bytes);
  for (std::size_t i = 0; i < waiting.size(); ++i) {
    if (i == 0) {
      send(waiting[i], bytes);
    } else {
      outcome.reply.set_repeated_request(true);
      send(waiting[i], seal(outcome.reply));
    }
  }
}

std::string ControlServer::State::seal(v1::ControlReply& reply) {
  reply.set_schema_version(wire::kSchemaVersion);
  reply.set_boot_id(options.boot_id);
  if (reply.has_status()) {
    reply.mutable_status()->set_boot_id(options.boot_id);
    reply.mutable_status()->set_operator_id(operator_id());
  }
  return wire::serialise(reply);
}

/// A peer that is gone or does not read is skipped.
void ControlServer::State::send(const Route& to, const std::string& reply) {
  for (const std::string& frame : to) {
    static_cast<void>(
        socket.send(zmq::buffer(frame), zmq::send_flags::sndmore | zmq::send_flags::dontwait));
  }
  static_cast<void>(socket.send(zmq::buffer(reply), zmq::send_flags::dontwait));
}

std::string ControlServer::State::operator_id() const {
  const std::lock_guard lock(lease_mutex);
  return lease.holder(Lease::Clock::now());
}

ControlServer::ControlServer(const ControlServerOptions& options, ControlHandler& handler)
    : state_(std::make_unique<State>(options, handler)) {}
ControlServer::~ControlServer() = default;

const std::string& ControlServer::endpoint() const noexcept {
  return state_->endpoint;
}
std::string ControlServer::operator_id() const {
  return state_->operator_id();
}

}  // namespace kolsky
