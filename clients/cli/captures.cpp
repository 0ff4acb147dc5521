#include "clients/cli/captures.hpp"

#include <algorithm>

#include "drivers/files/captures/capture.hpp"
namespace kolsky::cli {

namespace {

// Noiseless records of two shots may agree; of one time they are one shot.
bool same_shot(const Shot& one, const Shot& other) {
  return one.utc_ns == other.utc_ns &&
         std::equal(
             one.channels.begin(), one.channels.end(), other.channels.begin(), other.channels.end(),
             [](const ChannelRecord& a, const ChannelRecord& b) { return a.codes == b.codes; });
}

}  // namespace

std::vector<Shot> captured_shots(const std::vector<std::string>& places) {
  std::vector<Shot> shots;
  for (const std::string& place : places) {
    for (const auto& path : captures_in(place)) {
      Shot shot = read_capture(path);
      shot.id = path.string();
      const auto twin = std::find_if(shots.begin(), shots.end(),
                                     [&](const Shot& other) { return same_shot(shot, other); });
      if (twin != shots.end()) {
        throw InputError(shot.id, "holds the same shot as " + twin->id, "give each shot once");
      }
      shots.push_back(std::move(shot));
    }
  }
  return shots;
}

InputError in_captures(const InputError& error, const std::vector<std::string>& places) {
  if (places.empty() || error.place().starts_with("capture ")) {
    return error;
  }
  const std::size_t others = places.size() - 1;
  return error.inside(places.front() +
                      (others == 0 ? "" : " and " + std::to_string(others) + " more"));
}

}  // namespace kolsky::cli
