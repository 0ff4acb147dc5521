#include "proto/light.hpp"

namespace kolsky::wire {

const char* name_of(v1::Comparison::Light light) {
  switch (light) {
    case v1::Comparison::GREEN:
      return "green";
    case v1::Comparison::AMBER:
      return "amber";
    case v1::Comparison::RED:
      return "red";
    default:
      return "none";
  }
}

}  // namespace kolsky::wire
