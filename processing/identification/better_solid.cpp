#include "processing/identification/better_solid.hpp"

#include <utility>

#include "processing/reduction/formatted.hpp"

namespace kolsky {

namespace {

/// Whether the records show no branch, and leave room for none that would matter.
bool is_elastic(const BarFit& fit) {
  constexpr double kNoBranch = 1e-3;  // of the compliance
  return fit.solid == SolidKind::three_element &&
         (fit.lossless ||
          (!loss_shows(fit) && fit.parameters[0].value < kNoBranch * fit.parameters[1].value));
}

/// A fit leaves E2 anywhere beyond what records show: neither its value nor its deviation says more
/// than that there is no branch.
void make_elastic(Material& material) {
  const Measured E1_Pa = material.parameters.front();
  material.parameters = {E1_Pa, {kStiffest}, {kStiffest}};
  std::vector<double> covariance(material.parameters.size() * material.parameters.size(), 0.0);
  covariance.front() = E1_Pa.sd * E1_Pa.sd;
  material.covariance = std::move(covariance);
}

}  // namespace

const BarFit& fit_to_file(const BarIdentification& result) {
  return result.fit.solid == SolidKind::three_element ? result.three_element : result.fit;
}

Material material_to_file(const BarIdentification& result, const Bar& bar, std::string source) {
  const BarFit& fit = fit_to_file(result);
  Material material;
  material.density_kg_m3 = bar.density_kg_m3;
  material.poisson_ratio = bar.poisson_ratio;
  material.solid = fit.solid;
  material.parameters = measured_of(fit.parameters);
  material.source = std::move(source);
  material.covariance = row_by_row(fit.covariance);
  if (is_elastic(fit)) {
    make_elastic(material);
  }
  material.identified = Material::Identified{fit.band_limit_Hz, result.temperature_K,
                                             fit.chi2_reduced, !result.spectrum.mean_loss.gains()};
  return material;
}

std::optional<BetterSolid> better_solid(const BarIdentification& result) {
  const BarFit& filed = fit_to_file(result);
  std::optional<BetterSolid> better;
  for (const Alternative& other : result.alternatives) {
    const BarTheory& theory = other.theory;
    if (!other.failed.empty() || theory.solid == filed.solid || theory.waves != filed.theory ||
        theory.far_end != filed.far_end) {
      continue;
    }
    const double ahead = other.log_evidence - filed.log_evidence;
    if (ahead > (better ? better->log_evidence_ahead : kClearlyAhead)) {
      better = BetterSolid{theory.solid, ahead, other.chi2_reduced};
    }
  }
  return better;
}

std::string cost_of_going_by(const BarFit& filed, const BetterSolid& better) {
  return formatted(
      "a %s solid is ahead of the %s one that reductions would go by, by a log evidence of %.0f: "
      "that leaves a reduced chi2 of %.3g, it %.3g",
      name_of(better.solid).c_str(), name_of(filed.solid).c_str(), better.log_evidence_ahead,
      filed.chi2_reduced, better.chi2_reduced);
}

std::string cost_of_filing(const BarFit& filed, const BetterSolid& better) {
  return cost_of_going_by(filed, better) + "; --solid " + name_of(better.solid) + " files it";
}

}  // namespace kolsky
