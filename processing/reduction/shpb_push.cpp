#include "processing/reduction/shpb_pass.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace kolsky {

namespace {

/// Noise's deviations beyond which something is not its account.
constexpr double kStandsOut = 3.0;

}  // namespace

std::size_t ShpbPass::few_of(std::size_t samples) const {
  constexpr double kFew_s = 10e-6;
  return std::min(samples, static_cast<std::size_t>(kFew_s * rate_Hz_) + 1);
}

double ShpbPass::noise_of_few(std::size_t few) const {
  return kStandsOut * input_noise_ / std::sqrt(static_cast<double>(std::max<std::size_t>(few, 1)));
}

std::span<const double> ShpbPass::pulse_without_cut() {
  const std::span<const double> pulse = pulse_as_read();
  const std::size_t few = few_of(pulse.size());
  const std::span<const double> last = pulse.last(few);
  const double left = std::accumulate(last.begin(), last.end(), 0.0) /
                      static_cast<double>(std::max<std::size_t>(few, 1));
  if (std::abs(left) <= noise_of_few(few)) {
    return pulse;
  }
  const double turn = std::numbers::pi / static_cast<double>(pulse.size());
  for (std::size_t n = 0; n < pulse.size(); ++n) {
    t_.scratch[n] = pulse[n] - left / 2.0 * (1.0 - std::cos(turn * static_cast<double>(n)));
  }
  return std::span<const double>(t_.scratch).first(pulse.size());
}

void ShpbPass::complete_incident() {
  const std::span<Complex> incident = in_band(t_.incident);
  t_.transform.forward(incident_strain(), incident);
  t_.band.apply_half(reduction_.band_limit_Hz, incident);
  bars_.kernels.push_from_incident(incident);
  const double known =
      static_cast<double>(split_) - BandLimit::smear_s(reduction_.band_limit_Hz) * rate_Hz_;
  push_end_ = std::min(static_cast<std::size_t>(std::max(0.0, known)), shot_.samples());
  const std::span<double> push = std::span(t_.history).first(shot_.samples());
  t_.transform.inverse(incident, push.first(push_end_));
  judge_push(push.first(push_end_));
  let_push_go_on(push, options_.push_goes_on * push_left_Pa_);
  incident_from_push(push, incident);
}

double ShpbPass::moved_by_lateral_inertia(std::span<const double> pulse) const {
  const Bar& bar = shot_.bench.input;
  const double nu_a_m = bar.poisson_ratio.value * bar.diameter_m.value / 2.0;
  const double moved =
      t_.band.weighed_energy(pulse, input_noise_, reduction_.band_limit_Hz, [&](double f_Hz) {
        const double wavenumber_per_m = 2.0 * std::numbers::pi * f_Hz / wave_speed_m_per_s();
        const double love = std::sqrt(1.0 + std::pow(nu_a_m * wavenumber_per_m, 2) / 2.0);
        const double turn = wavenumber_per_m * (love - 1.0) * in_.gauge_to_specimen_m;
        return std::norm(std::polar(1.0, turn) - 1.0);
      });
  const std::span<const double> whole = pulse_as_read();
  const double all = std::inner_product(whole.begin(), whole.end(), whole.begin(), 0.0);
  return all > 0.0 ? std::sqrt(moved / all) : 0.0;
}

double ShpbPass::longest_gauge_m() const {
  double longest_m = 0.0;
  for (const BarStation* station : {&in_, &out_}) {
    for (const std::size_t channel : station->channels) {
      longest_m =
          std::max(longest_m, shot_.bench.gauges[channel].length_m.value_or(Measured{}).value);
    }
  }
  return longest_m;
}

double ShpbPass::lost_in_gauge_length(std::span<const double> pulse) const {
  const double half_m = longest_gauge_m() / 2.0;
  if (half_m == 0.0) {
    return 0.0;
  }
  const auto energy = [&](const std::function<double(double)>& weight) {
    return t_.band.weighed_energy(pulse, input_noise_, reduction_.band_limit_Hz, weight);
  };
  const double lost = energy([&](double f_Hz) {
    const double turn = 2.0 * std::numbers::pi * f_Hz / wave_speed_m_per_s() * half_m;
    return turn > 0.0 ? std::pow(f_Hz * (1.0 - std::sin(turn) / turn), 2) : 0.0;
  });
  const double rate = energy([](double f_Hz) { return f_Hz * f_Hz; });
  return rate > 0.0 ? std::sqrt(lost / rate) : 0.0;
}

void ShpbPass::let_push_go_on(std::span<double> push_Pa, double stress_Pa) const {
  const std::span<double> behind = push_Pa.subspan(push_end_);
  const auto known =
      static_cast<std::size_t>(std::max(0.0, static_cast<double>(push_end_) - gauge_foot_));
  const auto end = behind.begin() + static_cast<std::ptrdiff_t>(std::min(known, behind.size()));
  std::fill(behind.begin(), end, stress_Pa);
  std::fill(end, behind.end(), 0.0);
}

void ShpbPass::incident_from_push(std::span<const double> push_Pa, std::span<Complex> incident) {
  t_.transform.forward(push_Pa, incident);
  bars_.kernels.incident_from_push(incident);
  t_.band.apply_half(reduction_.band_limit_Hz, incident);
}

void ShpbPass::judge_push(std::span<const double> push) {
  const std::size_t few = few_of(push.size());
  for (const double stress_Pa : push.last(few)) {
    push_left_Pa_ += stress_Pa / static_cast<double>(few);
  }
  push_peak_Pa_ = largest(push);
  push_left_share_ = push_peak_Pa_ > 0.0 ? std::abs(push_left_Pa_) / push_peak_Pa_ : 1.0;
  // Less than that is the noise's account.
  push_noise_share_ = noise_of_few(few) / std::max(largest(incident_strain()), 1e-300);
  if (push_left_share_ > push_noise_share_) {
    reduction_.push_left_share = push_left_share_;
  }
}

bool ShpbPass::push_still_rises() const {
  constexpr double kRises = 1.15;
  constexpr double kLeastOfPeak = 0.6;
  const std::span<const double> push =
      incident_strain().subspan(static_cast<std::size_t>(std::max(0.0, gauge_foot_)));
  const std::size_t fifth = push.size() / 5;
  if (fifth == 0) {
    return true;
  }
  const auto mean = [&](std::span<const double> part) {
    return sense_ * std::accumulate(part.begin(), part.end(), 0.0) / static_cast<double>(fifth);
  };
  const double last = mean(push.last(fifth));
  const double before = mean(push.last(2 * fifth).first(fifth));
  const double noise = input_noise_ * std::sqrt(2.0 / static_cast<double>(fifth));
  return last > kLeastOfPeak * largest(push) && last > kRises * before &&
         last - before > kStandsOut * noise;
}

void ShpbPass::weigh_hidden_push() {
  if (push_left_share_ <= push_noise_share_) {
    return;
  }
  const std::size_t begin = std::min(t_.scratch.size(), first_of_histories() + t_.key.delay);
  const auto many = static_cast<std::size_t>(first_return_s() * rate_Hz_);
  const std::size_t count = std::min(many, t_.scratch.size() - begin);
  const std::span<const double> rate = strain_rate().subspan(begin, count);
  double strain = 0.0;
  double most = 0.0;
  std::size_t end = 0;
  for (std::size_t n = 0; n < count; ++n) {
    strain += sense_ * rate[n];
    if (strain > most) {
      most = strain;
      end = n + 1;
    }
  }
  const std::span<double> push = std::span(t_.scratch).first(shot_.samples());
  std::fill(push.begin(), push.begin() + static_cast<std::ptrdiff_t>(push_end_), 0.0);
  let_push_go_on(push, push_peak_Pa_);
  const std::span<Complex> hidden = in_band(t_.hidden);
  incident_from_push(push, hidden);
  std::transform(hidden.begin(), hidden.end(), t_.hidden_in_rest.begin(),
                 [](Complex value) { return -value; });
  bars_.kernels.rate_of_front({hidden, in_band(t_.hidden_in_rest), {}}, in_band(t_.work));
  const std::span<double> of_hidden = std::span(t_.scratch).first(end);
  t_.transform.inverse(in_band(t_.work), of_hidden, begin);
  const double missing = std::accumulate(of_hidden.begin(), of_hidden.end(), 0.0);
  strain_per_push_ = most > 0.0 ? std::abs(missing) / most : 1.0;
}

double ShpbPass::overlap_limit() const {
  return strain_per_push_
             ? std::max(kOverlapLimit / std::max(1.0, *strain_per_push_), push_noise_share_)
             : push_noise_share_;
}

}  // namespace kolsky
