#pragma once

#include <vector>

namespace kolsky::testing {

/// A spring and a dashpot in parallel. Without a spring it flows for ever.
struct KelvinElement {
  double stiffness_Pa = 0.0;
  double viscosity_Pa_s = 0.0;
};

/// A solid as internal variables: a glassy spring in series with Kelvin elements, so that the
/// complex compliance is 1/E + sum 1/(E_k + i w eta_k). Everything a bar of the generators can be
/// made of, without a transform.
struct KelvinChain {
  double glassy_Pa = 0.0;
  std::vector<KelvinElement> elements;

  /// Compliances add: J += D/(1 + i w tau).
  void add_relaxation(double compliance_per_Pa, double time_s);
  /// J += fluidity/(i w).
  void add_flow(double fluidity_per_Pa_s);
  /// All moduli times a factor: J / factor.
  [[nodiscard]] KelvinChain scaled(double factor) const;
};

[[nodiscard]] KelvinChain elastic(double E_Pa);
[[nodiscard]] KelvinChain three_element(double E1_Pa, double E2_Pa, double eta2_Pa_s);

/// The three-element solid with the fractional branch 1/(E2 [1 + (i w eta2/E2)^beta]), beta in
/// (0, 1]. The branch has a positive spectrum of retardation times (Cole and Cole, 1941),
/// sin(beta pi) / (2 pi [cosh(beta u) + cos(beta pi)]) over u = ln(time E2/eta2); `points` Kelvin
/// elements are its Gauss quadrature. Many more points only add times too short for the step.
[[nodiscard]] KelvinChain fractional_three_element(double E1_Pa, double E2_Pa, double eta2_Pa_s,
                                                   double beta, int points = 14);

/// What a Kelvin chain does over steps of one length while the stress runs linearly from one end of
/// the step to the other; exact for that.
class KelvinStep {
 public:
  KelvinStep(const KelvinChain& chain, double step_s);

  struct Element {
    double keep;        ///< share of the strain that stays
    double from_old;    ///< strain per stress at the step's beginning
    double from_new;    ///< and at its end
    double rate_share;  ///< strain rate lost per strain, E/eta
  };
  [[nodiscard]] const std::vector<Element>& elements() const { return elements_; }
  /// Viscous strain rate at the step's end per stress there.
  [[nodiscard]] double rate_per_stress() const { return rate_per_stress_; }
  [[nodiscard]] double glassy_Pa() const { return glassy_Pa_; }
  [[nodiscard]] double step_s() const { return step_s_; }

 private:
  std::vector<Element> elements_;
  double rate_per_stress_ = 0.0;
  double glassy_Pa_ = 0.0;
  double step_s_ = 0.0;
};

}  // namespace kolsky::testing
