#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "processing/criticism/fitting/source_waves.hpp"

namespace kolsky {

/// Shots that have not been fired: the waves of those that have, perhaps changed, on a bench that
/// may be another. `shots[n].strain` holds nothing until foretell().
struct FutureShots {
  Campaign campaign;
  SourceWaves waves;
};

/// One thing that can be changed about an experiment.
struct Change {
  std::string text;  ///< what to do at the bench
  std::function<void(FutureShots&)> make;
};

/// The changes that can be reckoned with on such a bench.
[[nodiscard]] std::vector<Change> changes_for(const Campaign& campaign);

/// Fills the records with what a model foretells. Noise as the measured shots have it is in them
/// before the pulses alone, where it is measured: what is fitted then stands apart by what the
/// models do, not by what noise adds. Effects that make a specimen's answer nonlinear are left out
/// of the records (their share in the waves is small): whoever asks what such an effect would show
/// takes its derivatives.
/// @param measured  whose noise it is
void foretell(FutureShots& future, const Model& model, const Campaign& measured,
              std::uint64_t seed);

}  // namespace kolsky
