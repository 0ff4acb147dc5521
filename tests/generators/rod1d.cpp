#include "tests/generators/rod1d.hpp"

#include <algorithm>
#include <cmath>

#include "tests/generators/interpolation.hpp"

namespace kolsky::testing {

namespace {

double wave_speed(const KelvinChain& material, double density_kg_m3) {
  return std::sqrt(material.glassy_Pa / density_kg_m3);
}

}  // namespace

Rod::Rod(const KelvinChain& material, double density_kg_m3, double length_m, int cells,
         std::vector<double> relative_area)
    : chain_(material, length_m / cells / wave_speed(material, density_kg_m3)),
      cell_m_(length_m / cells),
      impedance_(std::sqrt(material.glassy_Pa * density_kg_m3)),
      half_(0.5 * material.glassy_Pa * chain_.step_s()),
      area_(std::move(relative_area)),
      kept_(static_cast<std::size_t>(cells)) {
  const auto nodes = static_cast<std::size_t>(cells) + 1;
  if (area_.empty()) {
    area_.assign(nodes - 1, 1.0);
  }
  for (auto* field :
       {&stress_, &right_going_, &left_going_, &rate_, &from_left_, &from_right_, &remembered_}) {
    field->assign(nodes, 0.0);
  }
  viscous_.assign(material.elements.size(), std::vector<double>(nodes, 0.0));
}

void Rod::advance() {
  const std::size_t last = stress_.size() - 1;
  reached_ = std::min({reached_ + 1, last, kept_});
  const std::size_t end = reached_ + 1;
  for (std::size_t j = 1; j < end; ++j) {
    from_left_[j] = right_going_[j - 1] - half_ * rate_[j - 1];
  }
  for (std::size_t j = 0; j + 1 < std::min(end + 1, last + 1); ++j) {
    from_right_[j] = left_going_[j + 1] - half_ * rate_[j + 1];
  }
  std::fill_n(remembered_.begin(), end, 0.0);
  for (std::size_t k = 0; k < viscous_.size(); ++k) {
    const KelvinStep::Element element = chain_.elements()[k];
    double* const strain = viscous_[k].data();
    for (std::size_t j = 0; j < end; ++j) {
      strain[j] = element.keep * strain[j] + element.from_old * stress_[j];
      remembered_[j] -= element.rate_share * strain[j];
    }
  }
  const double gain = 1.0 / (1.0 + half_ * chain_.rate_per_stress());
  left_ = {(from_right_[0] - half_ * remembered_[0]) * gain, impedance_ * area_[0] * gain};
  right_ = {(from_left_[last] - half_ * remembered_[last]) * gain,
            impedance_ * area_[last - 1] * gain};
  for (std::size_t j = 1; j < std::min(end, last); ++j) {
    const double share = area_[j - 1] / (area_[j - 1] + area_[j]);
    // The heavier side's wave counts less for the stress: both sides share one velocity.
    const double wave = (1.0 - share) * from_left_[j] + share * from_right_[j];
    stress_[j] = (wave - half_ * remembered_[j]) * gain;
  }
  for (std::size_t j = 0; j < end; ++j) {
    rate_[j] = chain_.rate_per_stress() * stress_[j] + remembered_[j];
  }
  for (std::size_t j = 1; j < std::min(end, last); ++j) {
    const double velocity =
        (from_left_[j] - half_ * rate_[j] - stress_[j]) / (impedance_ * area_[j - 1]);
    right_going_[j] = stress_[j] + impedance_ * area_[j] * velocity;
    left_going_[j] = stress_[j] - impedance_ * area_[j - 1] * velocity;
  }
  for (std::size_t k = 0; k < viscous_.size(); ++k) {
    const double from_new = chain_.elements()[k].from_new;
    double* const strain = viscous_[k].data();
    for (std::size_t j = 1; j < std::min(end, last); ++j) {
      strain[j] += from_new * stress_[j];
    }
  }
}

void Rod::forget_beyond(double x_m) {
  const double nodes = std::max(std::ceil(x_m / cell_m_), 0.0) + Stencil::kPoints;
  kept_ = nodes < static_cast<double>(kept_) ? static_cast<std::size_t>(nodes) : kept_;
}

void Rod::settle(std::size_t node, double stress) {
  stress_[node] = stress;
  rate_[node] = chain_.rate_per_stress() * stress + remembered_[node];
  for (std::size_t k = 0; k < viscous_.size(); ++k) {
    viscous_[k][node] += chain_.elements()[k].from_new * stress;
  }
}

void Rod::close_left(double stress_Pa) {
  settle(0, stress_Pa);
  // stress - Z v arrived from the right; what leaves is stress + Z v.
  right_going_[0] = 2.0 * stress_Pa - (from_right_[0] - half_ * rate_[0]);
}

void Rod::close_right(double stress_Pa) {
  const std::size_t last = stress_.size() - 1;
  if (reached_ < last) {
    return;
  }
  settle(last, stress_Pa);
  left_going_[last] = 2.0 * stress_Pa - (from_left_[last] - half_ * rate_[last]);
}

double Rod::strain_at(double x_m) const {
  const Stencil stencil = lagrange_stencil(x_m / cell_m_, stress_.size());
  double strain = 0.0;
  for (std::size_t i = 0; i < Stencil::kPoints; ++i) {
    const std::size_t j = stencil.first + i;
    double here = stress_[j] / chain_.glassy_Pa();
    for (const auto& element : viscous_) {
      here += element[j];
    }
    strain += stencil.weight[i] * here;
  }
  const auto cell = std::min(static_cast<std::size_t>(x_m / cell_m_), area_.size() - 1);
  return strain / area_[cell];
}

double Rod::largest_stress() const {
  double largest = 0.0;
  for (const double stress : stress_) {
    largest = std::max(largest, std::abs(stress));
  }
  return largest;
}

}  // namespace kolsky::testing
