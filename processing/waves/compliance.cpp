#include "processing/waves/compliance.hpp"

#include "processing/waves/solids.hpp"

namespace kolsky {

Complex ThreeElementSolid::at(Complex s) const {
  return 1.0 / E1_Pa_ + 1.0 / (E2_Pa_ + s * eta2_Pa_s_);
}

std::unique_ptr<const Compliance> compliance_of(const Material& material) {
  return make_solid(material.solid, values_of(material.parameters));
}

std::unique_ptr<const Compliance> compliance_of(const Bar& bar, const Material& viscoelastic) {
  if (bar.youngs_modulus_Pa) {
    return std::make_unique<ElasticSolid>(*bar.youngs_modulus_Pa);
  }
  return compliance_of(bar.material ? *bar.material : viscoelastic);
}

}  // namespace kolsky
