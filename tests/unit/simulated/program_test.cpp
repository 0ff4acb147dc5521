// kolsky-digitiser as its users run it.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <sstream>

#include "drivers/files/captures/capture.hpp"
#include "drivers/files/settings/bench_file.hpp"
#include "drivers/simulated/scenario.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/unit/simulated/served_ramp.hpp"

namespace kolsky::testing {
namespace {

namespace fs = std::filesystem;

struct Outcome {
  int exit = -1;
  std::string out;
};

/// Runs it to its end. stderr goes to the same text when asked for.
Outcome run(const std::string& arguments, bool with_errors = false) {
  const std::string command = std::string("timeout 20 ") + KOLSKY_DIGITISER + " " + arguments +
                              (with_errors ? " 2>&1" : " 2>/dev/null");
  Outcome outcome;
  FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 4096> buffer{};
  for (std::size_t got = fread(buffer.data(), 1, buffer.size(), pipe); got > 0;
       got = fread(buffer.data(), 1, buffer.size(), pipe)) {
    outcome.out.append(buffer.data(), got);
  }
  outcome.exit = WEXITSTATUS(pclose(pipe));
  return outcome;
}

/// The running program on a free port.
class Digitiser {
 public:
  explicit Digitiser(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {KOLSKY_DIGITISER, "--listen", "127.0.0.1:0"});
    std::vector<char*> argv;
    argv.reserve(arguments.size() + 1);
    for (std::string& argument : arguments) {
      argv.push_back(argument.data());
    }
    argv.push_back(nullptr);
    int out[2];
    EXPECT_EQ(pipe(out), 0);
    child_ = fork();
    if (child_ == 0) {
      dup2(out[1], STDOUT_FILENO);
      dup2(open("/dev/null", O_WRONLY), STDERR_FILENO);
      execv(argv[0], argv.data());
      _exit(127);
    }
    close(out[1]);
    char byte = 0;
    while (::read(out[0], &byte, 1) == 1 && byte != '\n') {
      first_line += byte;
    }
    close(out[0]);
    const std::size_t colon = first_line.rfind(':');
    port = static_cast<std::uint16_t>(std::atoi(first_line.substr(colon + 1).c_str()));
  }
  ~Digitiser() {
    if (child_ > 0) {
      (void)end();
    }
  }
  int end() {
    kill(child_, SIGTERM);
    int status = -1;
    waitpid(child_, &status, 0);
    child_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

  std::string first_line;
  std::uint16_t port = 0;

 private:
  pid_t child_ = -1;
};

class ProgramWithFiles : public ::testing::Test {
 protected:
  std::string file(const std::string& name, const std::string& content) {
    return folder.write(name, content).string();
  }
  testing::ScratchFolder folder;
};

TEST(Program, ListsItsScenarios) {
  const Outcome outcome = run("--list");
  EXPECT_EQ(outcome.exit, 0);
  std::istringstream lines(outcome.out);
  std::vector<std::string> names;
  for (std::string line; std::getline(lines, line);) {
    EXPECT_EQ(std::count(line.begin(), line.end(), '\t'), 1) << line;
    names.push_back(line.substr(0, line.find('\t')));
  }
  EXPECT_EQ(names,
            (std::vector<std::string>{"core", "cover", "core-6mm", "bars-together", "bar", "steel",
                                      "impact", "impact-40", "impact-51", "quiet"}));
}

TEST(Program, PrintsABenchThatFitsItsOptions) {
  const Outcome outcome = run("--print-bench --scenario bar --range-microstrain 1500");
  EXPECT_EQ(outcome.exit, 0);
  const Bench bench = parse_bench(outcome.out, "printed");
  EXPECT_EQ(bench.gauges.size(), 4U);
  EXPECT_DOUBLE_EQ(bench.input.length_m, 2.0);
  EXPECT_DOUBLE_EQ(*bench.gauges[3].strain_per_V * 5.0, 1500e-6);
}

TEST(Program, RefusesBadUsageWithOneLineAnd2) {
  for (const char* arguments : {"--frob",
                                "--scenario nowhere",
                                "--bits 11",
                                "--bits x",
                                "--speed -1",
                                "--period -1",
                                "--period 0.001",
                                "--listen nowhere",
                                "--faults /nowhere/at/all",
                                "--play /nowhere/at/all",
                                "--play /tmp --scenario core",
                                "--play /nowhere --bits 12",
                                "--noise-microstrain -4",
                                "--range-microstrain 0",
                                "--truth /nowhere/at/all.csv",
                                "--scenario bar --truth t.csv",
                                "--seed -1",
                                "core",
                                "--faults /tmp",
                                "--noise-microstrain 1e99",
                                "--offset-microstrain 1e99"}) {
    const Outcome outcome = run(arguments, true);
    EXPECT_EQ(outcome.exit, 2) << arguments;
    const std::size_t at = outcome.out.find("kolsky-digitiser: ");
    ASSERT_NE(at, std::string::npos) << arguments << ": " << outcome.out;
    EXPECT_EQ(
        std::count(outcome.out.begin() + static_cast<std::ptrdiff_t>(at), outcome.out.end(), '\n'),
        1)
        << outcome.out;
  }
}

TEST(Program, RefusesBeforeItComputes) {
  for (const char* arguments : {"--listen nowhere", "--truth /nowhere/at/all.csv"}) {
    const Outcome outcome = run(arguments, true);
    EXPECT_EQ(outcome.exit, 2) << arguments;
    EXPECT_EQ(outcome.out.find("computed"), std::string::npos) << outcome.out;
  }
}

TEST(Program, RefusesASeedInAFewWords) {
  EXPECT_LT(run("--seed -1", true).out.size(), 150U);
}

TEST_F(ProgramWithFiles, RefusesAWrongFaultScriptByItsLine) {
  const std::string script = file("faults", "shot 1 at 5 timeout\nshot 1 at 5 explode\n");
  const Outcome outcome = run("--faults " + script, true);
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_NE(outcome.out.find(script + ":2: "), std::string::npos) << outcome.out;
}

TEST_F(ProgramWithFiles, WritesTheTruthOnceAndOverwritesNothing) {
  const std::string truth = (folder / "truth.csv").string();
  EXPECT_EQ(run("--scenario cover --truth " + truth).exit, 0);
  const auto size = fs::file_size(truth);
  EXPECT_GT(size, 100'000U);
  EXPECT_EQ(run("--scenario cover --truth " + truth).exit, 2);
  EXPECT_EQ(fs::file_size(truth), size);
}

std::vector<Scan> read_scans(RawClient& client, std::size_t count) {
  std::vector<Scan> scans;
  while (scans.size() < count) {
    const std::vector<Scan> block = read_buffer(client, 1000 * sizeof(Scan)).scans();
    if (block.empty()) {
      break;
    }
    scans.insert(scans.end(), block.begin(), block.end());
  }
  return scans;
}

TEST(Program, PlaysThePulseOfItsScenario) {
  Digitiser digitiser({"--scenario", "core", "--speed", "0"});
  EXPECT_EQ(digitiser.first_line, "ip:127.0.0.1:" + std::to_string(digitiser.port));
  RawClient control(digitiser.port);
  EXPECT_EQ(control.attribute("scenario"), "core");
  EXPECT_EQ(control.attribute("INPUT voltage1 label"), "g2");
  const double strain_per_code = std::stod(control.attribute("INPUT voltage0 strain_scale"));
  const double mV_per_code = std::stod(control.attribute("INPUT voltage0 scale"));
  const Bench bench = parse_bench(run("--print-bench --scenario core").out, "printed");
  EXPECT_NEAR(mV_per_code / 1e3 * *bench.gauges[0].strain_per_V / strain_per_code, 1.0, 1e-12);

  RawClient stream(digitiser.port);
  ASSERT_EQ(stream.ask("OPEN iio:device0 1000 00000007"), "0");
  const std::vector<Scan> quiet = read_scans(stream, 20'000);
  double mean = 0.0;
  double square = 0.0;
  for (const Scan& scan : quiet) {
    mean += scan.voltage[0] * strain_per_code / 20'000;
    square += std::pow(scan.voltage[0] * strain_per_code, 2) / 20'000;
  }
  EXPECT_NEAR(mean, 20e-6, 0.2e-6);
  // 4 of noise and a hum of 0.5 in amplitude.
  EXPECT_NEAR(std::sqrt(square - mean * mean), std::hypot(4e-6, 0.5e-6 / std::sqrt(2.0)), 0.1e-6);

  ASSERT_EQ(control.write("fire", "1"), "2");
  const std::vector<Scan> shot = read_scans(stream, 8000);
  const BenchHistory expected = run_shot(find_scenario("core"));
  double worst = 0.0;
  for (std::size_t i = 0; i < 8000; ++i) {
    worst = std::max(worst, std::abs(shot[i].voltage[0] * strain_per_code - 20e-6 -
                                     expected.gauge_strain[0][8 * i]));
    worst = std::max(worst, std::abs(shot[i].voltage[1] * strain_per_code + 20e-6 -
                                     expected.gauge_strain[1][8 * i]));
  }
  EXPECT_LT(worst, 25e-6);  // six sigma of the noise
  EXPECT_EQ(digitiser.end(), 0);
}

TEST_F(ProgramWithFiles, PlaysACaptureCodeByCode) {
  Shot stored;
  stored.id = "20261121T101112-1";
  stored.bench_toml = run("--print-bench --scenario core").out;
  stored.bench = parse_bench(stored.bench_toml, "printed");
  stored.rate = {1'000'000, 1};
  for (int c = 0; c < 2; ++c) {
    ChannelRecord channel;
    channel.gauge = c == 0 ? "g1" : "g2";
    channel.unit = "V";
    channel.scale = 1.5e-4;
    for (int i = 0; i < 3000; ++i) {
      channel.codes.push_back(i < 500 ? (c + 1) * 3 : (i * (c + 3)) % 701);
    }
    stored.channels.push_back(channel);
  }
  const fs::path capture = folder / "shot.h5";
  write_capture(stored, capture);
  Digitiser digitiser({"--play", capture.string(), "--speed", "0"});
  RawClient control(digitiser.port);
  EXPECT_EQ(control.attribute("INPUT voltage0 scale"), "0.15");
  EXPECT_NEAR(std::stod(control.attribute("INPUT voltage0 strain_scale")), 1.5e-4 * 4e-4, 1e-15);
  RawClient stream(digitiser.port);
  ASSERT_EQ(stream.ask("OPEN iio:device0 1000 00000007"), "0");
  read_scans(stream, 1000);
  ASSERT_EQ(control.write("fire", "1"), "2");
  const std::vector<Scan> played = read_scans(stream, 3000);
  for (std::size_t i = 0; i < 3000; ++i) {
    ASSERT_EQ(played[i].voltage[0], stored.channels[0].codes[i]) << i;
    ASSERT_EQ(played[i].voltage[1], stored.channels[1].codes[i]) << i;
  }
  EXPECT_EQ(run("--print-bench --play " + capture.string()).out, stored.bench_toml);
}

TEST(Program, SaysWhereItListensAsJson) {
  Digitiser digitiser({"--json", "--no-counter", "--bits", "24"});
  EXPECT_EQ(digitiser.first_line.front(), '{');
  const std::size_t colon = digitiser.first_line.find("127.0.0.1:");
  ASSERT_NE(colon, std::string::npos) << digitiser.first_line;
  RawClient client(static_cast<std::uint16_t>(std::stoi(digitiser.first_line.substr(colon + 10))));
  const std::string xml_length = client.ask("PRINT");
  const std::string xml = client.receive(std::stoul(xml_length));
  EXPECT_NE(xml.find("le:s24/32&gt;&gt;0"), std::string::npos);
  EXPECT_EQ(xml.find("count0"), std::string::npos);
}

}  // namespace
}  // namespace kolsky::testing
