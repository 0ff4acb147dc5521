#pragma once

#include <span>
#include <vector>

#include "processing/criticism/fitting/composition.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

/// What specimens departed from their linear law by (`SpecimenResponse::q`) in the last evaluations
/// of every shot: much of a fit moves what acts on the records of other gauges, and asks again.
class KnownDepartures {
 public:
  explicit KnownDepartures(std::size_t shots) : shots_(shots) {}

  /// @return  nothing where it is not among them
  [[nodiscard]] const std::vector<Complex>* find(std::size_t shot,
                                                 std::span<const AppliedEffect> on_waves,
                                                 std::span<const Complex> source) const;
  void keep(std::size_t shot, std::span<const AppliedEffect> on_waves,
            std::span<const Complex> source, std::span<const Complex> q);

 private:
  static constexpr std::size_t kKept = 4;  ///< of each shot

  struct Departure {
    std::vector<AppliedEffect> on_waves;
    std::vector<Complex> source;
    std::vector<Complex> q;
  };
  struct OfShot {
    std::vector<Departure> last;
    std::size_t oldest = 0;
  };

  std::vector<OfShot> shots_;
};

}  // namespace kolsky
