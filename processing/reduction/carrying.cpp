#include "processing/reduction/carrying.hpp"

#include <algorithm>

#include "processing/waves/each_exp.hpp"

namespace kolsky {

namespace {

/// exp(-gamma x) over the stretches of one bar.
struct Stretches {
  std::vector<Complex> to_specimen;  // exp(-gamma l)
  std::vector<Complex> round_trip;   // exp(-2 gamma x), gauge to far end and back

  explicit Stretches(const CarryingBar& bar)
      : to_specimen(bar.modes.size()), round_trip(bar.modes.size(), 0.0) {
    for (std::size_t k = 0; k < bar.modes.size(); ++k) {
      to_specimen[k] = -bar.modes[k].gamma * bar.gauge_to_specimen_m;
    }
    each_exp(to_specimen);
    if (bar.far_end == FarEnd::free) {
      for (std::size_t k = 0; k < bar.modes.size(); ++k) {
        round_trip[k] = -2.0 * bar.modes[k].gamma * bar.gauge_to_far_end_m;
      }
      each_exp(round_trip);
    }
  }
};

/// One bar at one s.
struct Place {
  Complex to_specimen;
  Complex round_trip;
  Complex separation;  // 1 / (1 - round_trip)
  Complex mean;        // mean strain over what the gauge reads
  Complex force;       // A rho s^2 / gamma^2, of what the gauge reads
  Complex velocity;    // s / gamma, likewise

  Place(const CarryingBar& bar, const Stretches& stretches, std::size_t k, Complex s)
      : to_specimen(stretches.to_specimen[k]),
        round_trip(stretches.round_trip[k]),
        separation(1.0 / (1.0 - round_trip)),
        mean(bar.modes[k].mean_over_surface) {
    const Complex gamma = bar.modes[k].gamma;
    velocity = mean * s / gamma;
    force = bar.area_m2 * bar.density_kg_m3 * velocity * s / gamma;
  }
};

void multiply(const std::vector<Complex>& kernel, std::span<const Complex> in,
              std::span<Complex> out) {
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k] = kernel[k] * in[k];
  }
}

void multiply_add(const std::vector<Complex>& kernel, std::span<const Complex> in,
                  std::span<Complex> out) {
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k] += kernel[k] * in[k];
  }
}

}  // namespace

CarryingKernels::CarryingKernels(std::span<const Complex> path, const CarryingBar& input,
                                 const CarryingBar& output, double specimen_length_m,
                                 double delay_s) {
  const std::size_t bins = path.size();
  for (auto* kernel : {&to_impact_, &from_impact_, &force_of_incident_, &force_of_rest_,
                       &force_of_output_, &rate_of_incident_, &rate_of_rest_, &rate_of_output_,
                       &right_of_incident_, &right_of_rest_, &left_of_rest_, &right_of_output_}) {
    kernel->resize(bins);
  }
  const Stretches of_input(input);
  const Stretches of_output(output);
  std::vector<Complex> delays(bins);
  for (std::size_t k = 0; k < bins; ++k) {
    delays[k] = -path[k] * delay_s;
    const Complex front = path[k] / input.front_speed_m_per_s;
    from_impact_[k] = -(input.modes[k].gamma - front) * input.gauge_to_far_end_m;
  }
  each_exp(delays);
  each_exp(from_impact_);
  for (std::size_t k = 0; k < bins; ++k) {
    const Complex s = path[k];
    const Place a(input, of_input, k, s);
    const Complex right_rest = -a.round_trip * a.separation * a.to_specimen;
    const Complex left_rest = a.separation / a.to_specimen;
    from_impact_[k] *= input.area_m2 / a.force;
    to_impact_[k] = 1.0 / from_impact_[k];
    right_of_incident_[k] = a.mean * a.to_specimen;
    right_of_rest_[k] = a.mean * right_rest;
    left_of_rest_[k] = a.mean * left_rest;
    force_of_incident_[k] = a.force * a.to_specimen;
    force_of_rest_[k] = a.force * (right_rest + left_rest);
    rate_of_incident_[k] = a.velocity * a.to_specimen / specimen_length_m;
    rate_of_rest_[k] = a.velocity * (right_rest - left_rest) / specimen_length_m;

    const Place b(output, of_output, k, s);
    const Complex right_out = b.separation / b.to_specimen;
    const Complex left_out = -b.separation * b.round_trip * b.to_specimen;
    right_of_output_[k] = b.mean * right_out;
    force_of_output_[k] = b.force * (right_out + left_out);
    rate_of_output_[k] = -b.velocity * (right_out - left_out) / specimen_length_m;

    for (auto* history : {&force_of_incident_, &force_of_rest_, &force_of_output_,
                          &rate_of_incident_, &rate_of_rest_, &rate_of_output_, &right_of_incident_,
                          &right_of_rest_, &left_of_rest_, &right_of_output_}) {
      (*history)[k] *= delays[k];
    }
  }
}

void CarryingKernels::push_from_incident(std::span<Complex> wave) const {
  multiply(to_impact_, wave, wave);
}

void CarryingKernels::incident_from_push(std::span<Complex> wave) const {
  multiply(from_impact_, wave, wave);
}

void CarryingKernels::force_front(const Inputs& in, std::span<Complex> out) const {
  multiply(force_of_incident_, in.incident, out);
  multiply_add(force_of_rest_, in.rest, out);
}

void CarryingKernels::force_back(const Inputs& in, std::span<Complex> out) const {
  multiply(force_of_output_, in.output, out);
}

void CarryingKernels::strain_rate(const Inputs& in, std::span<Complex> out) const {
  multiply(rate_of_incident_, in.incident, out);
  multiply_add(rate_of_rest_, in.rest, out);
  multiply_add(rate_of_output_, in.output, out);
}

void CarryingKernels::rate_of_front(const Inputs& in, std::span<Complex> out) const {
  multiply(rate_of_incident_, in.incident, out);
  multiply_add(rate_of_rest_, in.rest, out);
}

void CarryingKernels::right_going_front(const Inputs& in, std::span<Complex> out) const {
  multiply(right_of_incident_, in.incident, out);
  multiply_add(right_of_rest_, in.rest, out);
}

void CarryingKernels::left_going_front(const Inputs& in, std::span<Complex> out) const {
  multiply(left_of_rest_, in.rest, out);
}

void CarryingKernels::right_going_back(const Inputs& in, std::span<Complex> out) const {
  multiply(right_of_output_, in.output, out);
}

}  // namespace kolsky
