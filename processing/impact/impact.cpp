#include "processing/impact/impact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "processing/base/error.hpp"
#include "processing/base/range.hpp"
#include "processing/impact/body.hpp"
#include "processing/impact/contact.hpp"
#include "processing/impact/observer.hpp"

namespace kolsky::impact {
namespace {

constexpr double kSafety = 0.85;          // of the critical step; results are the same to 0.95
constexpr double kMostSteps = 2e5;        // of a contact: 4400 on 32768 elements
constexpr double kFinest = 1e-4;          // of the critical step: what is asked for must end
constexpr double kLeastStep = 1e-3;       // of the first: a ball that is crushed takes for ever
constexpr double kPenalty = 0.4;          // of the ball's highest mode, for the nodes in contact
constexpr int kRoughly = 15;              // Lanczos steps: within a few per cent, for the penalty
constexpr int kClosely = 32;              // within a thousandth, for the step
constexpr std::size_t kSurveyEvery = 10;  // steps
constexpr double kLeftAfter_s = 20e-6;    // without a touch
constexpr double kLongest_s = 5e-3;
constexpr double kClosesWithin = 2e-3;    // of the start's energy: as good as all usual impacts
constexpr double kNoResultBeyond = 5e-2;  // force and restitution are off by as much and more
constexpr double kAtTheEdge = 0.95;       // of the way to it: where a patch begins to cross it

// To a hundredth: meshes tell no more.
std::string millimetres(double length_m) {
  return in_words(1e-2 * std::round(1e5 * length_m), "mm");
}

std::string place_of(std::size_t layer) {
  return "layers[" + std::to_string(layer) + "]";
}

Body make_ball(const ImpactModel& model, const ElementKernel& kernel) {
  std::vector<double> diameters_m;
  std::vector<Solid> solids;
  for (const Layer& layer : model.layers) {
    diameters_m.push_back(layer.outer_diameter_m);
    solids.push_back(layer.solid);
  }
  return {ball_mesh(diameters_m, model.elements), std::move(solids), kernel};
}

std::optional<Body> make_bar(const ImpactModel& model, const ElementKernel& kernel) {
  const Target& target = model.target;
  if (target.kind != TargetKind::bar) {
    return std::nullopt;
  }
  const auto across = static_cast<double>(model.bar_elements_across);
  const double size_m = 0.5 * target.diameter_m / across;
  const auto along = static_cast<std::size_t>(std::lround(target.length_m / size_m));
  return Body(bar_mesh(target.diameter_m, target.length_m, model.bar_elements_across,
                       std::max<std::size_t>(along, 2)),
              {elastic_solid(target.density_kg_m3, target.youngs_modulus_Pa, target.poisson_ratio)},
              kernel);
}

// The half of the surface that faces the target, and the one that faces away.
std::vector<std::size_t> half_surface(const Body& ball, bool front) {
  const std::vector<std::size_t>& all = ball.mesh().surface;
  const double middle_m = 0.5 * (ball.z_m(all.front()) + ball.z_m(all.back()));
  std::vector<std::size_t> half;
  for (const std::size_t node : all) {
    if ((ball.z_m(node) <= middle_m) == front) {
      half.push_back(node);
    }
  }
  return half;
}

// The cover relaxes within the first tenth of a contact: what overhangs yields as relaxed.
Edge edge_of(const ImpactModel& model) {
  if (model.target.kind == TargetKind::rigid) {
    return {};
  }
  return {0.5 * model.target.diameter_m, model.offset_m,
          model.layers.back().solid.plane_modulus_relaxed_Pa()};
}

class Run {
 public:
  Run(const ImpactModel& model, const ElementKernel& kernel)
      : model_(model),
        ball_(make_ball(model, kernel)),
        bar_(make_bar(model, kernel)),
        contact_(ball_, half_surface(ball_, true), model.friction, edge_of(model)),
        rear_contact_(ball_, half_surface(ball_, false), 0.0),
        observer_(model, ball_, longest_s()) {
    ball_.set_axial_velocity(-model.speed_m_per_s);
    rear_.sense = -1.0;
    rear_.z_m = ball_.z_m(ball_.mesh().surface.back());
    sabot_speed_ = -model.speed_m_per_s;
    find_stable_step();
    refuse_endless();
    energy_.dissipated_by_difference =
        std::any_of(model.layers.begin(), model.layers.end(), [](const Layer& layer) {
          return layer.solid.nonlinearity != 0.0 || layer.solid.law != FiniteStrain::kirchhoff;
        });
    initial_J_ =
        0.5 * (ball_.mass_kg() + model.sabot_mass_kg) * model.speed_m_per_s * model.speed_m_per_s;
  }

  ImpactHistory go(const std::function<void(const Progress&)>& progress) {
    before_s_ = next_s_ = first_s_;
    while (!finished()) {
      step();
      if (progress && survey_) {
        progress({time_s_, touch_.force_N, steps_});
      }
    }
    return conclude();
  }

 private:
  [[nodiscard]] double longest_s() const {
    return model_.duration_s > 0.0 ? model_.duration_s : kLongest_s;
  }

  void find_stable_step() {
    const double free = ball_.highest_frequency({}, kRoughly);
    contact_.set_stiffness(kPenalty * free * free * contact_.least_mass_per_area());
    rear_contact_.set_stiffness(kPenalty * free * free * rear_contact_.least_mass_per_area());
    const double ball = std::max(free, ball_.highest_frequency(contact_.springs(), kClosely));
    const double bar = bar_ ? bar_->highest_frequency({}, kClosely) : 0.0;
    critical_s_ = 2.0 / std::max(ball, bar);
    ball_share_ = ball / std::max(ball, bar);
    first_s_ = least_s_ = model_.time_step_s > 0.0 ? model_.time_step_s : kSafety * critical_s_;
    if (first_s_ > critical_s_) {
      throw InputError(
          "time_step_s",
          in_words(first_s_, "s") + " is past stability at " + when() + ", where " + narrowest() +
              " is crossed soonest",
          "give at most " + in_words(kSafety * critical_s_, "s") + ", or leave it to the solver");
    }
    if (first_s_ < kFinest * critical_s_) {
      throw InputError("time_step_s", in_words(first_s_, "s") + " would run for days",
                       "give at least " + in_words(kFinest * critical_s_, "s"));
    }
  }

  // As long as a sphere of the core's relaxed solid would touch by Hertz: within a factor of two.
  [[nodiscard]] double about_contact_s() const {
    const double radius_m = 0.5 * model_.layers.back().outer_diameter_m;
    const double stiffness =
        4.0 / 3.0 * model_.layers.front().solid.plane_modulus_relaxed_Pa() * std::sqrt(radius_m);
    const double speed = model_.speed_m_per_s;
    const double depth_m = std::pow(1.25 * ball_.mass_kg() * speed * speed / stiffness, 0.4);
    return std::min(2.943 * depth_m / speed, longest_s());
  }

  // A layer as thin as paint makes a step that no contact ends by. Who gives the step has chosen.
  void refuse_endless() const {
    const double steps = about_contact_s() / first_s_;
    if (model_.time_step_s > 0.0 || steps < kMostSteps) {
      return;
    }
    const bool by_bar = ball_share_ < 1.0;
    throw InputError(by_bar
                         ? "target.diameter_m"
                         : place_of(ball_.layer_of(ball_.soonest_crossed())) + ".outer_diameter_m",
                     "takes about " + in_words(std::round(1e-4 * steps) * 1e4, "steps") + " of " +
                         in_words(first_s_, "s") + ", as " + narrowest() + " is crossed that soon",
                     by_bar ? "give a thicker bar, or take target dashpot"
                            : "make that layer thicker or less stiff, or take fewer elements");
  }

  // The step that is stable as deformed now, by the ball's steepest element.
  void follow_deformation() {
    if (first_steepness_ == 0.0) {
      first_steepness_ = ball_.steepness_per_s2();
    }
    const double growth = std::sqrt(ball_.steepness_per_s2() / first_steepness_) * ball_share_;
    const double critical_s = critical_s_ / std::max(growth, 1.0);
    if (model_.time_step_s > 0.0) {
      if (next_s_ > critical_s) {
        throw InputError("time_step_s",
                         in_words(next_s_, "s") + " is past stability at " + when() + ", where " +
                             ball_.describe(ball_.most_squeezed()) + " is squeezed",
                         "give at most " + in_words(kSafety * critical_s, "s"));
      }
      return;
    }
    wanted_s_ = kSafety * critical_s;
    least_s_ = std::min(least_s_, wanted_s_);
    if (wanted_s_ < kLeastStep * first_s_) {
      refuse_crushed();
    }
  }

  // What bounds the step before anything moves.
  [[nodiscard]] std::string narrowest() const {
    return ball_share_ < 1.0 ? "the bar's " + bar_->describe(bar_->soonest_crossed())
                             : ball_.describe(ball_.soonest_crossed());
  }

  void refuse_crushed() const {
    throw InputError(squeezed_solid(),
                     ball_.describe(ball_.most_squeezed()) + " is crushed at " + when() +
                         ": the stable step is below a thousandth of the first",
                     std::string(model_.sabot_mass_kg > 0.0 ? "take a lighter sabot, " : "") +
                         "lower the speed or stiffen the solid");
  }

  [[nodiscard]] std::string when() const { return in_words(time_s_, "s"); }

  [[nodiscard]] std::string squeezed_solid() const {
    return place_of(ball_.layer_of(ball_.most_squeezed())) + ".solid";
  }

  // What softens gives way, whichever layer's element it turns.
  void refuse_inverted() const {
    const auto softens = [](const Layer& layer) { return layer.solid.nonlinearity < 0.0; };
    const std::size_t own = ball_.layer_of(ball_.most_squeezed());
    const auto softest = softens(model_.layers[own])
                             ? model_.layers.begin() + static_cast<std::ptrdiff_t>(own)
                             : std::find_if(model_.layers.begin(), model_.layers.end(), softens);
    const std::string problem =
        ball_.describe(ball_.most_squeezed()) + " turned inside out at " + when();
    if (softest != model_.layers.end()) {
      throw InputError(place_of(static_cast<std::size_t>(softest - model_.layers.begin())) +
                           ".solid.nonlinearity",
                       problem, "soften the solid less or lower the speed");
    }
    throw InputError(squeezed_solid(), problem,
                     "lower the speed, stiffen the solid or change the number of elements");
  }

  void step() {
    survey_ = steps_ % kSurveyEvery == 0;
    ball_.set_steps(steps_ == 0 ? 0.0 : before_s_, next_s_);
    const ElementSums ball = ball_.find_forces(survey_);
    if (!(ball.least_area_ratio > 0.0)) {
      refuse_inverted();
    }
    if (energy_.dissipated_by_difference) {
      ball_.keep_forces();
      work_J_ -= 0.5 * before_s_ * ball_.kept_power();
    }
    double bar_stored_J = 0.0;
    if (bar_) {
      bar_->set_steps(before_s_, next_s_);
      bar_stored_J = bar_->find_forces(survey_).stored_J;
    }
    touch();
    ball_.join_ties();
    const double velocity_step_s = steps_ == 0 ? 0.5 * next_s_ : 0.5 * (before_s_ + next_s_);
    energy_.dissipated_J += ball.dissipated_W * velocity_step_s;
    energy_.friction_J += touch_.friction_J;
    impulse_ += touch_.force_N * velocity_step_s;
    sabot_impulse_ += rear_touch_.force_N * velocity_step_s;
    observer_.add(time_s_, velocity_step_s, touch_, ball_, bar_ ? &*bar_ : nullptr);
    if (survey_) {
      take_stock(ball, bar_stored_J, velocity_step_s);
      follow_deformation();
    }
    ball_.advance(velocity_step_s, next_s_);
    if (energy_.dissipated_by_difference) {
      work_J_ -= 0.5 * next_s_ * ball_.kept_power();
    }
    if (bar_) {
      bar_->advance(velocity_step_s, next_s_);
    }
    move_planes(velocity_step_s);
    time_s_ += next_s_;
    ++steps_;
    before_s_ = next_s_;
    next_s_ = wanted_s_ > 0.0 ? wanted_s_ : next_s_;
  }

  void touch() {
    touch_ = bar_ ? contact_.push(ball_, *bar_) : contact_.push(ball_, plane_);
    if (model_.sabot_mass_kg > 0.0) {
      rear_touch_ = rear_contact_.push(ball_, rear_);
    }
    if (touch_.force_N > 0.0 || rear_touch_.force_N > 0.0) {
      last_touch_s_ = time_s_;
    }
  }

  void move_planes(double velocity_step_s) {
    if (model_.target.kind == TargetKind::dashpot) {
      const double speed = touch_.force_N / model_.target.impedance_kg_per_s();
      energy_.radiated_J += touch_.force_N * speed * velocity_step_s;
      plane_.z_m -= speed * next_s_;
    }
    if (model_.sabot_mass_kg > 0.0) {
      sabot_speed_ += rear_touch_.force_N / model_.sabot_mass_kg * velocity_step_s;
      rear_.z_m += sabot_speed_ * next_s_;
    }
  }

  void take_stock(const ElementSums& ball, double bar_stored_J, double velocity_step_s) {
    energy_.kinetic_J = ball_.kinetic_energy(velocity_step_s);
    energy_.stored_J = ball.stored_J;
    if (energy_.dissipated_by_difference) {
      energy_.dissipated_J = work_J_ - ball.stored_J;
    }
    energy_.contact_J = touch_.energy_J + rear_touch_.energy_J;
    energy_.sabot_J = 0.5 * model_.sabot_mass_kg * sabot_speed_ * sabot_speed_;
    if (bar_) {
      energy_.radiated_J = bar_->kinetic_energy(velocity_step_s) + bar_stored_J;
    }
    energy_.closure =
        (energy_.kinetic_J + energy_.stored_J + energy_.dissipated_J + energy_.radiated_J +
         energy_.friction_J + energy_.contact_J + energy_.sabot_J - initial_J_) /
        initial_J_;
    if (!std::isfinite(energy_.kinetic_J)) {
      refuse_inverted();
    }
    if (std::abs(energy_.closure) > std::abs(energy_.worst_closure)) {
      energy_.worst_closure = energy_.closure;
    }
  }

  [[nodiscard]] bool finished() const {
    if (model_.duration_s > 0.0) {
      return time_s_ >= model_.duration_s;
    }
    if (time_s_ > kLongest_s) {
      throw InputError("impact", "the ball has not left the target by " + when(),
                       "stiffen its solids or raise the speed");
    }
    const double seen_s = gauge_delay_s();
    return survey_ && last_touch_s_ > 0.0 && time_s_ > last_touch_s_ + kLeftAfter_s + seen_s &&
           ball_.axial_momentum() > 0.0;
  }

  [[nodiscard]] double gauge_delay_s() const {
    double furthest_m = 0.0;
    for (const double position_m : model_.gauge_positions_m) {
      furthest_m = std::max(furthest_m, position_m);
    }
    return furthest_m > 0.0 ? furthest_m / model_.target.wave_speed_m_per_s() : 0.0;
  }

  ImpactHistory conclude() {
    ImpactHistory history = observer_.history();
    const double mass = ball_.mass_kg();
    history.mass_kg = mass;
    history.impulse_N_s = impulse_;
    history.sabot_impulse_N_s = sabot_impulse_;
    history.release_time_s = last_touch_s_;
    history.rebound_speed_m_per_s = ball_.axial_momentum() / mass;
    history.restitution = history.rebound_speed_m_per_s / model_.speed_m_per_s;
    energy_.initial_J = initial_J_;
    history.energy = energy_;
    history.elements = ball_.mesh().elements();
    history.steps = steps_;
    history.first_step_s = first_s_;
    history.least_step_s = least_s_;
    refuse_open_energy(history);
    remark(history);
    return history;
  }

  [[nodiscard]] double nearest_edge_m() const {
    return model_.target.kind == TargetKind::rigid
               ? std::numeric_limits<double>::infinity()
               : 0.5 * model_.target.diameter_m - model_.offset_m;
  }

  [[nodiscard]] bool crosses_edge(const ImpactHistory& history) const {
    return history.largest_contact_radius_m > kAtTheEdge * nearest_edge_m();
  }

  // What to do about energy that does not close.
  [[nodiscard]] std::string closing_mend(const ImpactHistory& history) const {
    return crosses_edge(history)
               ? "take a rigid target, which has no edge, a wider bar or a lower speed; more "
                 "elements help a little"
               : "take more elements or a smaller time step";
  }

  [[nodiscard]] std::string closing_cause(const ImpactHistory& history) const {
    return crosses_edge(history) ? "the patch crosses the bar's edge, where points lose contact "
                                   "one by one"
                                 : "the mesh or the step is too coarse for this deformation";
  }

  [[nodiscard]] std::string closing_words() const {
    return "energy closes to " +
           in_words(1e-2 * std::round(1e4 * std::abs(energy_.worst_closure)), "%") + " only";
  }

  void refuse_open_energy(const ImpactHistory& history) const {
    if (std::abs(energy_.worst_closure) > kNoResultBeyond) {
      throw InputError("impact", closing_words() + ": " + closing_cause(history),
                       closing_mend(history));
    }
  }

  void remark_energy(ImpactHistory& history) const {
    if (std::abs(energy_.worst_closure) > kClosesWithin) {
      history.remarks.push_back(closing_words() + ", where " + in_words(1e2 * kClosesWithin, "%") +
                                " are usual: " + closing_cause(history) +
                                ", and the force may have spikes that are none; " +
                                closing_mend(history));
    }
  }

  // A dashpot stands for a bar without end: where the far end speaks while the ball touches, no
  // more.
  void remark_reflection(ImpactHistory& history) const {
    const Target& target = model_.target;
    if (target.kind != TargetKind::dashpot || !(target.length_m > 0.0)) {
      return;
    }
    const double back_s = 2.0 * target.length_m / target.wave_speed_m_per_s();
    if (back_s < history.release_time_s) {
      history.remarks.push_back(
          "the wave from the far end of a bar of " + in_words(target.length_m, "m") +
          " is back at its face after " + in_words(std::round(1e6 * back_s), "us") +
          ", while the ball still touches it: a dashpot stands for a bar without end, so force and "
          "restitution are not this bar's; take target bar");
    }
  }

  [[nodiscard]] std::string layer(std::size_t number) const {
    if (model_.layers.size() != 2) {
      return "layer " + std::to_string(number + 1);
    }
    return number == 0 ? "the core" : "the cover";
  }

  void remark(ImpactHistory& history) const {
    if (crosses_edge(history)) {
      history.remarks.push_back(
          "the contact patch comes to " + millimetres(history.largest_contact_radius_m) +
          " from the ball's axis and the bar's edge lies at " + millimetres(nearest_edge_m()));
    }
    remark_energy(history);
    remark_reflection(history);
    if (model_.offset_m > 0.0) {
      history.remarks.emplace_back(
          "off-centre contact as its mean round the axis, an estimate good to perhaps a factor of "
          "two of what it changes; the bending it puts into the bar is not computed");
    }
    for (std::size_t i = 0; i < history.falling_share.size(); ++i) {
      const Solid& solid = model_.layers[i].solid;
      if (history.falling_share[i] > 0.0) {
        history.remarks.push_back(
            in_words(0.1 * std::round(1e3 * history.falling_share[i]), "%") + " of " + layer(i) +
            " is strained beyond " + in_words(solid.falls_beyond_strain(), "") +
            ", from where on stress falls with strain at a nonlinearity of " +
            in_words(solid.nonlinearity, "") +
            ": outside of what the law allows, and what is calculated hangs on the mesh");
      }
    }
    for (std::size_t i = 0; i < history.strained_share.size(); ++i) {
      if (history.strained_share[i] > kStrainedShareToTell) {
        history.remarks.push_back(strained_words(history.strained_share[i], layer(i)));
      }
    }
  }

  const ImpactModel& model_;
  Body ball_;
  std::optional<Body> bar_;
  Contact contact_;
  Contact rear_contact_;
  Observer observer_;
  Plane plane_;
  Plane rear_;
  double sabot_speed_ = 0.0;
  double initial_J_ = 0.0;
  double impulse_ = 0.0;
  double sabot_impulse_ = 0.0;
  double work_J_ = 0.0;  // that the ball's elements took up
  EnergyLedger energy_;
  ContactSums touch_;
  ContactSums rear_touch_;
  double critical_s_ = 0.0;
  double ball_share_ = 1.0;  // of the ball's highest frequency in what bounds the step
  double first_s_ = 0.0;
  double least_s_ = 0.0;
  double first_steepness_ = 0.0;
  double wanted_s_ = 0.0;
  double before_s_ = 0.0;
  double next_s_ = 0.0;
  double time_s_ = 0.0;
  double last_touch_s_ = 0.0;
  std::size_t steps_ = 0;
  bool survey_ = false;
};

}  // namespace

std::string strained_words(double share, const std::string& layer) {
  return in_words(std::round(100.0 * share), "%") + " of " + layer +
         " is beyond a strain of 0.1 at the largest deformation: agreement here does not validate "
         "the law at small strains, nor its failure refute it";
}

ImpactHistory simulate(const ImpactModel& model,
                       const std::function<void(const Progress&)>& progress,
                       const ElementKernel& kernel) {
  check(model);
  Run run(model, kernel);
  return run.go(progress);
}

}  // namespace kolsky::impact
