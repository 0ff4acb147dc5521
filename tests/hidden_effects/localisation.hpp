#pragma once

#include <set>

#include "tests/hidden_effects/analyser.hpp"
#include "tests/hidden_effects/failing_places.hpp"

namespace kolsky::scoring {

/// What was marked of what fails, in numbers of places.
struct Hits {
  std::size_t failing = 0;
  std::size_t marked = 0;
  std::size_t both = 0;

  Hits& operator+=(const Hits& other);
  [[nodiscard]] double precision() const;
  [[nodiscard]] double recall() const;
  /// Harmonic mean of precision and recall: 2 both / (failing + marked); 1 where nothing fails and
  /// nothing is marked.
  [[nodiscard]] double f1() const;
};

/// A case's failing places against those that `compare` marks.
struct Localisation {
  Hits all;
  Hits touched;  ///< of gauges whose records the effect changes
  /// What a test of each place alone would mark on average, were noise known exactly, at the false
  /// discovery that `compare` holds: how well places of this size can be told at all.
  double ideal_marked = 0.0;
  double ideal_both = 0.0;

  Localisation& operator+=(const Localisation& other);
  [[nodiscard]] double ideal_f1() const;
};

[[nodiscard]] nlohmann::json json_of(const Localisation& places);

/// What `compare --json` divides records into. @throws nlohmann::json::exception
[[nodiscard]] Places places_of(const nlohmann::json& compared);
/// What it marks.
[[nodiscard]] std::set<Place> marked_by(const nlohmann::json& compared);

[[nodiscard]] Localisation localisation(const std::vector<PlaceTruth>& truth,
                                        const std::set<Place>& marked);

}  // namespace kolsky::scoring
