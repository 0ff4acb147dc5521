#include "processing/reduction/ball/ball_pass.hpp"

#include <cmath>

#include "processing/reduction/ball/ball_flight.hpp"
#include "processing/reduction/ball/ball_quality.hpp"
#include "processing/reduction/ball/ball_speeds.hpp"
#include "processing/reduction/ball/ball_stations.hpp"
#include "processing/reduction/quality.hpp"

namespace kolsky {

BallPass::BallPass(const Shot& shot, const std::vector<BarStation>& stations,
                   const ReductionOptions& options, BallPlans& plans, BallKernels& kernels)
    : shot_(shot),
      bar_(shot.bench.input),
      stations_(stations),
      options_(options),
      t_(plans),
      kernels_(kernels),
      rate_Hz_(shot.rate.Hz()),
      period_s_(shot.rate.period_s()),
      front_speed_m_per_s_(front_speed(bar_)) {}

double BallPass::front_speed(const Bar& bar) {
  return std::sqrt(*bar.youngs_modulus_Pa / bar.density_kg_m3);
}

Reduction BallPass::run() {
  if (!find_wave()) {
    return not_reducible(
        "no wave stands out of the noise on " + names_of(stations_[0], shot_.bench),
        "give a shot's whole record, from before the impact, with that gauge's bridge supplied");
  }
  if (!read_strains()) {
    return not_reducible("a reading is beyond what its gauge's bridge can give",
                         "check the gauge's excitation_V and gain in the bench");
  }
  choose_band();
  find_forces();
  weigh(std::vector<bool>(stations_.size(), true), best_);
  if (!locate_touch(best_)) {
    return not_reducible("the first wave is tensile: a ball only pushes",
                         "check `positive`, and that the baseline before the wave is level");
  }
  choose_stations();
  if (!locate_touch(force_) || !holds_push()) {
    return not_reducible("the record ends before the ball has pushed", "record for longer");
  }
  fill_history();
  measure();
  const BallFlight flight = ball_flight(shot_, reduction_.arrival_s);
  speed_problem_ = flight.problem;
  set_speeds(flight, shot_.bench.ball ? shot_.bench.ball->mass_kg : std::nullopt, *reduction_.ball);
  judge_quality();
  return std::move(reduction_);
}

double BallPass::travel_samples(double distance_m) const {
  return distance_m / front_speed_m_per_s_ * rate_Hz_;
}

double BallPass::clean_samples(const BarStation& station) const {
  return 2.0 * travel_samples(station.gauge_to_far_end_m);
}

void BallPass::judge_quality() {
  reduction_.bar_model = "elastic bar, modulus from the bench";
  judge({.peak_over_noise = peak_over_noise_,
         .contact_end_s = contact_end_s_,
         .after_contact_N = after_contact_N_,
         .after_contact_sd_N = after_contact_sd_N_,
         .band_loss = band_loss_,
         .speed_problem = speed_problem_,
         .flat_top = longest_flat_top(shot_)},
        reduction_);
}

}  // namespace kolsky
