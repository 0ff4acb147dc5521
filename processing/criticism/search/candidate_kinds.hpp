#pragma once

#include "processing/criticism/search/candidates.hpp"

namespace kolsky {

/// A hum of the mains at a multiple of their frequency, which is none that mains have anywhere.
[[nodiscard]] bool is_harmonic(const EffectUse& use);

/// The same hum but for its frequency, neither a harmonic.
[[nodiscard]] bool is_other_mains(const Candidate& one, const Candidate& other);

/// Two sensor effects of one gauge.
[[nodiscard]] bool at_one_gauge(const Candidate& a, const Candidate& b);

/// There or not, without a strength.
[[nodiscard]] bool is_switch(const Candidate& candidate);

/// Where it is small it does nothing.
[[nodiscard]] bool is_sudden(const Candidate& candidate);

/// What shots have of their own in the records, alike at all gauges or at one: as many numbers at
/// every gauge would be judged by their products.
[[nodiscard]] bool may_be_slow_noise(const Candidate& candidate);

/// A hum in shares of each gauge's own, which is judged by its products.
[[nodiscard]] bool has_shares(const Candidate& candidate);

/// Effects of the material take each other's places at a finite size: what a dashpot does, the
/// material's own branch and a further one can do together.
[[nodiscard]] bool of_material(const Candidate& candidate);

}  // namespace kolsky
