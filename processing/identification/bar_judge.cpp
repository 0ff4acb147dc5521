#include "processing/identification/bar_judge.hpp"

#include <algorithm>

namespace kolsky {

BarJudge::BarJudge(const BarData& data)
    : data_(data),
      slow_(data.places().samples, data.places().period_s),
      plain_(data.places().judged(), data.places().period_s, 1.0),
      slow_spectrum_(slow_.bins()),
      plain_spectrum_(plain_.bins()),
      slow_record_(slow_.length()) {}

std::size_t BarJudge::carried() const {
  return std::min(data_.path().size(), slow_spectrum_.size());
}

std::span<const double> BarJudge::slow_in_time() {
  const std::span<double> record(slow_record_.data(), data_.places().judged_end);
  slow_.inverse({slow_spectrum_.data(), carried()}, record);
  return record;
}

void BarJudge::judge(std::span<const double> in_time, std::span<Complex> judged) {
  const std::span<Complex> spectrum(plain_spectrum_.data(), judged.size() + 1);
  plain_.forward(in_time.subspan(data_.places().judged_begin), spectrum);
  for (std::size_t k = 0; k < judged.size(); ++k) {
    judged[k] = spectrum[k + 1] * data_.undo_filter(k);
  }
}

std::span<const double> BarJudge::in_time(std::span<const Complex> damped) {
  const double scale = 1.0 / data_.places().samples_per_place;
  for (std::size_t k = 0; k < carried(); ++k) {
    slow_spectrum_[k] = damped[k] * scale;
  }
  return slow_in_time();
}

void BarJudge::judge(std::span<const Complex> damped, std::span<Complex> judged) {
  judge(in_time(damped), judged);
}

void BarJudge::judge_product(std::span<const Complex> a, std::span<const Complex> b,
                             std::span<Complex> judged) {
  const double scale = 1.0 / data_.places().samples_per_place;
  for (std::size_t k = 0; k < carried(); ++k) {
    slow_spectrum_[k] = a[k] * b[k] * scale;
  }
  judge(slow_in_time(), judged);
}

}  // namespace kolsky
