#include <gtest/gtest.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "daemon/daemon.hpp"
#include "drivers/files/captures/capture.hpp"
#include "drivers/files/store/store.hpp"
#include "tests/end_to_end/daemon_process.hpp"
#include "tests/end_to_end/scene.hpp"
#include "tests/scratch_folder.hpp"

namespace kolsky {
namespace {

using scene::DaemonProcess;
using scene::eventually;
using scene::Installation;
using scene::kolskyd;
using scene::Lab;
using scene::Listener;
using scene::Process;
using std::chrono::milliseconds;

constexpr milliseconds kPatience{15'000};

struct Ended {
  int code = -1;
  std::string output;
};

Ended run(const std::vector<std::string>& arguments) {
  const testing::ScratchFolder folder;
  Process process(kolskyd(arguments), folder / "output");
  const std::optional<int> code = process.wait(kPatience);
  return {code.value_or(-1), process.output()};
}

/// Exit code 2 and one line of the daemon's, which names all of these.
::testing::AssertionResult refused(const Ended& ended, const std::vector<std::string>& named) {
  if (ended.code != 2) {
    return ::testing::AssertionFailure() << "exit code " << ended.code << "\n" << ended.output;
  }
  if (ended.output.find("kolskyd: ") != 0 ||
      std::count(ended.output.begin(), ended.output.end(), '\n') != 1) {
    return ::testing::AssertionFailure() << "not one line: " << ended.output;
  }
  for (const std::string& part : named) {
    if (ended.output.find(part) == std::string::npos) {
      return ::testing::AssertionFailure() << "no '" << part << "' in: " << ended.output;
    }
  }
  return ::testing::AssertionSuccess();
}

constexpr const char* kNowhere = "ip:127.0.0.1:1";

TEST(Program, TellsWhatItTakes) {
  const Ended help = run({"--help"});
  EXPECT_EQ(help.code, 0);
  EXPECT_NE(help.output.find("--config"), std::string::npos);
  EXPECT_NE(help.output.find("replay:"), std::string::npos);
  EXPECT_EQ(run({"--version"}).output, "kolskyd " KOLSKY_VERSION "\n");
}

TEST(Program, RefusesBadArguments) {
  EXPECT_TRUE(refused(run({}), {"--config"}));
  EXPECT_TRUE(refused(run({"--konfig", "a.toml"}), {}));
  EXPECT_TRUE(refused(run({"--config", "/nowhere/kolskyd.toml"}), {"/nowhere/kolskyd.toml"}));
}

TEST(Program, RefusesBadSettings) {
  const Lab lab;
  {
    Installation unknown(lab.uri(), lab.bench());
    unknown.set("trigger", "levl_sigma = 8");
    EXPECT_TRUE(refused(run({"--config", unknown.write()}),
                        {"kolskyd.toml:", "levl_sigma", "level_sigma"}));
  }
  {
    const Installation bench(lab.uri(), lab.bench());
    std::filesystem::remove(bench.folder() / "bench.toml");
    EXPECT_TRUE(refused(run({"--config", bench.write()}), {"bench.toml"}));
  }
  {
    Installation channel(lab.uri(), lab.bench());
    channel.set("digitiser", "channels = [\"voltage0\", \"voltage9\"]");
    EXPECT_TRUE(refused(run({"--config", channel.write()}), {lab.uri(), "voltage9"}));
  }
  {
    const Installation gone(kNowhere, lab.bench());
    EXPECT_TRUE(refused(run({"--config", gone.write()}), {kNowhere}));
  }
  {
    const Installation nothing("replay:nothing-here", lab.bench());
    EXPECT_TRUE(refused(run({"--config", nothing.write()}), {"nothing-here"}));
  }
  {
    Installation folder(lab.uri(), lab.bench());
    folder.folder().write("store", "a file, not a folder");
    EXPECT_TRUE(refused(run({"--config", folder.write()}), {"store"}));
  }
  {
    std::string slow = lab.bench();
    slow.replace(slow.find("1000000"), 7, "1234567");
    const Installation rate(lab.uri(), slow);
    EXPECT_TRUE(refused(run({"--config", rate.write()}), {"1234567"}));
  }
}

// Said before a shot is fired, not of each one afterwards.
TEST(Program, RefusesBarsOfWhichNoModuliAreKnown) {
  const Lab lab;
  std::string bench = lab.bench();
  const std::string key = "density_kg_m3 = ";
  for (std::size_t at = bench.find(key); at < bench.find("[specimen]"); at = bench.find(key, at)) {
    at += key.size();
    bench.replace(at, bench.find('\n', at) - at, "1290.0");
  }
  ASSERT_EQ(bench.find("youngs_modulus_Pa"), std::string::npos) << bench;
  const Installation dense(lab.uri(), bench);
  for (const std::vector<std::string>& asked :
       {std::vector<std::string>{}, std::vector<std::string>{"--check"}}) {
    std::vector<std::string> words{"--config", dense.write(), "--quiet"};
    words.insert(words.end(), asked.begin(), asked.end());
    EXPECT_TRUE(refused(run(words), {"bench.toml", "bars.input.youngs_modulus_Pa", "1290 kg/m3",
                                     "9 % denser", "bar model"}));
  }
}

// libiio has lines of its own for these, in front of the refusal.
TEST(Program, RefusesADigitiserThatIsNotThereInOneLine) {
  const Lab lab;
  for (const std::string uri : {kNowhere, "ip:no-such-host.invalid"}) {
    const Installation gone(uri, lab.bench());
    const Ended ended = run({"--config", gone.write(), "--quiet"});
    EXPECT_TRUE(refused(ended, {uri}));
    EXPECT_EQ(std::count(ended.output.begin(), ended.output.end(), '\n'), 1) << ended.output;
  }
}

TEST(Program, ChecksTheModelAsWell) {
  const Lab lab;
  Installation installation(kNowhere, lab.bench());
  installation.set("model", "file = \"none.toml\"");
  EXPECT_TRUE(refused(run({"--config", installation.write(), "--check"}), {"none.toml"}));
}

TEST(Program, RefusesAPortInUse) {
  const Lab lab;
  const Installation first(lab.uri(), lab.bench());
  first.write();
  const DaemonProcess daemon(first);
  const EndpointConfig& taken = daemon.endpoints();
  for (const auto& [key, endpoint] : std::vector<std::pair<std::string, std::string>>{
           {"results", taken.results}, {"preview", taken.preview}, {"control", taken.control}}) {
    const Lab other;
    const Installation second(other.uri(), other.bench());
    std::string text;
    {
      std::ifstream file(second.write());
      text.assign(std::istreambuf_iterator<char>(file), {});
    }
    const std::string line = key + " = \"tcp://127.0.0.1:*\"";
    text.replace(text.find(line), line.size(), key + " = \"" + endpoint + "\"");
    second.folder().write("kolskyd.toml", text);
    EXPECT_TRUE(refused(run({"--config", second.folder() / "kolskyd.toml", "--quiet"}),
                        {"endpoints." + key, endpoint}));
  }
}

TEST(Program, ChecksWithoutOpeningAnything) {
  const Lab lab;
  const Installation installation(kNowhere, lab.bench());
  const Ended checked = run({"--config", installation.write(), "--check"});
  EXPECT_EQ(checked.code, 0) << checked.output;
  EXPECT_NE(checked.output.find(kNowhere), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(installation.store()));
}

TEST(Program, EndsWithTheReplayWhereAskedTo) {
  const Lab lab({.period_s = 0.2});
  Installation live(lab.uri(), lab.bench());
  live.set("", "auto_arm = true");
  {
    Process daemon(kolskyd({"--config", live.write()}), live.folder() / "output");
    ASSERT_TRUE(eventually([&] {
      std::error_code none;
      const auto files = std::filesystem::directory_iterator(live.store() / "shots", none);
      return !none && std::distance(begin(files), end(files)) >= 3;
    })) << daemon.output();
    daemon.signal(SIGINT);
    EXPECT_EQ(daemon.wait(kPatience), 0) << daemon.output();
  }
  const std::size_t shots = captures_in(live.store() / "shots").size();
  const Installation again("replay:" + (live.store() / "shots").string(), lab.bench());
  const Ended ended = run({"--config", again.write(), "--exit-at-end"});
  EXPECT_EQ(ended.code, 0) << ended.output;
  EXPECT_EQ(captures_in(again.store() / "shots").size(), shots);
  EXPECT_EQ(ended.output.find("reads otherwise"), std::string::npos) << ended.output;
  EXPECT_EQ(ended.output.find("no shot came"), std::string::npos) << ended.output;
  EXPECT_TRUE(refused(run({"--config", live.write(), "--exit-at-end"}), {"--exit-at-end"}));
}

TEST(Program, NamesWhatAReplayDoesNotGive) {
  const Lab lab;
  Installation live(lab.uri(), lab.bench());
  {
    Daemon daemon(live.read());
    daemon.start();
    Listener listener(daemon.endpoints());
    listener.arm();
    listener.control().fire();
    ASSERT_TRUE(listener.next("result"));
  }
  Shot quiet = read_capture(captures_in(live.store() / "shots").front());
  quiet.trigger.reset();
  for (ChannelRecord& channel : quiet.channels) {
    channel.codes.resize(200);
  }
  const std::filesystem::path folder = live.folder() / "quiet";
  std::filesystem::create_directory(folder);
  write_capture(quiet, folder / "quiet.h5");
  const Installation again("replay:" + folder.string(), lab.bench() + "# another\n");
  const Ended ended = run({"--config", again.write(), "--exit-at-end"});
  EXPECT_EQ(ended.code, 0) << ended.output;
  EXPECT_NE(ended.output.find("1 of 1 captures were filed with a bench file that reads otherwise"),
            std::string::npos)
      << ended.output;
  EXPECT_NE(ended.output.find("no shot came of 1 of 1 captures, " + quiet.id), std::string::npos)
      << ended.output;
}

/// What the service manager hears.
class Manager {
 public:
  explicit Manager(const std::filesystem::path& path) : path_(path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.string().copy(address.sun_path, sizeof(address.sun_path) - 1);
    socket_ = ::socket(AF_UNIX, SOCK_DGRAM, 0);
    EXPECT_EQ(::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  }
  ~Manager() { ::close(socket_); }
  [[nodiscard]] std::string variable() const { return "NOTIFY_SOCKET=" + path_.string(); }
  /// Everything heard since the last call.
  [[nodiscard]] std::vector<std::string> heard() {
    char text[64];
    for (;;) {
      const ssize_t size = ::recv(socket_, text, sizeof(text), MSG_DONTWAIT);
      if (size <= 0) {
        return all_;
      }
      all_.emplace_back(text, static_cast<std::size_t>(size));
    }
  }

 private:
  std::filesystem::path path_;
  int socket_ = -1;
  std::vector<std::string> all_;
};

TEST(Program, TellsTheServiceManager) {
  const Lab lab;
  const Installation installation(lab.uri(), lab.bench());
  Manager manager(installation.folder() / "notify");
  Process daemon(kolskyd({"--config", installation.write()}), installation.folder() / "output",
                 {manager.variable(), "WATCHDOG_USEC=400000"});
  const auto times = [&](const std::string& what) {
    const std::vector<std::string> heard = manager.heard();
    return std::count(heard.begin(), heard.end(), what);
  };
  ASSERT_TRUE(eventually([&] { return times("WATCHDOG=1") >= 3; })) << daemon.output();
  EXPECT_EQ(times("READY=1"), 1);
  daemon.signal(SIGTERM);
  EXPECT_EQ(daemon.wait(kPatience), 0) << daemon.output();
  EXPECT_EQ(times("STOPPING=1"), 1);
}

TEST(Program, EndsWhenAClientAsksForIt) {
  const Lab lab;
  const Installation installation(lab.uri(), lab.bench());
  installation.write();
  DaemonProcess daemon(installation);
  Listener& listener = daemon.listener();
  listener.control().stop();
  EXPECT_EQ(daemon.process().wait(kPatience), 0) << daemon.process().output();
  EXPECT_EQ(daemon.process().output().find("ERROR:"), std::string::npos)
      << "libiio's own lines at an ordinary end: " << daemon.process().output();
}

TEST(Program, SurvivesADigitiserThatGoes) {
  Lab lab;
  const Installation installation(lab.uri(), lab.bench());
  installation.write();
  DaemonProcess daemon(installation);
  Listener& listener = daemon.listener();
  listener.arm();
  lab.stop();
  EXPECT_TRUE(eventually([&] { return listener.control().status().state() == v1::DISCONNECTED; }));
  daemon.process().signal(SIGTERM);
  EXPECT_EQ(daemon.process().wait(kPatience), 0) << daemon.process().output();
}

TEST(Program, RecoversWhatItHadJournaledWhenItIsKilled) {
  const Lab lab;
  const Installation installation(lab.uri(), lab.bench());
  std::string id;
  {
    installation.write();
    DaemonProcess daemon(installation);
    Listener& listener = daemon.listener();
    listener.arm();
    listener.control().fire();
    // The shot is announced once it is journaled; its capture is not written yet, or just being.
    const auto shot = listener.next_message<v1::Shot>("shot");
    daemon.process().signal(SIGKILL);
    EXPECT_EQ(daemon.process().wait(kPatience), 128 + SIGKILL);
    ASSERT_TRUE(shot);
    id = shot->id();
  }
  installation.write();
  DaemonProcess daemon(installation);
  Listener& listener = daemon.listener();
  const v1::ShotList list = listener.control().list_shots();
  ASSERT_EQ(list.shots_size(), 1);
  EXPECT_EQ(list.shots(0).id(), id);
  EXPECT_TRUE(list.shots(0).reducible());
  daemon.process().signal(SIGTERM);
  EXPECT_EQ(daemon.process().wait(kPatience), 0);
  EXPECT_TRUE(verify_store({installation.store()}).problems.empty());
}

}  // namespace
}  // namespace kolsky
