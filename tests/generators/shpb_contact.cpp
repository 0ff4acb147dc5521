#include "tests/generators/shpb_contact.hpp"

#include <cmath>
#include <numbers>

namespace kolsky::testing {

namespace {

double area_of(double radius_m) {
  return std::numbers::pi * radius_m * radius_m;
}

KelvinChain bar_chain(const ShpbWorld& world) {
  return world.base.material.chain(0.0, 0.0);
}

double fading(const std::vector<double>& viscous, const KelvinStep& chain, double stress) {
  double sum = 0.0;
  for (std::size_t k = 0; k < viscous.size(); ++k) {
    sum += chain.elements()[k].keep * viscous[k] + chain.elements()[k].from_old * stress;
  }
  return sum;
}

double fresh(const KelvinStep& chain) {
  double sum = 0.0;
  for (const KelvinStep::Element& element : chain.elements()) {
    sum += element.from_new;
  }
  return sum;
}

void run_on(std::vector<double>& viscous, const KelvinStep& chain, double before, double after) {
  for (std::size_t k = 0; k < viscous.size(); ++k) {
    const KelvinStep::Element& element = chain.elements()[k];
    viscous[k] = element.keep * viscous[k] + element.from_old * before + element.from_new * after;
  }
}

// Indentation of a bar's end per force and compliance, both faces (the effects' reference).
double punch_factor(const ShpbWorld& world) {
  const double nu = world.base.material.poisson_ratio;
  const double ratio = world.specimen.diameter_m / (2.0 * world.base.radius_m);
  const double k = ratio < 1.0 ? 1.08 * std::pow(1.0 - ratio, 1.3) : 0.0;
  return world.specimen.punching * 2.0 * k * (1.0 - nu * nu) / world.specimen.diameter_m;
}

}  // namespace

MasslessSpecimen::MasslessSpecimen(const ShpbWorld& world, double step_s)
    : specimen_(world.specimen),
      bar_area_m2_(area_of(world.base.radius_m)),
      step_s_(step_s),
      chain_(world.specimen.chain(), step_s),
      punch_chain_(bar_chain(world), step_s),
      punch_m_per_N_Pa_(punch_factor(world)),
      viscous_(chain_.elements().size(), 0.0),
      punch_viscous_(punch_chain_.elements().size(), 0.0) {}

MasslessSpecimen::Trial MasslessSpecimen::at(double strain) const {
  Trial trial{};
  // Backward differences of second order: the rates die with the motion.
  trial.strain_rate = (3.0 * strain - 4.0 * strain_ + strain_before_) / (2.0 * step_s_);
  const double acceleration =
      (2.0 * strain - 5.0 * strain_ + 4.0 * strain_before_ - strain_before_that_) /
      (step_s_ * step_s_);
  const double sprung = strain - fading(viscous_, chain_, stress_) -
                        specimen_.permanent_strain * std::max(0.0, largest_strain_ - strain);
  // The work depends on the stress by a step's share only: twice is enough.
  trial.stress = stress_;
  for (int round = 0; round < 2; ++round) {
    const double softer = 1.0 + specimen_.softening_m3_per_J * work_by(strain, trial.stress);
    const double spring = chain_.glassy_Pa() * (1.0 + specimen_.nonlinearity * strain) / softer;
    trial.stress = spring * sprung / (1.0 + spring * fresh(chain_));
  }
  const double shorter = 1.0 - strain;
  const double friction = 1.0 + specimen_.friction * specimen_.diameter_m / std::sqrt(shorter) /
                                    (3.0 * specimen_.length_m * shorter);
  const double a = 0.5 * specimen_.diameter_m;
  const double lateral = specimen_.radial_inertia * 4.0 * specimen_.poisson_ratio *
                         specimen_.poisson_ratio * specimen_.density_kg_m3 * a * a *
                         (acceleration / 8.0 + trial.strain_rate * trial.strain_rate / 16.0);
  trial.force_N = specimen_.area_m2() * (trial.stress * friction + lateral);
  return trial;
}

double MasslessSpecimen::work_by(double strain, double stress) const {
  return work_J_per_m3_ + 0.5 * (stress_ + stress) * (strain - strain_);
}

double MasslessSpecimen::extra_shortening(double force_N) const {
  double extra = specimen_.gap_m;  // closed by now
  if (punch_m_per_N_Pa_ != 0.0) {
    extra += punch_m_per_N_Pa_ * (force_N * (1.0 / punch_chain_.glassy_Pa() + fresh(punch_chain_)) +
                                  fading(punch_viscous_, punch_chain_, force_N_));
  }
  extra += specimen_.face_layer_m_per_N * force_N / (1.0 + std::abs(force_N) / 100.0);
  return extra;
}

void MasslessSpecimen::settle(const Trial& trial, double strain, double shortening,
                              double shortening_rate) {
  run_on(viscous_, chain_, stress_, trial.stress);
  run_on(punch_viscous_, punch_chain_, force_N_, trial.force_N);
  work_J_per_m3_ = work_by(strain, trial.stress);
  stress_ = trial.stress;
  force_N_ = trial.force_N;
  strain_before_that_ = strain_before_;
  strain_before_ = strain_;
  strain_ = strain;
  largest_strain_ = std::max(largest_strain_, strain);
  shortening_ = shortening;
  shortening_rate_ = shortening_rate;
}

void MasslessSpecimen::close(Rod& input, Rod& output) {
  const Rod::EndRelation in = input.right();
  const Rod::EndRelation out = output.left();
  const auto rate_at = [&](double force_N) {
    const double stress = force_N / bar_area_m2_;
    return (in.free - stress) / in.slope - (stress - out.free) / out.slope;
  };
  const auto shortening_at = [&](double force_N) {
    return shortening_ + 0.5 * step_s_ * (shortening_rate_ + rate_at(force_N));
  };
  const auto stay_apart = [&](double strain) {
    input.close_right(0.0);
    output.close_left(0.0);
    settle({0.0, 0.0, 0.0}, strain, shortening_at(0.0), rate_at(0.0));
  };
  if (!specimen_.dry && !closed_ && shortening_at(0.0) < specimen_.gap_m) {
    stay_apart(0.0);
    return;
  }
  closed_ = true;
  // What the specimen's strain leaves over of the faces' approach.
  const auto residual = [&](double strain) {
    const double force_N = at(strain).force_N;
    return strain * specimen_.length_m + extra_shortening(force_N) - shortening_at(force_N);
  };
  double last = strain_;
  double strain = strain_ + step_s_ * shortening_rate_ / specimen_.length_m + 1e-9;
  double residual_last = residual(last);
  for (int round = 0; round < 60; ++round) {
    const double now = residual(strain);
    if (std::abs(now) < 1e-17 || now == residual_last) {
      break;
    }
    const double next = strain - now * (strain - last) / (now - residual_last);
    last = strain;
    residual_last = now;
    strain = next;
    if (std::abs(strain - last) < 1e-16) {
      break;
    }
  }
  const Trial trial = at(strain);
  if (specimen_.dry && trial.force_N < 0.0) {
    stay_apart(fading(viscous_, chain_, stress_));
    return;
  }
  input.close_right(trial.force_N / bar_area_m2_);
  output.close_left(trial.force_N / bar_area_m2_);
  settle(trial, strain, shortening_at(trial.force_N), rate_at(trial.force_N));
}

WavySpecimen::WavySpecimen(const ShpbWorld& world, int cells)
    : rod_(world.specimen.chain(), world.specimen.inertia * world.specimen.density_kg_m3,
           world.specimen.length_m, cells),
      area_share_(world.specimen.area_m2() / area_of(world.base.radius_m)),
      bar_area_m2_(area_of(world.base.radius_m)),
      length_m_(world.specimen.length_m) {}

void WavySpecimen::close(Rod& input, Rod& output) {
  rod_.advance();
  // At each face: force and velocity are shared.
  const auto front_in = input.right();
  const auto front = rod_.left();
  const double v_front =
      (front_in.free - area_share_ * front.free) / (front_in.slope + area_share_ * front.slope);
  const double stress_in = front_in.free - front_in.slope * v_front;
  input.close_right(stress_in);
  rod_.close_left(stress_in / area_share_);
  const auto back = rod_.right();
  const auto back_out = output.left();
  const double v_back =
      (area_share_ * back.free - back_out.free) / (back_out.slope + area_share_ * back.slope);
  const double stress_out = back_out.free + back_out.slope * v_back;
  rod_.close_right(stress_out / area_share_);
  output.close_left(stress_out);
  const double step_s = rod_.step_s();
  strain_ += (v_front - v_back) * step_s / length_m_;
  force_N_ = stress_out * bar_area_m2_;
}

}  // namespace kolsky::testing
