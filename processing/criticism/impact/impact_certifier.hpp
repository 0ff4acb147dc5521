#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/criticism/impact/impact_search.hpp"
#include "processing/criticism/verdict/diagnosis.hpp"

namespace kolsky {

/// What becomes of the best of a search's refits, which outlive it.
struct JudgedRefits {
  const ImpactRefit* certified = nullptr;  ///< the best that is, of the search's; none: null
  std::vector<std::string> rejected;       ///< those before it
};

/// What a refit has to stand before it is claimed: chance among all that was searched, shots and
/// speeds that its strength was not found in, and one strength at all speeds.
class ImpactCertifier {
 public:
  /// @param log_alpha  ln of the chance of a false claim
  ImpactCertifier(ImpactStudy& study, double log_alpha) : study_(study), log_alpha_(log_alpha) {}

  /// Gain of one fit over another on speeds that neither saw; where there is one speed only, on
  /// shots.
  [[nodiscard]] double held_out_gain(const Studied& before, const Studied& after) const;
  /// Of a fit, per residual; of the same folds.
  [[nodiscard]] double held_out_misfit(const Studied& studied) const;

  /// Of what stands before nothing at all, down to the best that is certified.
  [[nodiscard]] JudgedRefits judged(const ImpactSearch& search, const Studied& current) const;
  /// Why the best is not believed though all else certifies it; none: nothing of it is there.
  [[nodiscard]] std::optional<std::string> unbelievable(const ImpactSearch& search,
                                                        const Studied& current) const;

 private:
  [[nodiscard]] bool stands(const ImpactSearch& search, const ImpactRefit& refit,
                            const Studied& current) const;
  [[nodiscard]] bool certified(const ImpactSearch& search, const ImpactRefit& refit,
                               const Studied& current) const;
  [[nodiscard]] double disagreement(const Studied& studied, const std::string& id) const;
  [[nodiscard]] double gain_on_shots(const Studied& before, const Studied& after) const;
  [[nodiscard]] double gain_on_speeds(const Studied& before, const Studied& after) const;
  [[nodiscard]] std::size_t speeds() const;

  ImpactStudy& study_;
  double log_alpha_;
};

/// What a refit does not stand before.
[[nodiscard]] std::vector<std::string> beside(const ImpactSearch& search, const ImpactRefit& own);

}  // namespace kolsky
