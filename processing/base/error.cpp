#include "processing/base/error.hpp"

#include <utility>

namespace kolsky {

InputError::InputError(std::string place, std::string what, std::string mend)
    : std::runtime_error(place + ": " + what + "; " + mend),
      place_(std::move(place)),
      problem_(std::move(what)),
      mend_(std::move(mend)) {}

InputError InputError::inside(const std::string& outer_place) const {
  return {outer_place + ": " + place_, problem_, mend_};
}

}  // namespace kolsky
