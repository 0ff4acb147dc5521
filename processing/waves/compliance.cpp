#include "processing/waves/compliance.hpp"

namespace kolsky {

std::unique_ptr<const Compliance> compliance_of(const Bar& bar, const Material& viscoelastic) {
  if (bar.youngs_modulus_Pa) {
    return std::make_unique<ElasticSolid>(*bar.youngs_modulus_Pa);
  }
  return std::make_unique<ThreeElementSolid>(viscoelastic);
}

}  // namespace kolsky
