#include "daemon/daemon.hpp"

#include <chrono>
#include <optional>

#include "daemon/controller.hpp"
#include "daemon/live/monitor.hpp"
#include "daemon/log.hpp"
#include "daemon/publish/control_server.hpp"
#include "daemon/station.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

ControlServerOptions server_options(const Station& station, std::uint64_t boot_id) {
  ControlServerOptions options;
  options.endpoint = station.endpoints().control;
  options.boot_id = boot_id;
  return options;
}

}  // namespace

struct Daemon::Parts {
  explicit Parts(const DaemonConfig& config)
      : station(config),
        controller(station),
        monitor(station, controller, config.auto_arm && !station.stream().ends) {
    server.emplace(server_options(station, station.publisher().boot_id()), controller);
    controller.name_operator([this] { return server->operator_id(); });
  }

  Station station;
  Controller controller;
  Monitor monitor;
  std::optional<ControlServer> server;
};

Daemon::Daemon(const DaemonConfig& config) : parts_(std::make_unique<Parts>(config)) {}

Daemon::~Daemon() {
  stop();
}

void Daemon::start() {
  Station& station = parts_->station;
  if (station.stream().ends) {
    const std::vector<PreflightItem> items = parts_->controller.try_arm();
    if (!passed(items)) {
      throw InputError(station.stream().uri, failures(items), "mend that and start again");
    }
  }
  station.start();
  parts_->monitor.start();
}

void Daemon::stop() {
  parts_->station.stop();
  parts_->monitor.stop();
  if (parts_->server) {
    parts_->controller.publish_status();
    parts_->controller.name_operator({});
    parts_->server.reset();
  }
}

bool Daemon::stop_requested() const {
  return parts_->controller.stop_requested();
}

bool Daemon::finished() const {
  return parts_->station.finished();
}

bool Daemon::real_time() const {
  return parts_->station.acquirer().real_time();
}

EndpointConfig Daemon::endpoints() const {
  return {.results = parts_->station.publisher().results_endpoint(),
          .preview = parts_->station.publisher().preview_endpoint(),
          .control = parts_->server->endpoint()};
}

}  // namespace kolsky
