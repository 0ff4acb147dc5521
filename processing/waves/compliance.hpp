#pragma once

#include <complex>
#include <memory>

#include "processing/base/bench.hpp"
#include "processing/base/material.hpp"

namespace kolsky {

using Complex = std::complex<double>;

/// The uniaxial complex compliance J of a linear solid [1/Pa], as a function of the Laplace
/// variable s = eta + i w [1/s]; on the imaginary axis J(iw) = J1 - i J2. Passive solids are
/// analytic for Re s >= 0, s != 0.
class Compliance {
 public:
  virtual ~Compliance() = default;
  [[nodiscard]] virtual Complex at(Complex s) const = 0;
  /// J(infinity) [1/Pa]: what the front of a wave sees.
  [[nodiscard]] virtual double instantaneous() const = 0;
};

/// J = 1/E.
class ElasticSolid final : public Compliance {
 public:
  explicit ElasticSolid(double youngs_modulus_Pa) : J_per_Pa_(1.0 / youngs_modulus_Pa) {}
  [[nodiscard]] Complex at(Complex /*s*/) const override { return J_per_Pa_; }
  [[nodiscard]] double instantaneous() const override { return J_per_Pa_; }

 private:
  double J_per_Pa_;
};

/// J = 1/E1 + 1/(E2 + s eta2) (paper, eq. A3).
class ThreeElementSolid final : public Compliance {
 public:
  ThreeElementSolid(double E1_Pa, double E2_Pa, double eta2_Pa_s)
      : E1_Pa_(E1_Pa), E2_Pa_(E2_Pa), eta2_Pa_s_(eta2_Pa_s) {}
  explicit ThreeElementSolid(const Material& m)
      : ThreeElementSolid(m.E1_Pa(), m.E2_Pa(), m.eta2_Pa_s()) {}

  // Not inline: modules differ in how they divide complex numbers, and which of them a program's
  // copy came from would show in the last bits.
  [[nodiscard]] Complex at(Complex s) const override;
  [[nodiscard]] double instantaneous() const override { return 1.0 / E1_Pa_; }

 private:
  double E1_Pa_;
  double E2_Pa_;
  double eta2_Pa_s_;
};

/// A material's, of whatever family.
[[nodiscard]] std::unique_ptr<const Compliance> compliance_of(const Material& material);

/// A bar's compliance: elastic where the bench gives its modulus, of its own material where the
/// bench has one, else the bar model's.
[[nodiscard]] std::unique_ptr<const Compliance> compliance_of(const Bar& bar,
                                                              const Material& viscoelastic);

}  // namespace kolsky
