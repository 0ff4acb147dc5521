// How long a shot takes from the last sample of its window leaving the digitiser to its result
// being published, stage by stage, on the simulated digitiser at 1 MS/s x 2 through libiio. The
// floor beside each stage is the same work with nothing round it, on this machine, now; that of
// "reduce" is all of it, of which the stage is what the disk left to wait for. The row
// "the machine" is as much work as a usual shot's by itself: what is above its p50 there nobody
// here did.
//
// usage: bench_latency [SHOTS] [FOLDER]   the folder is on the disk that the store would be on
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <thread>
#include <zmq.hpp>

#include "daemon/clock.hpp"
#include "daemon/daemon.hpp"
#include "daemon/thread_priority.hpp"
#include "drivers/files/captures/capture.hpp"
#include "drivers/memory/kept_memory.hpp"
#include "processing/reduction/reducer.hpp"
#include "proto/codec.hpp"
#include "tests/end_to_end/scene.hpp"

namespace {

using namespace kolsky;
using scene::Installation;
using scene::Lab;
using scene::Listener;

constexpr double kBound_ms = 2.0;
constexpr int kFloorRepeats = 200;
constexpr std::chrono::milliseconds kBetweenShots{40};

using Durations = std::vector<double>;  // in ms

double percentile(Durations durations, double share) {
  if (durations.empty()) {
    return 0.0;
  }
  std::sort(durations.begin(), durations.end());
  const auto last = static_cast<double>(durations.size() - 1);
  return durations[static_cast<std::size_t>(std::lround(share * last))];
}

template <typename Work>
double time_once_ms(Work work) {
  const std::int64_t start = monotonic_ns();
  work();
  return static_cast<double>(monotonic_ns() - start) * 1e-6;
}

template <typename Work>
Durations time_ms(int repeats, Work work) {
  Durations durations;
  for (int i = 0; i < repeats; ++i) {
    durations.push_back(time_once_ms(work));
  }
  return durations;
}

Durations floor_copy(const Shot& shot) {
  std::vector<std::int32_t> codes(shot.samples());
  return time_ms(kFloorRepeats, [&] {
    for (const ChannelRecord& channel : shot.channels) {
      std::memcpy(codes.data(), channel.codes.data(), codes.size() * sizeof(codes[0]));
    }
  });
}

struct JournalFloor {
  Durations write;
  Durations durable;
};

/// The codes into a file that has its room already, and fdatasync. As long apart as shots are: a
/// processor that has slept takes longer to hear of the disk than one that has just done so.
JournalFloor floor_journal(const Shot& shot, const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "floor";
  const std::vector<char> bytes(shot.samples() * shot.channels.size() * 2);
  const int file = open(path.c_str(), O_CREAT | O_RDWR, 0644);
  const std::vector<char> room(bytes.size() * kFloorRepeats);
  bool good = write(file, room.data(), room.size()) == static_cast<ssize_t>(room.size()) &&
              fsync(file) == 0;
  off_t end = 0;
  JournalFloor floor;
  for (int i = 0; i < kFloorRepeats; ++i) {
    floor.write.push_back(time_once_ms([&] {
      good = good &&
             pwrite(file, bytes.data(), bytes.size(), end) == static_cast<ssize_t>(bytes.size());
    }));
    floor.durable.push_back(time_once_ms([&] { good = good && fdatasync(file) == 0; }));
    end += static_cast<off_t>(bytes.size());
    std::this_thread::sleep_for(kBetweenShots);
  }
  close(file);
  std::filesystem::remove(path);
  return good ? floor : JournalFloor{};
}

Durations floor_reduce(const Shot& shot) {
  Reducer reducer;
  static_cast<void>(reducer.reduce(shot));
  return time_ms(kFloorRepeats, [&] { static_cast<void>(reducer.reduce(shot)); });
}

Durations floor_encode(const Shot& shot) {
  const Reduction reduction = Reducer().reduce(shot);
  const std::size_t bytes = reduction.time_s.size() * 9 * sizeof(double);
  std::vector<char> from(bytes);
  std::vector<char> to(bytes);
  return time_ms(kFloorRepeats, [&] { std::memcpy(to.data(), from.data(), bytes); });
}

/// One message of the result's size handed to a socket with a subscriber.
Durations floor_publish(const Shot& shot) {
  v1::Result result;
  wire::encode(Reducer().reduce(shot), shot.id, result);
  const std::string payload = result.SerializeAsString();
  zmq::context_t context;
  zmq::socket_t publisher(context, zmq::socket_type::pub);
  zmq::socket_t subscriber(context, zmq::socket_type::sub);
  publisher.bind("tcp://127.0.0.1:*");
  subscriber.set(zmq::sockopt::subscribe, "");
  subscriber.set(zmq::sockopt::rcvtimeo, 1000);
  subscriber.connect(publisher.get(zmq::sockopt::last_endpoint));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  zmq::message_t received;
  Durations durations;
  for (int i = 0; i < kFloorRepeats; ++i) {
    durations.push_back(
        time_once_ms([&] { publisher.send(zmq::buffer(payload), zmq::send_flags::none); }));
    static_cast<void>(subscriber.recv(received));
  }
  return durations;
}

struct Timings {
  std::vector<std::string> stages;  ///< in their order
  std::map<std::string, Durations> stage_ms;
  Durations total_ms;
  Durations to_subscriber_ms;
  v1::Status status;
  int missed = 0;
};

Timings shoot(Listener& listener, int shots) {
  Timings measured;
  for (int i = 0; i < shots; ++i) {
    listener.control().fire();
    const auto received = listener.next("result");
    const std::int64_t now_ns = monotonic_ns();
    if (!received) {
      ++measured.missed;  // the machine stood still for longer than the digitiser's queue holds
      continue;
    }
    v1::Result result;
    result.ParseFromString(received->payload);
    v1::Status status;
    static_cast<void>(scene::eventually([&] {
      status = listener.control().status();
      return status.last_shot_id() == result.shot_id();
    }));
    double total_ms = 0.0;
    for (const v1::StageTiming& timing : status.timings()) {
      const double duration_ms = timing.duration_s() * 1e3;
      if (measured.total_ms.empty()) {
        measured.stages.push_back(timing.stage());
      }
      measured.stage_ms[timing.stage()].push_back(duration_ms);
      total_ms += duration_ms;
    }
    measured.total_ms.push_back(total_ms);
    measured.to_subscriber_ms.push_back(static_cast<double>(now_ns - received->monotonic_ns) *
                                        1e-6);
    // The pulse's echoes and the trigger's hold-off; no two shots meet the preview at the same
    // phase.
    std::this_thread::sleep_for(kBetweenShots + std::chrono::microseconds(1300 * (i % 7)));
  }
  measured.status = listener.control().status();
  return measured;
}

/// How long so much work takes that nobody disturbs but the machine itself: a virtual one's host
/// takes milliseconds at a time. Work that takes `wanted_ms` where nothing is taken away.
Durations undisturbed(double wanted_ms, int count) {
  const auto work = [](std::uint64_t rounds) {
    const std::int64_t from_ns = monotonic_ns();
    volatile std::uint64_t state = 1;
    for (std::uint64_t i = 0; i < rounds; ++i) {
      state = state * 6364136223846793005U + 1U;
    }
    return static_cast<double>(monotonic_ns() - from_ns) * 1e-6;
  };
  constexpr std::uint64_t kTried = 100'000;
  double quickest_ms = work(kTried);
  for (int i = 0; i < 20; ++i) {
    quickest_ms = std::min(quickest_ms, work(kTried));
  }
  const auto rounds = static_cast<std::uint64_t>(wanted_ms / quickest_ms * kTried);
  Durations durations;
  for (int i = 0; i < count; ++i) {
    durations.push_back(work(rounds));
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return durations;
}

void print_row(const std::string& name, const Durations& measured, const Durations* floor) {
  std::printf("%-14s %8.4f %8.4f %8.4f", name.c_str(), percentile(measured, 0.5),
              percentile(measured, 0.99), percentile(measured, 1.0));
  if (floor != nullptr) {
    std::printf("   %8.4f %8.4f", percentile(*floor, 0.5), percentile(*floor, 0.99));
  }
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  keep_freed_memory();  // as kolskyd does
  const int shots = argc > 1 ? std::atoi(argv[1]) : 200;
  if (argc > 2) {
    setenv("TMPDIR", argv[2], 1);
  }
  const Lab lab;
  Installation installation(lab.uri(), lab.bench());
  Daemon daemon(installation.read());
  daemon.start();
  Listener listener(daemon.endpoints());
  listener.arm();
  const Timings measured = shoot(listener, shots);
  daemon.stop();

  const Shot shot = read_capture(captures_in(installation.store() / "shots").front());
  run_in_real_time(RealTime::recording);  // as the recorder does
  const JournalFloor journal = floor_journal(shot, installation.folder().path());
  std::map<std::string, Durations> floors{
      {"copy", floor_copy(shot)},     {"journal", journal.write},
      {"durable", journal.durable},   {"reduce", floor_reduce(shot)},
      {"encode", floor_encode(shot)}, {"publish", floor_publish(shot)}};
  std::printf("%d shots of %zu x %zu samples, %s priority\n", shots, shot.channels.size(),
              shot.samples(), daemon.real_time() ? "real-time" : "ordinary");
  std::printf("%-14s %26s   %17s\n", "", "measured, ms", "floor, ms");
  std::printf("%-14s %8s %8s %8s   %8s %8s\n", "stage", "p50", "p99", "max", "p50", "p99");
  Durations floor_total(kFloorRepeats, 0.0);
  for (const std::string& stage : measured.stages) {
    const auto floor = floors.find(stage);
    print_row(stage, measured.stage_ms.at(stage), floor == floors.end() ? nullptr : &floor->second);
  }
  for (const auto& [stage, floor] : floors) {
    for (std::size_t i = 0; i < floor.size(); ++i) {
      floor_total[i] += floor[i];
    }
  }
  print_row("total", measured.total_ms, &floor_total);
  print_row("to subscriber", measured.to_subscriber_ms, nullptr);
  print_row("(the machine)", undisturbed(percentile(measured.total_ms, 0.5), shots), nullptr);
  const double p99_ms = percentile(measured.total_ms, 0.99);
  std::printf(
      "bound: p99 of total under %.1f ms: %s; shots missed %d, samples missing %llu, overruns "
      "%llu\n",
      kBound_ms, p99_ms < kBound_ms ? "kept" : "MISSED", measured.missed,
      static_cast<unsigned long long>(measured.status.samples_missing()) +
          measured.status.gaps_of_unknown_length(),
      static_cast<unsigned long long>(measured.status.ring_overruns()));
  return p99_ms < kBound_ms ? 0 : 1;
}
