#include "processing/reduction/shpb_pass.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "processing/reduction/loop_summary.hpp"
#include "processing/reduction/plausibility.hpp"
#include "processing/reduction/quiet_drift.hpp"

namespace kolsky {

void ShpbPass::judge_quality() {
  QualityInputs q;
  q.input_peak = largest(incident_strain());
  q.input_noise_rms = input_noise_;
  const auto travel =
      static_cast<std::size_t>((bars_.input.front_time_s(in_.gauge_to_specimen_m) +
                                bars_.output.front_time_s(out_.gauge_to_specimen_m)) *
                               rate_Hz_);
  const std::size_t begin =
      std::min(static_cast<std::size_t>(gauge_foot_) + travel, shot_.samples());
  const std::size_t end = std::min(begin + count_, shot_.samples());
  q.output_peak = largest(std::span<const double>(t_.output_strain).subspan(begin, end - begin));
  q.output_noise_rms = output_noise_;
  q.push_left_share = push_left_share_;
  q.push_limit = overlap_limit();
  q.gauge_to_specimen_m = in_.gauge_to_specimen_m;
  q.wave_speed_m_per_s = wave_speed_m_per_s();
  q.strain_per_push = strain_per_push_.value_or(0.0);
  q.returns_from_s = 2.0 * std::min(bars_.input.front_time_s(in_.gauge_to_far_end_m),
                                    far_end_time_s(out_.gauge_to_far_end_m));
  q.may_shorten = !options_.duration_s;
  q.missing_s = missing_s_;
  q.flat_top = longest_flat_top(shot_);
  reduction_.quiet_samples = faces_ ? faces_->quiet : quiet_;
  const Specimen& specimen = *shot_.bench.specimen;
  q.front_rate_per_s = front_rate_per_s_;
  q.specimen_length_m = specimen.length_m;
  if (specimen.density_kg_m3) {
    q.specimen_mass_kg = *specimen.density_kg_m3 * specimen.area_m2() * specimen.length_m;
  }
  q.band_loss = band_loss_;
  q.moved_by_lateral_inertia = moved_by_lateral_inertia_;
  q.lost_in_gauge_length = lost_in_gauge_length_;
  q.gauge_length_m = longest_gauge_m();
  q.arrival_late_s = arrival_late_s_;
  q.way_to_specimen_s = bars_.input.front_time_s(in_.gauge_to_specimen_m);
  if (faces_) {
    q.separated = separation_judgement();
  }
  reduction_.quality.reducible = true;
  judge(q, reduction_);
  judge_sizes(q.input_peak);
  if (auto drift = quiet_drift(shot_, reduction_.quiet_samples, end)) {
    reduction_.quality.checks.push_back(*std::move(drift));
  }
}

void ShpbPass::judge_sizes(double incident_peak) {
  auto& checks = reduction_.quality.checks;
  const auto add = [&](std::optional<Check> check) {
    if (check) {
      checks.push_back(*std::move(check));
    }
  };
  // One check of a name: the bar that is further off.
  auto input = impossible_bar_strain(shot_, in_, t_.input_strain);
  auto output = impossible_bar_strain(shot_, out_, t_.output_strain);
  add(input && !(output && output->value > input->value) ? std::move(input) : std::move(output));
  add(impossible_specimen_strain(reduction_));
  add(striker_speed(shot_, in_, incident_peak, wave_speed_m_per_s()));
}

SeparationJudgement ShpbPass::separation_judgement() const {
  SeparationJudgement judgement;
  const std::size_t last = first_ + count_ - 1;
  const double peak = largest(reduction_.force_front_N);
  judgement.gauges = faces_->gauges;
  judgement.noise_share = peak > 0.0 ? faces_->front_noise_N[last] / peak : 1.0;
  judgement.blind_Hz = faces_->blind_Hz;
  const auto begin = faces_->front_noise_N.begin() + static_cast<std::ptrdiff_t>(first_);
  judgement.front_noise_N.assign(begin, begin + static_cast<std::ptrdiff_t>(count_));
  judgement.assumes_equilibrium = reduction_.separation == Separation::equilibrium;
  judgement.ends_in_loading = first_loading_end(*faces_, first_) >= faces_->known;
  return judgement;
}

double ShpbPass::assumed_from_s() const {
  constexpr double kCrossings = 4.0;
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  if (reduction_.separation != Separation::equilibrium) {
    return 0.0;
  }
  const Specimen& specimen = *shot_.bench.specimen;
  const auto end =
      reduction_.stress_Pa.begin() + static_cast<std::ptrdiff_t>(loading_end(reduction_));
  const auto peak = std::max_element(reduction_.stress_Pa.begin(), end,
                                     [](double a, double b) { return std::abs(a) < std::abs(b); });
  const double modulus_Pa =
      *peak / reduction_.strain[static_cast<std::size_t>(peak - reduction_.stress_Pa.begin())];
  if (!specimen.density_kg_m3 || !(modulus_Pa > 0.0)) {
    return kUnknown;
  }
  return kCrossings * specimen.length_m / std::sqrt(modulus_Pa / *specimen.density_kg_m3);
}

}  // namespace kolsky
