#pragma once

#include <stdexcept>
#include <string>

namespace kolsky {

/// Input that a person can mend: a file, a setting, a message. One line that names the place, what
/// is wrong there and what would be right; control characters in them are escaped. Programs print
/// it and exit with 2.
class InputError : public std::runtime_error {
 public:
  /// @param place  where it is wrong, from the outside in: "bench.toml: gauges[1].position_m"
  /// @param what   what is wrong there: "0.9 m is past the end of the 0.7 m bar"
  /// @param mend   what would be right: "give the distance from the specimen's end"
  InputError(std::string place, std::string what, std::string mend);

  /// The same error, seen from further out: "capture.h5" before "gauges[1].position_m".
  [[nodiscard]] InputError inside(const std::string& outer_place) const;

  [[nodiscard]] const std::string& place() const noexcept { return place_; }
  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }
  [[nodiscard]] const std::string& mend() const noexcept { return mend_; }

 private:
  std::string place_;
  std::string problem_;
  std::string mend_;
};

}  // namespace kolsky
