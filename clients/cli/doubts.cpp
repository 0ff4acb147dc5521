#include "clients/cli/doubts.hpp"

#include "processing/base/error.hpp"

namespace kolsky::cli {

void require_draws(const std::string& command, std::uint64_t draws) {
  constexpr std::uint64_t kFewest = 20;
  constexpr std::uint64_t kMost = 1'000'000;
  if (draws < kFewest || draws > kMost) {
    throw InputError(command + ": --draws", "is outside 20 to 1000000",
                     "200 give the deviations to 5 %, 1000 to 2 %");
  }
}

void require_softening(const std::string& command, double softening_per_K) {
  if (!(softening_per_K >= 0.0 && softening_per_K < 1.0)) {
    throw InputError(command + ": --softening", "is outside 0 to 1 per kelvin",
                     "0.003 is usual: polymers soften as they warm");
  }
}

}  // namespace kolsky::cli
