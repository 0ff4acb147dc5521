#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "daemon/config.hpp"
#include "drivers/files/models/model_file.hpp"

namespace kolsky {

/// The model that shots are compared with as they come in.
struct ActiveModel {
  std::filesystem::path path;
  std::string sha256;  ///< of the file's text
  ModelFile file;
  LightRule rule;
};

/// @return none where the configuration names no model
/// @throws InputError where the model is of another kind of bench, names gauges that it does not
/// have, or was never fitted
[[nodiscard]] std::shared_ptr<const ActiveModel> read_active_model(const DaemonConfig& config,
                                                                   const Bench& bench);

}  // namespace kolsky
