#include "processing/reduction/shpb_pass.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kolsky {

void ShpbPass::locate_arrival() {
  carry(&CarryingKernels::right_going_front, t_.history);
  const double travel = bars_.input.front_time_s(in_.gauge_to_specimen_m) * rate_Hz_;
  Foot foot{.index = gauge_foot_ + travel};
  if (!options_.arrival_s && foot_is_rounded_) {
    foot = first_foot(t_.input_strain, gauge_foot_, static_cast<double>(split_), input_noise_);
    foot.index += travel;
  } else if (!options_.arrival_s) {
    const double late = travel + static_cast<double>(t_.key.delay);
    foot = first_foot(t_.history, gauge_foot_ + late, static_cast<double>(split_) + late,
                      input_noise_ * t_.band.noise_share(reduction_.band_limit_Hz));
    foot.index -= static_cast<double>(t_.key.delay);
  }
  reduction_.arrival_s = foot.index * period_s_;
  reduction_.arrival_sigma_s = foot.sigma * period_s_;
}

Foot ShpbPass::first_foot(std::span<const double> record, double from, double to,
                          double noise_rms) {
  const auto begin = static_cast<std::size_t>(from);
  const std::size_t end = std::min(record.size(), static_cast<std::size_t>(to));
  for (std::size_t n = 0; n < end; ++n) {
    t_.scratch[n] = sense_ * record[n];
  }
  const std::span<const double> pulse(t_.scratch.data(), end);
  const auto peak =
      std::max_element(pulse.begin() + static_cast<std::ptrdiff_t>(begin), pulse.end());
  auto half = static_cast<std::size_t>(peak - pulse.begin());
  while (half > 0 && pulse[half] > *peak / 2.0) {
    --half;
  }
  return foot_of(pulse, half, *peak, noise_rms);
}

void ShpbPass::separate() {
  Separation how = options_.separation;
  if (how == Separation::as_needed) {
    how = push_left_share_ > overlap_limit() && gauges_at_two_places(shot_.bench, "input")
              ? Separation::gauges
              : Separation::never;
  }
  reduction_.separation = how;
  if (how != Separation::never) {
    faces_ = separated_faces(shot_, bars_, how, quiet_, reduction_.band_limit_Hz);
  }
}

bool ShpbPass::choose_window() {
  const double arrival = reduction_.arrival_s * rate_Hz_;
  first_ = first_of_histories();
  const double duration_s =
      options_.duration_s.value_or(std::max(first_return_s(), first_loading_s()));
  // A wave that is under a gauge where the record ends is cut there, a step, and the filter looks
  // ahead.
  const double ahead = BandLimit::reach_s(reduction_.band_limit_Hz) * rate_Hz_;
  const double wanted = arrival + duration_s * rate_Hz_;
  const double last = std::min(wanted, known_samples() - ahead);
  missing_s_ = (wanted - last) * period_s_;
  if (last < arrival + kFewestSamples) {
    return false;
  }
  count_ = static_cast<std::size_t>(last) - first_;
  return true;
}

std::size_t ShpbPass::first_of_histories() const {
  return static_cast<std::size_t>(std::ceil(reduction_.arrival_s * rate_Hz_));
}

double ShpbPass::first_return_s() const {
  return 2.0 * std::min(bars_.input.front_time_s(shot_.bench.input.length_m),
                        far_end_time_s(shot_.bench.output->length_m));
}

double ShpbPass::known_samples() const {
  if (faces_) {
    return static_cast<double>(faces_->known);
  }
  const auto path = std::span(t_.path);
  const double travel_s = std::max(bars_.input.travel_s(path, reduction_.band_limit_Hz),
                                   bars_.output.travel_s(path, reduction_.band_limit_Hz));
  return static_cast<double>(shot_.samples()) - std::ceil(travel_s * rate_Hz_);
}

double ShpbPass::first_loading_s() const {
  if (!faces_) {
    return 0.0;
  }
  const auto end = static_cast<double>(first_loading_end(*faces_, first_));
  return (end - static_cast<double>(first_)) * period_s_;
}

double ShpbPass::far_end_time_s(double distance_m) const {
  return bars_.output.waves.far_end == FarEnd::free ? bars_.output.front_time_s(distance_m)
                                                    : std::numeric_limits<double>::infinity();
}

}  // namespace kolsky
