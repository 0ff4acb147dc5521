#include "clients/cli/daemon_shot.hpp"

#include "drivers/files/settings/bench_file.hpp"
#include "kolsky/v1/kolsky.pb.h"
#include "processing/base/error.hpp"
#include "proto/codec.hpp"

namespace kolsky::cli {
namespace {

using std::chrono::milliseconds;

std::string last_shot_id(ControlClient& client) {
  std::string id = client.status().last_shot_id();
  if (!id.empty()) {
    return id;
  }
  const v1::ShotList stored = client.list_shots(1);  // of earlier runs
  if (stored.shots().empty()) {
    throw InputError("last", "the daemon has no shot yet", "arm it and take one");
  }
  return stored.shots(0).id();
}

}  // namespace

ControlClient connect(const std::string& endpoint) {
  ControlClientOptions options;
  options.endpoint = endpoint;
  options.timeout = milliseconds(1000);
  return ControlClient(options);
}

ControlClient connect_patiently(const std::string& endpoint) {
  static_cast<void>(connect(endpoint).status());
  ControlClientOptions options;
  options.endpoint = endpoint;
  options.timeout = milliseconds(10'000);
  return ControlClient(options);
}

ReducedShot fetch_shot(ControlClient& client, const std::string& id) {
  const std::string wanted = id == "last" ? last_shot_id(client) : id;
  const v1::ShotAndResult answer = client.get_shot(wanted);
  if (!answer.has_result()) {
    throw InputError("shot " + wanted, "is not reduced yet", "ask again in a moment");
  }
  ReducedShot reduced;
  reduced.shot = wire::decode(answer.shot());
  reduced.shot.bench = parse_bench(reduced.shot.bench_toml, "bench of shot " + wanted);
  reduced.reduction = wire::decode(answer.result());
  reduced.capture = absolute_name(answer.shot().capture());
  reduced.request = reduced.shot.reduction;
  reduced.default_bar_model = assumes_bar_model(reduced.shot, {});
  return reduced;
}

}  // namespace kolsky::cli
