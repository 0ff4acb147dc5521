#include <gtest/gtest.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include "daemon/publish/publisher.hpp"
#include "kolsky/v1/kolsky.pb.h"
#include "proto/codec.hpp"
#include "tests/scratch_folder.hpp"

namespace kolsky {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPython = "/usr/bin/python3";

bool run(const std::string& command) {
  return std::system(command.c_str()) == 0;
}

/// The first Python program of a page.
std::string example_of(const fs::path& page) {
  std::ifstream file(page);
  const std::string text(std::istreambuf_iterator<char>(file), {});
  const std::string fence = "```python\n";
  const std::size_t start = text.find(fence);
  return start == std::string::npos
             ? ""
             : text.substr(start + fence.size(),
                           text.find("```", start + 3) - start - fence.size());
}

TEST(PythonExample, OfTheDocumentationPrintsTheResults) {
  if (!run(std::string(kPython) + " -c 'import zmq, google.protobuf' 2>/dev/null")) {
    GTEST_SKIP() << "needs python3-zmq and python3-protobuf";
  }
  const testing::ScratchFolder folder;
  const std::string example = example_of(fs::path(KOLSKY_SOURCE_DIR) / "docs/wire.md");
  ASSERT_FALSE(example.empty());
  std::ofstream(folder.path() / "example.py") << example;
  ASSERT_TRUE(run(std::string(KOLSKY_PROTOC) + " -I '" + KOLSKY_SOURCE_DIR +
                  "/proto' --python_out '" + folder.path().string() + "' kolsky/v1/kolsky.proto"));

  PublisherOptions options;
  options.results_endpoint = "tcp://127.0.0.1:*";
  options.preview_endpoint = "tcp://127.0.0.1:*";
  Publisher publisher(options);
  std::atomic<bool> enough = false;
  std::thread daemon([&] {
    Reduction good;
    for (auto* values :
         {&good.time_s, &good.stress_Pa, &good.strain, &good.strain_rate_per_s, &good.force_front_N,
          &good.force_back_N, &good.incident, &good.reflected, &good.transmitted}) {
      *values = {1e6, 123.4e6, -5e6};
    }
    good.quality.reducible = true;
    Reduction bad;
    bad.quality.reason = "3 samples are missing";
    v1::Result message;
    while (!enough) {
      wire::encode(good, "one", message);
      publisher.publish_result(message);
      wire::encode(bad, "two", message);
      publisher.publish_result(message);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
  // Ends with the pipe to `head`.
  const std::string command = "cd '" + folder.path().string() + "' && timeout 20 " + kPython +
                              " example.py " + publisher.results_endpoint() +
                              " 2>/dev/null | head -n 4 | sort -u";
  FILE* output = popen(command.c_str(), "r");
  ASSERT_NE(output, nullptr);
  std::string printed;
  for (int c = std::fgetc(output); c != EOF; c = std::fgetc(output)) {
    printed += static_cast<char>(c);
  }
  pclose(output);
  enough = true;
  daemon.join();
  EXPECT_EQ(printed, "one 123.4 MPa\ntwo not reducible: 3 samples are missing\n");
}

}  // namespace
}  // namespace kolsky
