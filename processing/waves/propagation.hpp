#pragma once

#include <cmath>

#include "processing/waves/compliance.hpp"

namespace kolsky {

/// Elementary one-dimensional waves in a bar: a strain wave travelling in +x is multiplied by
/// exp(-gamma x), gamma = alpha + i k = s sqrt(rho J(s)) (paper, eqs 6 to 9), the root that decays.
class ElementaryPropagation {
 public:
  /// @param compliance outlives this
  ElementaryPropagation(double density_kg_m3, const Compliance& compliance)
      : density_kg_m3_(density_kg_m3), compliance_(&compliance) {}

  /// gamma(s) [1/m], Re >= 0 for Re s >= 0.
  [[nodiscard]] Complex gamma(Complex s) const {
    // J of a passive solid lies in the right half plane, so the principal root is the decaying one.
    return s * std::sqrt(density_kg_m3_ * compliance_->at(s));
  }
  /// J(s) [1/Pa]: stress of a wave is its strain over J.
  [[nodiscard]] Complex J(Complex s) const { return compliance_->at(s); }

  /// Speed of the very front [m/s].
  [[nodiscard]] double front_speed_m_per_s() const {
    return 1.0 / std::sqrt(density_kg_m3_ * compliance_->instantaneous());
  }

 private:
  double density_kg_m3_;
  const Compliance* compliance_;
};

}  // namespace kolsky
