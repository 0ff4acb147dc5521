#include "processing/criticism/fitting/specimen_response.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "processing/criticism/fitting/creeping_spring.hpp"
#include "processing/models/lateral_inertia.hpp"

namespace kolsky {

namespace {

constexpr double kConverged = 1e-7;
/// Steps that do not halve what is left: a specimen that softens until it gives way has no answer.
constexpr int kPatience = 20;

/// The sample at which bars begin to approach: what comes before is noise, which closes no gap.
std::size_t at_rest_until(const std::vector<double>& approach) {
  constexpr double kUnderWay = 0.1;
  constexpr double kAtRest = 0.005;  // of the steepest step
  const auto top = std::max_element(approach.begin(), approach.end());
  const auto under_way =
      std::find_if(approach.begin(), top, [&](double value) { return value >= kUnderWay * *top; });
  double steepest = 0.0;
  for (auto step = under_way; step != top; ++step) {
    steepest = std::max(steepest, step[1] - step[0]);
  }
  auto at = under_way;
  while (at != approach.begin() && at[0] - at[-1] > kAtRest * steepest) {
    --at;
  }
  return static_cast<std::size_t>(at - approach.begin());
}

/// What solids are strained by, however far a fit may go.
double believable(double strain) {
  return std::clamp(strain, -0.5, 0.9);
}

bool bends(const SpecimenScene& specimen) {
  return specimen.stiffening != 0.0 || specimen.friction != 0.0 ||
         specimen.lateral_inertia_kg_per_m != 0.0;
}

void add_products(const std::vector<Complex>& a, const std::vector<Complex>& b,
                  std::vector<Complex>& sums) {
  for (std::size_t k = 0; k < sums.size(); ++k) {
    sums[k] += a[k] * b[k];
  }
}

}  // namespace

void SpecimenResponse::to_time(const std::vector<Complex>& spectrum, DampedTransform& transform,
                               std::vector<double>& out) {
  wide_.assign(transform.bins(), 0.0);
  std::copy(spectrum.begin(), spectrum.end(), wide_.begin());
  out.resize(transform.length());
  transform.inverse(wide_, out);
}

void SpecimenResponse::to_spectrum(const std::vector<double>& record, DampedTransform& transform,
                                   std::vector<Complex>& out) {
  wide_.resize(transform.bins());
  transform.forward(record, wide_);
  std::copy_n(wide_.begin(), out.size(), out.begin());
}

void SpecimenResponse::prepare(const Scene& scene, const Transfers& transfers,
                               std::size_t reference, const std::vector<Complex>& source,
                               std::span<const Complex> filter) {
  const std::size_t places = scene.s.size();
  const SpecimenScene& specimen = *scene.specimen;
  for (Linear* linear : {&of_stress_, &of_strain_}) {
    linear->of_source.resize(places);
    linear->of_q.resize(places);
  }
  of_lateral_.resize(places);
  of_extra_.resize(places);
  of_material_.resize(places);
  for (std::size_t k = 0; k < places; ++k) {
    const Complex s = scene.s[k];
    const Complex inverse = 1.0 / transfers.reading[reference][k];
    // Of the source, what the reference gauge has seen of q goes off.
    const Complex strength = source[k] * inverse;
    const Complex seen = filter[k] * transfers.reading_of_q[reference][k] * inverse;
    of_stress_.of_source[k] = transfers.stress[k] * strength;
    of_stress_.of_q[k] = transfers.stress_of_q[k] - transfers.stress[k] * seen;
    of_strain_.of_source[k] = transfers.strain[k] * strength;
    of_strain_.of_q[k] = transfers.strain_of_q[k] - transfers.strain[k] * seen;
    // What the material strains further it must also accelerate sideways.
    const Complex J = specimen.solid.compliance(s, k);
    of_lateral_[k] = lateral_stress_Pa(specimen, J, s);
    of_extra_[k] = 1.0 / (1.0 + J * of_lateral_[k]);
    of_material_[k] = J * of_extra_[k];
  }
}

void SpecimenResponse::give(const std::vector<double>& further_strain, DampedTransform& transform) {
  given_.assign(of_extra_.size(), 0.0);
  if (further_strain.empty()) {
    return;
  }
  extra_ = further_strain;
  extra_.resize(transform.length());
  to_spectrum(extra_, transform, spectrum_);
  add_products(of_extra_, spectrum_, given_);
}

void SpecimenResponse::put_history(const Linear& linear, DampedTransform& transform,
                                   std::vector<double>& out) {
  for (std::size_t k = 0; k < spectrum_.size(); ++k) {
    spectrum_[k] = linear.of_source[k] + linear.of_q[k] * q_[k];
  }
  to_time(spectrum_, transform, out);
}

/// What stress the material has beside the measured, and how that bends it.
void SpecimenResponse::bend(const Scene& scene, DampedTransform& transform) {
  const SpecimenScene& specimen = *scene.specimen;
  const bool widens = specimen.lateral_inertia_kg_per_m != 0.0;
  const bool rubs = specimen.friction != 0.0;
  material_.assign(strain_.size(), 0.0);
  accelerated_.assign(strain_.size(), 0.0);
  if (widens) {
    accelerate(scene, transform);
  }
  put_history(of_stress_, transform, stress_);
  if (rubs) {
    rub(specimen);
  }
  if (widens || rubs) {
    to_spectrum(material_, transform, spectrum_);
    add_products(of_material_, spectrum_, next_);
  }
  if (specimen.stiffening != 0.0) {
    stiffen(specimen);
    to_spectrum(extra_, transform, spectrum_);
    add_products(of_extra_, spectrum_, next_);
  }
}

/// Lateral inertia, from the strain's spectrum.
void SpecimenResponse::accelerate(const Scene& scene, DampedTransform& transform) {
  const double m = scene.specimen->lateral_inertia_kg_per_m;
  sideways_.assign(spectrum_.size(), 0.0);
  add_products(of_lateral_, spectrum_, sideways_);
  to_time(sideways_, transform, accelerated_);
  for (std::size_t k = 0; k < spectrum_.size(); ++k) {
    spectrum_[k] *= scene.s[k];
  }
  to_time(spectrum_, transform, rate_);
  for (std::size_t n = 0; n < rate_.size(); ++n) {
    material_[n] -= m * rate_[n] * rate_[n] / 16.0;
  }
}

/// Beside what friction does to a specimen that is hardly strained, which is in the transfers.
void SpecimenResponse::rub(const SpecimenScene& specimen) {
  const double at_rest = specimen.share_of_stress(0.0);
  for (std::size_t n = 0; n < strain_.size(); ++n) {
    material_[n] += stress_[n] * (specimen.share_of_stress(believable(strain_[n])) - at_rest);
  }
}

void SpecimenResponse::stiffen(const SpecimenScene& specimen) {
  const double per_E1 = 1.0 / specimen.solid.E1_Pa;
  const double at_rest = specimen.share_of_stress(0.0);
  extra_.resize(strain_.size());
  for (std::size_t n = 0; n < strain_.size(); ++n) {
    const double spring = std::max(0.05, 1.0 + specimen.stiffening * believable(strain_[n]));
    extra_[n] =
        (at_rest * stress_[n] + material_[n] - accelerated_[n]) * per_E1 * (1.0 / spring - 1.0);
  }
}

void SpecimenResponse::part(const SpecimenScene& specimen, DampedTransform& transform) {
  if (!at_rest_) {
    at_rest_ = at_rest_until(strain_);
  }
  apart_.assign(strain_.size(), 0.0);
  if (specimen.parts || specimen.gap_after == GapAfter::pulls_nothing) {
    const double length = static_cast<double>(transform.length());
    push_only(specimen, 1.0 / (transform.bin_width_Hz() * length));
  } else {
    close_gap(specimen);
  }
  to_spectrum(apart_, transform, spectrum_);
  for (std::size_t k = 0; k < next_.size(); ++k) {
    next_[k] += spectrum_[k];
  }
}

void SpecimenResponse::close_gap(const SpecimenScene& specimen) {
  const double gap = specimen.gap_m / specimen.length_m;
  bool open = true;
  for (std::size_t n = *at_rest_; n < strain_.size(); ++n) {
    const double approach = strain_[n] - strain_[*at_rest_];
    open = approach < gap && (open || specimen.gap_after == GapAfter::opens_where_it_was);
    apart_[n] = open ? approach : gap;
  }
}

/// The law, step by step: pushed it follows the bars; where that would pull it they part, and it
/// recovers. (Of fractional and further terms of the compliance only what a spring and Kelvin
/// elements do counts here.)
void SpecimenResponse::push_only(const SpecimenScene& specimen, double period_s) {
  const double gap = specimen.gap_m / specimen.length_m;
  CreepingSpring law(specimen.solid, period_s);
  for (std::size_t n = *at_rest_; n < strain_.size(); ++n) {
    const double approach = strain_[n] - strain_[*at_rest_];
    const double pushed_Pa = law.stress_at(approach - gap);
    apart_[n] = pushed_Pa < 0.0 ? approach - law.strain_at_rest() : gap;
    law.advance(std::max(0.0, pushed_Pa));
  }
}

/// What q would be by the histories that it leads to.
void SpecimenResponse::depart(const Scene& scene, DampedTransform& transform) {
  const SpecimenScene& specimen = *scene.specimen;
  put_history(of_strain_, transform, strain_);
  next_ = given_;
  if (bends(specimen)) {
    bend(scene, transform);
  }
  if (specimen.gap_m != 0.0 || specimen.parts) {
    part(specimen, transform);
  }
}

void SpecimenResponse::solve(const Scene& scene, const Transfers& transfers, std::size_t reference,
                             const std::vector<Complex>& source, std::span<const Complex> filter,
                             DampedTransform& transform) {
  const std::size_t places = scene.s.size();
  spectrum_.resize(places);
  prepare(scene, transfers, reference, source, filter);
  give(scene.specimen->further_strain, transform);
  at_rest_.reset();
  q_.assign(places, 0.0);
  steps_.begin(places);
  double least = std::numeric_limits<double>::infinity();
  for (int since = 0; since < kPatience; ++since) {
    depart(scene, transform);
    double change = 0.0;
    double size = 0.0;
    for (std::size_t k = 0; k < places; ++k) {
      change += std::norm(next_[k] - q_[k]);
      size += std::norm(next_[k]);
    }
    steps_.step(q_, next_);
    if (change <= kConverged * kConverged * size) {
      return;
    }
    if (change < 0.25 * least) {
      least = change;
      nearest_ = q_;
      since = 0;
    }
  }
  // Without any that is a number, what is not one: no fit takes that for an answer.
  if (std::isfinite(least)) {
    q_ = nearest_;
  }
}

SpecimenHistories SpecimenResponse::histories(DampedTransform& transform) {
  put_history(of_stress_, transform, stress_);
  put_history(of_strain_, transform, strain_);
  return {stress_, strain_};
}

}  // namespace kolsky
