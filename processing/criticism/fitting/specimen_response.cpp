#include "processing/criticism/fitting/specimen_response.hpp"

#include <algorithm>
#include <cmath>

#include "processing/criticism/fitting/creeping_spring.hpp"

namespace kolsky {

namespace {

constexpr int kMostIterations = 200;
constexpr double kConverged = 1e-7;

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
    of_extra_[k] = 1.0 / (1.0 + J * specimen.lateral_inertia_kg_per_m * s * s / 8.0);
    of_material_[k] = J * of_extra_[k];
  }
}

void SpecimenResponse::put_history(const Linear& linear, DampedTransform& transform,
                                   std::vector<double>& out) {
  for (std::size_t k = 0; k < spectrum_.size(); ++k) {
    spectrum_[k] = linear.of_source[k] + linear.of_q[k] * q_[k];
  }
  to_time(spectrum_, transform, out);
}

/// Lateral inertia, from the strain's spectrum.
void SpecimenResponse::accelerate(const Scene& scene, DampedTransform& transform) {
  const double m = scene.specimen->lateral_inertia_kg_per_m;
  for (std::size_t k = 0; k < spectrum_.size(); ++k) {
    spectrum_[k] *= scene.s[k];
  }
  to_time(spectrum_, transform, rate_);
  for (std::size_t k = 0; k < spectrum_.size(); ++k) {
    spectrum_[k] *= scene.s[k];
  }
  to_time(spectrum_, transform, accelerated_);
  for (std::size_t n = 0; n < rate_.size(); ++n) {
    material_[n] -= m * rate_[n] * rate_[n] / 16.0;
    accelerated_[n] *= m / 8.0;
  }
}

/// Friction and stiffening.
void SpecimenResponse::bend(const SpecimenScene& specimen) {
  for (std::size_t n = 0; n < strain_.size(); ++n) {
    const double e = std::clamp(strain_[n], -0.5, 0.9);
    if (specimen.friction != 0.0) {
      // A specimen that keeps its volume: d grows as h^-1/2.
      const double h = specimen.length_m * (1.0 - e);
      const double d = specimen.diameter_m / std::sqrt(1.0 - e);
      material_[n] += stress_[n] * (1.0 / (1.0 + specimen.friction * d / (3.0 * h)) - 1.0);
    }
    if (specimen.stiffening != 0.0) {
      const double spring = std::max(0.05, 1.0 + specimen.stiffening * e);
      extra_[n] += (stress_[n] + material_[n] - accelerated_[n]) / specimen.solid.E1_Pa *
                   (1.0 / spring - 1.0);
    }
  }
}

void SpecimenResponse::close_gap(const SpecimenScene& specimen) {
  const double gap = specimen.gap_m / specimen.length_m;
  bool open = true;
  for (std::size_t n = at_rest_; n < strain_.size(); ++n) {
    const double approach = strain_[n] - strain_[at_rest_];
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
  for (std::size_t n = at_rest_; n < strain_.size(); ++n) {
    const double approach = strain_[n] - strain_[at_rest_];
    const double pushed_Pa = law.stress_at(approach - gap);
    apart_[n] = pushed_Pa < 0.0 ? approach - law.strain_at_rest() : gap;
    law.advance(std::max(0.0, pushed_Pa));
  }
}

void SpecimenResponse::solve(const Scene& scene, const Transfers& transfers, std::size_t reference,
                             const std::vector<Complex>& source, std::span<const Complex> filter,
                             DampedTransform& transform) {
  const SpecimenScene& specimen = *scene.specimen;
  const std::size_t places = scene.s.size();
  const double period_s =
      1.0 / (transform.bin_width_Hz() * static_cast<double>(transform.length()));
  prepare(scene, transfers, reference, source, filter);
  q_.assign(places, 0.0);
  next_.resize(places);
  spectrum_.resize(places);
  double before = 1e300;
  double mixing = 1.0;
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    put_history(of_stress_, transform, stress_);
    put_history(of_strain_, transform, strain_);
    extra_ = specimen.further_strain;
    extra_.resize(strain_.size());
    material_.assign(strain_.size(), 0.0);
    accelerated_.assign(strain_.size(), 0.0);
    if (specimen.lateral_inertia_kg_per_m != 0.0) {
      accelerate(scene, transform);
    }
    bend(specimen);
    to_spectrum(material_, transform, spectrum_);
    to_spectrum(extra_, transform, next_);
    for (std::size_t k = 0; k < places; ++k) {
      next_[k] = of_extra_[k] * next_[k] + of_material_[k] * spectrum_[k];
    }
    if (specimen.gap_m != 0.0) {
      if (iteration == 0) {
        at_rest_ = at_rest_until(strain_);
        apart_.assign(strain_.size(), 0.0);
      }
      if (specimen.gap_after == GapAfter::pulls_nothing) {
        push_only(specimen, period_s);
      } else {
        close_gap(specimen);
      }
      to_spectrum(apart_, transform, spectrum_);
      for (std::size_t k = 0; k < places; ++k) {
        next_[k] += spectrum_[k];
      }
    }
    double change = 0.0;
    double size = 0.0;
    for (std::size_t k = 0; k < places; ++k) {
      change += std::norm(next_[k] - q_[k]);
      size += std::norm(next_[k]);
    }
    mixing = change < before ? std::min(1.0, mixing * 1.2) : mixing * 0.5;
    for (std::size_t k = 0; k < places; ++k) {
      q_[k] += mixing * (next_[k] - q_[k]);
    }
    if (change <= kConverged * kConverged * size) {
      break;
    }
    before = change;
  }
}

}  // namespace kolsky
