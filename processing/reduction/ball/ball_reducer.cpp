#include "processing/reduction/ball/ball_reducer.hpp"

#include <algorithm>
#include <cmath>

#include "processing/base/error.hpp"
#include "processing/reduction/ball/ball_pass.hpp"
#include "processing/reduction/ball/ball_stations.hpp"
#include "processing/reduction/quality.hpp"
#include "processing/reduction/recent.hpp"
#include "processing/waves/seen_modes.hpp"

namespace kolsky {

namespace {

void require_bench(const Shot& shot) {
  if (!shot.bench.input.youngs_modulus_Pa) {
    throw InputError("bars.input.youngs_modulus_Pa",
                     "is missing: the ball's force is taken from an elastic bar",
                     "give the bar's modulus");
  }
  const std::size_t channels = shot.bench.channels().size();
  if (shot.channels.size() != channels) {
    throw InputError("gauges",
                     std::to_string(channels) + " channels are filed but the shot has " +
                         std::to_string(shot.channels.size()),
                     "file one gauge per channel, then the photo-sensors, in their order");
  }
}

/// Rounded up, so that benches that differ a little share their plans.
std::size_t rounded_up(double samples) {
  constexpr std::size_t kStep = 32;
  return (static_cast<std::size_t>(std::ceil(samples)) + kStep) / kStep * kStep;
}

}  // namespace

struct BallReducer::State {
  Recent<BallPlans> plans;
  Recent<BallKernels> kernels;
};

BallReducer::BallReducer() : state_(std::make_unique<State>()) {}
BallReducer::~BallReducer() = default;

Reduction BallReducer::reduce(const Shot& shot, const ReductionOptions& options) {
  require_bench(shot);
  const std::string unusable = unusable_because(shot);
  if (!unusable.empty()) {
    return not_reducible(unusable, kRepeatOrLeaveOut);
  }
  const std::vector<BarStation> stations = stations_by_position(shot.bench);
  const Bar& bar = shot.bench.input;
  const double samples_per_m = shot.rate.Hz() / BallPass::front_speed(bar);
  const BallPlanKey key{
      shot.samples(), shot.rate,
      rounded_up(slowest_over_front(options.theory) * stations.back().gauge_to_specimen_m *
                 samples_per_m),
      std::min(shot.samples(),
               rounded_up(2.0 * stations.front().gauge_to_far_end_m * samples_per_m))};
  BallPlans& plans = state_->plans.get([&](const BallPlans& known) { return known.key == key; },
                                       [&] { return std::make_unique<BallPlans>(key); });
  std::vector<double> numbers = ball_kernel_numbers(bar, options.theory, stations);
  BallKernels& kernels = state_->kernels.get(
      [&](const BallKernels& known) { return known.numbers == numbers && known.key == key; },
      [&] {
        return std::make_unique<BallKernels>(BallKernels{std::move(numbers), key, {}});
      });
  return BallPass(shot, stations, options, plans, kernels).run();
}

}  // namespace kolsky
