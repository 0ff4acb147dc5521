#include "drivers/simulated/bench_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace kolsky {

namespace {

/// Two faces that touch or not. The impulse of a step is what keeps them from overlapping at its
/// end, so momentum is kept exactly, and it is never a pull.
class Contact {
 public:
  Contact(Rod& before, Rod& after, double step_s)
      : before_(before), after_(after), step_s_(step_s) {}

  /// Corrects both faces' velocities. @return the force between them
  double apply() {
    const double closing = before_.back_velocity() - after_.front_velocity() - gap_m_ / step_s_;
    double force_N = 0.0;
    if (closing > 0.0) {
      const double a = before_.end_mass_kg();
      const double b = after_.end_mass_kg();
      force_N = closing * a * b / (a + b) / step_s_;
      before_.push_back(force_N);
      after_.push_front(force_N);
      gap_m_ = 0.0;
    } else {
      gap_m_ = -closing * step_s_;
    }
    return force_N;
  }

 private:
  Rod& before_;
  Rod& after_;
  double step_s_;
  double gap_m_ = 0.0;
};

/// The rods and contacts of a model while it runs.
class Line {
 public:
  Line(const BenchModel& model, double step_s) : input_(model.input, step_s) {
    if (model.specimen) {
      specimen_.emplace(*model.specimen, step_s);
    }
    if (model.output) {
      output_.emplace(*model.output, step_s);
    }
    Rod* before = &input_;
    for (Rod* after : {specimen_ ? &*specimen_ : nullptr, output_ ? &*output_ : nullptr}) {
      if (after != nullptr) {
        contacts_.emplace_back(*before, *after, step_s);
        before = after;
      }
    }
    forces_N_.resize(contacts_.size());
  }
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;

  void advance_velocities(double impact_force_N) {
    for_each_rod([](Rod& rod) { rod.advance_velocities(); });
    input_.push_front(impact_force_N);
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      forces_N_[i] = contacts_[i].apply();
    }
  }

  void advance_strains() {
    for_each_rod([](Rod& rod) { rod.advance_strains(); });
  }

  [[nodiscard]] const Rod& rod(RodId id) const {
    if (id == RodId::specimen) {
      return *specimen_;
    }
    return id == RodId::output ? *output_ : input_;
  }

  /// In the specimen's order: front, then back if an output bar holds it.
  [[nodiscard]] double contact_force_N(std::size_t index) const {
    return index < forces_N_.size() ? forces_N_[index] : 0.0;
  }

  [[nodiscard]] double momentum_kg_m_per_s() {
    double sum = 0.0;
    for_each_rod([&sum](const Rod& rod) { sum += rod.momentum_kg_m_per_s(); });
    return sum;
  }

 private:
  template <typename Action>
  void for_each_rod(Action action) {
    action(input_);
    if (specimen_) {
      action(*specimen_);
    }
    if (output_) {
      action(*output_);
    }
  }

  Rod input_;
  std::optional<Rod> specimen_;
  std::optional<Rod> output_;
  std::vector<Contact> contacts_;
  std::vector<double> forces_N_;
};

/// Collects the specimen's history; velocities belong half a step earlier than forces and strains.
class SpecimenRecorder {
 public:
  SpecimenRecorder(const BenchModel& model, double step_s)
      : shape_(*model.specimen),
        step_s_(step_s),
        arrival_s_(model.input.length_m / model.input.material.front_speed_m_per_s()) {}

  void add(std::size_t step, const Line& line) {
    const Rod& rod = line.rod(RodId::specimen);
    const double rate_half_on = (rod.front_velocity() - rod.back_velocity()) / shape_.length_m;
    const double front_N = line.contact_force_N(0);
    const double back_N = line.contact_force_N(1);
    history_.time_s.push_back(static_cast<double>(step) * step_s_ - arrival_s_);
    history_.force_front_N.push_back(front_N);
    history_.force_back_N.push_back(back_N);
    history_.stress_Pa.push_back((front_N + back_N) / (2.0 * shape_.area_m2));
    history_.strain_rate_per_s.push_back((rate_half_on + rate_before_) / 2.0);
    history_.strain.push_back(strain_);
    strain_ += rate_half_on * step_s_;
    rate_before_ = rate_half_on;
  }

  SpecimenHistory take() { return std::move(history_); }

 private:
  RodShape shape_;
  double step_s_;
  double arrival_s_;
  double strain_ = 0.0;
  double rate_before_ = 0.0;
  SpecimenHistory history_;
};

}  // namespace

double ImpactPulse::force_N(double time_s) const {
  if (time_s <= 0.0 || time_s >= duration_s) {
    return 0.0;
  }
  const double to_edge = std::min(time_s, duration_s - time_s);
  if (to_edge >= ramp_s) {
    return peak_force_N;
  }
  const double s = std::sin(std::numbers::pi / 2.0 * to_edge / ramp_s);
  return peak_force_N * s * s;
}

namespace {

double push_at(const BenchModel& model, std::size_t step, double step_s) {
  if (model.push_N.empty()) {
    return model.pulse.force_N(static_cast<double>(step) * step_s);
  }
  return step < model.push_N.size() ? model.push_N[step] : 0.0;
}

}  // namespace

BenchHistory run_bench(const BenchModel& model, double step_s, std::size_t steps) {
  Line line(model, step_s);
  std::optional<SpecimenRecorder> recorder;
  if (model.specimen) {
    recorder.emplace(model, step_s);
  }
  BenchHistory history;
  history.step_s = step_s;
  history.gauge_strain.assign(model.gauges.size(), std::vector<double>(steps, 0.0));
  for (std::size_t step = 0; step < steps; ++step) {
    for (std::size_t g = 0; g < model.gauges.size(); ++g) {
      history.gauge_strain[g][step] =
          line.rod(model.gauges[g].rod).strain_at(model.gauges[g].position_m);
    }
    line.advance_velocities(push_at(model, step, step_s));
    if (recorder) {
      recorder->add(step, line);
    }
    line.advance_strains();
  }
  if (recorder) {
    history.specimen = recorder->take();
  }
  history.momentum_kg_m_per_s = line.momentum_kg_m_per_s();
  return history;
}

}  // namespace kolsky
