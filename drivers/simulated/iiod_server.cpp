#include "drivers/simulated/iiod_server.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <iterator>
#include <list>
#include <mutex>
#include <system_error>
#include <thread>

#include "drivers/simulated/connection.hpp"
#include "drivers/simulated/number_text.hpp"
#include "drivers/simulated/session.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

constexpr std::size_t kMostClients = 64;
constexpr int kBacklog = 128;
constexpr std::chrono::milliseconds kWhenOutOfFiles{10};

sockaddr_in parse_address(const std::string& listen) {
  const std::size_t colon = listen.rfind(':');
  sockaddr_in address{};
  address.sin_family = AF_INET;
  const auto port = colon == std::string::npos
                        ? std::nullopt
                        : parse_number<std::uint16_t>(std::string_view(listen).substr(colon + 1));
  const std::string host = listen.substr(0, std::min(colon, listen.size()));
  if (!port || inet_pton(AF_INET, host.c_str(), &address.sin_addr) != 1) {
    throw InputError(listen, "not an address to listen on",
                     "give ADDRESS:PORT, as 127.0.0.1:30431");
  }
  address.sin_port = htons(*port);
  return address;
}

std::string why(int error) {
  return std::system_category().message(error);
}

int listening_socket(const std::string& listen_on) {
  const sockaddr_in address = parse_address(listen_on);
  const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd < 0) {
    throw std::system_error(errno, std::system_category(), "socket");
  }
  const int on = 1;
  setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      listen(fd, kBacklog) != 0) {
    const int error = errno;
    close(fd);
    throw InputError(listen_on, "cannot listen there: " + why(error),
                     "give a free port of this machine, or port 0");
  }
  return fd;
}

sockaddr_in bound_address(int fd) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size);
  return address;
}

struct Client {
  explicit Client(int connected) : socket(connected) {}
  std::thread thread;
  int socket;  ///< open as long as `over` is false
  bool over = false;
};

}  // namespace

struct IiodServer::State {
  State(int listening, SimulatedAdc& served)
      : fd(listening), address(bound_address(listening)), adc(served) {}
  ~State() {
    close(fd);
    close(stop_fd);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  void accept_clients();
  void accept_client();
  void serve(Client& client);
  void drop_clients(double seconds);
  void forget_gone_clients(bool all);

  int fd;
  int stop_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  sockaddr_in address;
  SimulatedAdc& adc;
  std::thread acceptor;
  std::mutex mutex;           ///< guards the rest
  std::list<Client> clients;  ///< added and removed by the acceptor, and by stop once it has ended
  SimulatedAdc::Clock::time_point closed_until = SimulatedAdc::Clock::time_point::min();
};

void IiodServer::check_address(const std::string& listen) {
  static_cast<void>(parse_address(listen));
}

IiodServer::IiodServer(const std::string& listen, SimulatedAdc& adc)
    : state_(std::make_unique<State>(listening_socket(listen), adc)) {}

IiodServer::~IiodServer() {
  stop();
}

void IiodServer::start() {
  if (!state_->acceptor.joinable()) {
    state_->acceptor = std::thread([state = state_.get()] { state->accept_clients(); });
  }
}

void IiodServer::stop() {
  const std::uint64_t one = 1;
  (void)!write(state_->stop_fd, &one, sizeof one);
  if (state_->acceptor.joinable()) {
    state_->acceptor.join();
  }
  state_->forget_gone_clients(true);
  shutdown(state_->fd, SHUT_RDWR);
}

std::uint16_t IiodServer::port() const noexcept {
  return ntohs(state_->address.sin_port);
}

std::string IiodServer::uri() const {
  char host[INET_ADDRSTRLEN] = {};
  inet_ntop(AF_INET, &state_->address.sin_addr, host, sizeof host);
  return std::string("ip:") + host + ":" + std::to_string(port());
}

void IiodServer::State::accept_clients() {
  for (;;) {
    pollfd watched[2] = {{fd, POLLIN, 0}, {stop_fd, POLLIN, 0}};
    if (poll(watched, 2, -1) < 0 && errno != EINTR) {
      return;
    }
    if (watched[1].revents != 0) {
      return;
    }
    forget_gone_clients(false);
    accept_client();
  }
}

void IiodServer::State::accept_client() {
  const int socket = accept4(fd, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (socket < 0) {
    if (errno == EMFILE || errno == ENFILE) {
      std::this_thread::sleep_for(kWhenOutOfFiles);  // the socket stays ready: do not spin on it
    }
    return;
  }
  const std::lock_guard lock(mutex);
  if (clients.size() >= kMostClients || SimulatedAdc::Clock::now() < closed_until) {
    close(socket);
    return;
  }
  const int on = 1;
  setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  Client& client = clients.emplace_back(socket);
  client.thread = std::thread([this, &client] { serve(client); });
}

void IiodServer::State::serve(Client& client) {
  Connection connection(client.socket, stop_fd);
  {
    Session session(connection, adc, [this](double seconds) { drop_clients(seconds); });
    session.run();
  }
  const std::lock_guard lock(mutex);
  client.over = true;
}

void IiodServer::State::drop_clients(double seconds) {
  const std::lock_guard lock(mutex);
  closed_until = adc.pause_end(seconds);
  for (const Client& client : clients) {
    if (!client.over) {
      shutdown(client.socket, SHUT_RDWR);
    }
  }
}

void IiodServer::State::forget_gone_clients(bool all) {
  std::list<Client> gone;
  {
    const std::lock_guard lock(mutex);
    for (auto client = clients.begin(); client != clients.end();) {
      const auto next = std::next(client);
      if (all || client->over) {
        gone.splice(gone.end(), clients, client);
      }
      client = next;
    }
  }
  for (Client& client : gone) {
    client.thread.join();
  }
}

}  // namespace kolsky
