#pragma once

#include <list>

#include "tests/generators/bar_response.hpp"
#include "tests/generators/bar_world.hpp"

namespace kolsky::testing {

/// What the gauges of a bar read. Responses to the unit source are kept between calls, so that a
/// change of sources or sensors costs no new wave calculation.
class BarForward {
 public:
  [[nodiscard]] Readings readings(const BarWorld& world);
  /// One shot's answer to unit coefficients: response per gauge with everything linear of its
  /// sensor in it, from the first bell's beginning on, at equal steps.
  [[nodiscard]] Responses sensor_responses(const BarWorld& world, const TrueShot& shot);

 private:
  struct Key {
    std::vector<double> numbers;
    bool operator==(const Key&) const = default;
  };
  const Responses& wave_responses(const BarWorld& world, const KelvinChain& chain);
  const Responses& bending_responses(const BarWorld& world, const KelvinChain& chain);
  const Responses& remembered(const Key& key, const std::function<Responses()>& reckon);

  std::list<std::pair<Key, Responses>> known_;
};

}  // namespace kolsky::testing
