#include "processing/criticism/fitting/known_departures.hpp"

#include <algorithm>

namespace kolsky {

const std::vector<Complex>* KnownDepartures::find(std::size_t shot,
                                                  std::span<const AppliedEffect> on_waves,
                                                  std::span<const Complex> source) const {
  for (const Departure& known : shots_[shot].last) {
    if (std::ranges::equal(known.on_waves, on_waves) && std::ranges::equal(known.source, source)) {
      return &known.q;
    }
  }
  return nullptr;
}

void KnownDepartures::keep(std::size_t shot, std::span<const AppliedEffect> on_waves,
                           std::span<const Complex> source, std::span<const Complex> q) {
  OfShot& known = shots_[shot];
  if (known.last.size() < kKept) {
    known.oldest = known.last.size();
    known.last.emplace_back();
  }
  Departure& departure = known.last[known.oldest];
  departure.on_waves.assign(on_waves.begin(), on_waves.end());
  departure.source.assign(source.begin(), source.end());
  departure.q.assign(q.begin(), q.end());
  known.oldest = (known.oldest + 1) % kKept;
}

}  // namespace kolsky
