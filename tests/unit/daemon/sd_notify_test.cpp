#include "daemon/live/sd_notify.hpp"
#include "tests/scratch_folder.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

namespace kolsky {
namespace {

/// A service manager's end of the socket.
class NotifySocket {
 public:
  explicit NotifySocket(const std::string& name) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    name.copy(address.sun_path, sizeof(address.sun_path) - 1);
    if (name.front() == '@') {
      address.sun_path[0] = '\0';
    }
    socket_ = ::socket(AF_UNIX, SOCK_DGRAM, 0);
    const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
    bound_ = ::bind(socket_, reinterpret_cast<const sockaddr*>(&address), length) == 0;
    ::setenv("NOTIFY_SOCKET", name.c_str(), 1);
  }
  ~NotifySocket() {
    ::close(socket_);
    ::unsetenv("NOTIFY_SOCKET");
  }
  [[nodiscard]] bool bound() const { return bound_; }
  [[nodiscard]] std::string receive() const {
    char text[64];
    const ssize_t size = ::recv(socket_, text, sizeof(text), MSG_DONTWAIT);
    return size > 0 ? std::string(text, static_cast<std::size_t>(size)) : "";
  }

 private:
  int socket_ = -1;
  bool bound_ = false;
};

TEST(SdNotify, ReachesAPathAndAnAbstractSocket) {
  const testing::ScratchFolder folder;
  const std::string path = folder / "notify";
  for (const std::string& name : {path, "@kolsky-notify-" + std::to_string(::getpid())}) {
    const NotifySocket manager(name);
    ASSERT_TRUE(manager.bound()) << name;
    sd_notify("READY=1");
    EXPECT_EQ(manager.receive(), "READY=1") << name;
  }
}

TEST(SdNotify, DoesNothingWithoutAManager) {
  ::unsetenv("NOTIFY_SOCKET");
  sd_notify("READY=1");
  ::setenv("NOTIFY_SOCKET", "/nowhere/at/all", 1);
  sd_notify("READY=1");
  ::unsetenv("NOTIFY_SOCKET");
}

TEST(SdNotify, TakesTheIntervalThatIsMeantForThisProcess) {
  ::unsetenv("WATCHDOG_USEC");
  EXPECT_EQ(watchdog_interval_us(), 0U);
  ::setenv("WATCHDOG_USEC", "30000000", 1);
  EXPECT_EQ(watchdog_interval_us(), 30'000'000U);
  ::setenv("WATCHDOG_PID", "1", 1);
  EXPECT_EQ(watchdog_interval_us(), 0U);
  ::setenv("WATCHDOG_PID", std::to_string(::getpid()).c_str(), 1);
  EXPECT_EQ(watchdog_interval_us(), 30'000'000U);
  ::unsetenv("WATCHDOG_PID");
  ::unsetenv("WATCHDOG_USEC");
}

}  // namespace
}  // namespace kolsky
