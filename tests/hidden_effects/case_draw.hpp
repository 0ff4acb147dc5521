#pragma once

#include "tests/hidden_effects/case.hpp"

namespace kolsky::scoring {

/// How many of each kind; benches are drawn anew for every few cases.
struct Plan {
  std::uint64_t seed = 1;
  int benches = 4;
  int nulls_per_bench = 1;
  int singles_per_bench = 6;
  int tied_per_bench = 1;
  int doubles_per_bench = 1;
  int absorbed_per_bench = 1;
  int withheld_per_bench = 1;
  bool split = false;           ///< split bars
  bool low_loss = false;        ///< with solids between them that relax little
  bool soft = false;            ///< with rubbers between them
  bool quick = false;           ///< short records on few gauges, white noise
  double least_multiple = 1.0;  ///< of its smallest identifiable size, that a single is planted at
  bool truth_anew = true;       ///< every case its own draw of what is off within what is filed
  std::vector<double> measured_noise{};
};

/// All cases of one bench, drawn from the plan's seed and the bench's number.
[[nodiscard]] std::vector<Case> draw_cases(const Plan& plan, int bench);

}  // namespace kolsky::scoring
