#include "clients/cli/outputs.hpp"

#include "drivers/files/captures/new_file.hpp"
#include "drivers/files/models/model_file.hpp"

namespace kolsky::cli {
namespace {

void require(const std::optional<std::string>& path, const char* beginning) {
  if (path) {
    require_replaceable(*path, beginning);
  }
}

}  // namespace

void require_new_output(const std::optional<std::string>& path) {
  if (path) {
    const NewFile dropped(*path);
  }
}

void require_model_output(const std::optional<std::string>& path) {
  require(path, "kolsky_model");
  if (path && std::filesystem::exists(*path)) {
    static_cast<void>(read_model(*path));  // its history may be one to keep
  }
}

void require_page_output(const std::optional<std::string>& path) {
  require(path, "<!DOCTYPE html>");
}

void require_picture_output(const std::optional<std::string>& path) {
  require(path, "<svg ");
}

void write_output(const std::filesystem::path& path, const std::string& text) {
  constexpr mode_t kReadableByAll = 0644;
  NewFile file(path);
  file.write(text);
  file.publish(kReadableByAll);
}

}  // namespace kolsky::cli
