#include "processing/reduction/shpb_pass.hpp"

#include <algorithm>

namespace kolsky {

CarryingKernels::Inputs ShpbPass::inputs() {
  return {in_band(t_.incident), in_band(t_.rest), in_band(t_.output_spectrum)};
}

void ShpbPass::carry(Kernel kernel, std::span<double> history, std::size_t first) {
  (bars_.kernels.*kernel)(inputs(), in_band(t_.work));
  t_.transform.inverse(in_band(t_.work), history, first);
}

std::span<const double> ShpbPass::strain_rate() {
  if (!strain_rate_known_) {
    carry(&CarryingKernels::strain_rate, t_.strain_rate);
    strain_rate_known_ = true;
  }
  return t_.strain_rate;
}

std::vector<double> ShpbPass::history(Kernel kernel) {
  std::vector<double> cut(count_);
  carry(kernel, cut, first_ + t_.key.delay);
  return cut;
}

std::vector<double> ShpbPass::window() const {
  const auto begin = t_.history.begin() + static_cast<std::ptrdiff_t>(first_ + t_.key.delay);
  return {begin, begin + static_cast<std::ptrdiff_t>(count_)};
}

void ShpbPass::fill_histories() {
  reduction_.incident = window();
  reduction_.force_front_N = history(&CarryingKernels::force_front);
  reduction_.force_back_N = history(&CarryingKernels::force_back);
  reduction_.reflected = history(&CarryingKernels::left_going_front);
  reduction_.transmitted = history(&CarryingKernels::right_going_back);
  front_rate_per_s_ = history(&CarryingKernels::rate_of_front);
  const std::span<const double> rate = strain_rate().subspan(t_.key.delay, shot_.samples());
  const std::span<const double> seen = rate.subspan(first_, count_);
  reduction_.strain_rate_per_s.assign(seen.begin(), seen.end());
  strain_before_ = strain_before_window(rate);
}

void ShpbPass::take_separated() {
  const auto window_of = [&](const std::vector<double>& whole) {
    const auto begin = whole.begin() + static_cast<std::ptrdiff_t>(first_);
    return std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(count_));
  };
  reduction_.incident = window_of(faces_->incident);
  reduction_.reflected = window_of(faces_->reflected);
  reduction_.transmitted = window_of(faces_->transmitted);
  reduction_.force_front_N = window_of(faces_->force_front_N);
  reduction_.force_back_N = window_of(faces_->force_back_N);
  front_rate_per_s_ = window_of(faces_->rate_of_front_per_s);
  reduction_.strain_rate_per_s = window_of(faces_->strain_rate_per_s);
  strain_before_ = strain_before_window(faces_->strain_rate_per_s);
}

void ShpbPass::fill_strain() {
  reduction_.time_s.resize(count_);
  reduction_.stress_Pa.resize(count_);
  reduction_.strain.resize(count_);
  double strain = strain_before_;
  for (std::size_t n = 0; n < count_; ++n) {
    reduction_.time_s[n] = static_cast<double>(first_ + n) * period_s_ - reduction_.arrival_s;
    reduction_.strain[n] = strain;
    if (n + 1 < count_) {
      strain +=
          period_s_ * (reduction_.strain_rate_per_s[n] + reduction_.strain_rate_per_s[n + 1]) / 2.0;
    }
  }
}

double ShpbPass::strain_before_window(std::span<const double> rate) const {
  const double lead = 2.0 * BandLimit::smear_s(reduction_.band_limit_Hz) * rate_Hz_;
  const auto begin = static_cast<std::size_t>(std::max(0.0, static_cast<double>(first_) - lead));
  double strain = 0.0;
  for (std::size_t n = begin; n < first_; ++n) {
    strain += period_s_ * (rate[n] + rate[n + 1]) / 2.0;
  }
  return strain;
}

}  // namespace kolsky
