#include "processing/specimen/fit_warnings.hpp"

#include <algorithm>
#include <cmath>

#include "processing/reduction/formatted.hpp"

namespace kolsky {

namespace {

/// What a family has more than three elements.
const char* surplus_of(SolidKind solid) {
  switch (solid) {
    case SolidKind::fractional:
      return "beta below 1";
    case SolidKind::two_kelvin:
      return "a second branch";
    case SolidKind::three_kelvin:
    case SolidKind::four_kelvin:
      return "further branches";
    case SolidKind::four_element_fluid:
      return "a flow, eta2_Pa_s";
    case SolidKind::three_element:
      break;
  }
  return "";
}

}  // namespace

bool leaves_more_than_noise(const SpecimenFit& fit) {
  constexpr double kDeviations = 4.0;
  constexpr double kMost = 0.5;
  const double chance = std::sqrt(2.0 / static_cast<double>(fit.degrees_of_freedom));
  return fit.chi2_reduced > 1.0 + std::min(kMost, kDeviations * chance);
}

std::vector<std::string> warnings_of(const std::vector<FittedNumber>& parameters) {
  constexpr double kHardly = 0.3;
  std::vector<std::string> warnings;
  for (const FittedNumber& p : parameters) {
    if (!(p.sd > 0.0) || !std::isfinite(p.sd)) {
      // What nothing changes any more has no curvature to take a deviation from.
      warnings.push_back(p.name + " is not determined by these shots: it has no deviation");
    } else if (!(p.sd <= kHardly * p.value)) {
      warnings.push_back(p.name + " is hardly determined by these shots: its deviation is " +
                         std::to_string(std::lround(100.0 * p.sd / p.value)) + " %");
    }
  }
  return warnings;
}

std::vector<std::string> warnings_of(const std::vector<CompliancePoint>& spectrum) {
  constexpr double kClearly = 4.0;
  for (const CompliancePoint& p : spectrum) {
    const double sd = std::isnan(p.J2_sd_of_mean) ? 0.0 : p.J2_sd_of_mean;
    if (p.J2_per_Pa < -kClearly * sd) {
      return {"J2 is negative at " + std::to_string(std::lround(p.frequency_Hz)) +
              " Hz: no passive material does that"};
    }
  }
  return {};
}

std::string gives_energy_back(const std::vector<CompliancePoint>& spectrum) {
  const auto negative = std::ranges::count_if(
      spectrum, [](const CompliancePoint& point) { return point.J2_per_Pa < 0.0; });
  const auto count = static_cast<std::ptrdiff_t>(spectrum.size());
  if (count == 0 || 2 * negative < count) {
    return "";
  }
  return "strain over stress has a negative J2 at " + std::to_string(negative) + " of " +
         std::to_string(count) + " frequencies, as if the specimen gave energy back";
}

std::string no_more_than_three_elements(const SpecimenFit& fit) {
  return formatted(
      "%s takes %.1f off the chi2 of three elements, which chance does too: these shots show no "
      "need of %s",
      name_of(fit.solid).c_str(), std::max(0.0, fit.three_element->chi2_gain),
      surplus_of(fit.solid));
}

std::vector<std::string> contradiction(const SpecimenFit& fit,
                                       const std::vector<FittedNumber>& spectral) {
  constexpr double kFarMore = 4.0;
  const std::vector<FittedNumber> none;
  const std::vector<FittedNumber>& direct = fit.solid == SolidKind::three_element ? fit.parameters
                                            : fit.three_element ? fit.three_element->parameters
                                                                : none;
  double furthest = kFarMore;
  std::vector<std::string> warning;
  for (std::size_t i = 0; i < std::min(direct.size(), spectral.size()); ++i) {
    const double off =
        std::abs(spectral[i].value - direct[i].value) / std::hypot(spectral[i].sd, direct[i].sd);
    if (off > furthest) {
      furthest = off;
      warning = {formatted("%s is %.4g, %.0f deviations from the direct fit's %.4g: ",
                           spectral[i].name.c_str(), spectral[i].value, off, direct[i].value) +
                 "strain over stress is biased by the pulse's foot, the window and the specimen's "
                 "mass, of which its deviations know nothing; " +
                 (leaves_more_than_noise(fit)
                      ? "the direct fit's model leaves more than noise: quote neither"
                      : "quote the direct fit")};
    }
  }
  return warning;
}

}  // namespace kolsky
