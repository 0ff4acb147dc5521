#pragma once

#include <span>
#include <string>
#include <vector>

#include "processing/identification/bar_records.hpp"

namespace kolsky {

/// A filed number of the bench with a standard deviation: it may be off by about that much, and a
/// fit may move it.
struct KnownUnknown {
  enum class Of { gain, position, delay, length, density, diameter, poisson_ratio };
  std::string name;  ///< as the effect that would name it: "gauge-position:g3"
  Of of = Of::gain;
  std::size_t gauge = 0;  ///< for gain, position and delay: its place in BarRecords
  double sd = 0.0;        ///< metres for position and length, seconds for delay, else relative
};

/// Those of a bench of kind "bar". Gains combine gauge factor, excitation and amplifier; that of a
/// gauge which stands for two does not matter.
[[nodiscard]] std::vector<KnownUnknown> known_unknowns(const Bench& bench,
                                                       const BarRecords& records);

/// The bench with its known unknowns moved.
struct MovedBench {
  Bar bar;
  std::vector<double> position_m;
  std::vector<double> gain;     ///< reading = gain x strain
  std::vector<double> delay_s;  ///< beyond the filed delay, which the records no longer have

  /// @param moves  one per known unknown, in its standard deviations
  MovedBench(const Bar& filed, const BarRecords& records, const std::vector<KnownUnknown>& unknowns,
             std::span<const double> moves);
};

}  // namespace kolsky
