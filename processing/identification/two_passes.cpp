#include "processing/identification/two_passes.hpp"

#include <algorithm>
#include <cmath>

#include "processing/base/error.hpp"
#include "processing/base/range.hpp"
#include "processing/identification/noise_spectrum.hpp"
#include "processing/waves/incident_tail.hpp"

namespace kolsky {

namespace {

// Shares of the time from the pulse's rise to that of its return, from the pulse's foot. The front
// of a return that a lossy bar has drawn out rises a few hundredths earlier than its half.
constexpr double kOver = 0.7;        ///< nobody pushes any more
constexpr double kClear = 0.85;      ///< nothing of the return yet
constexpr double kLate = 0.9;        ///< the second record begins that much later
constexpr double kArrives = 0.95;    ///< the return, and likewise the struck end's answer to it
constexpr double kOfPeak = 0.05;     ///< a pulse with its tail lasts while above that
constexpr double kStandsOut = 16.0;  ///< of the noise: half of it is not reached by chance
constexpr double kLeft = 4.0;        ///< deviations of what noise alone leaves

/// One shot's pulse and its return; times in samples.
struct Passage {
  double sense = 1.0;
  double foot = 0.0;
  double delay = 0.0;  ///< from rise to rise
  double fall = 0.0;   ///< of the pulse, from its foot
  double end = 0.0;    ///< of its tail, likewise
};

Passage passage_of(const BarRecords& records, const std::string& gauge) {
  const std::vector<double>& strain = records.strain.front();
  const double rise = records.rise_s.front() / records.period_s;
  Passage passage;
  passage.foot = records.foot_s / records.period_s;
  const auto begin = static_cast<std::size_t>(rise) + 1;
  passage.sense = strain[std::min(begin, strain.size() - 1)] < 0.0 ? -1.0 : 1.0;
  double largest = 0.0;
  for (std::size_t n = begin; n < strain.size(); ++n) {
    largest = std::max(largest, -passage.sense * strain[n]);
  }
  if (largest < std::max(kStandsOut * records.noise_rms.front(), kOfPeak * records.peak.front())) {
    throw InputError("gauge " + gauge, "alone shows no inverted return of the pulse",
                     "leave the far end free and record until the pulse is back, or put a second "
                     "gauge on the bar");
  }
  std::size_t back = begin;
  while (-passage.sense * strain[back] < 0.5 * largest) {
    ++back;
  }
  passage.delay = static_cast<double>(back) - rise;
  const auto lasts = [&](double share) {
    std::size_t last = back;
    while (last > begin && passage.sense * strain[last] < share * records.peak.front()) {
      --last;
    }
    return static_cast<double>(last) - passage.foot;
  };
  passage.fall = lasts(0.5);
  passage.end = lasts(kOfPeak);
  return passage;
}

std::size_t sample(double place) {
  return static_cast<std::size_t>(std::max(0.0, place));
}

class Split {
 public:
  Split(Bench& bench, std::vector<BarRecords>& records)
      : bench_(bench), records_(records), gauge_(bench.gauges.front()) {
    for (const BarRecords& shot : records) {
      passages_.push_back(passage_of(shot, gauge_.name));
      quiet_.emplace_back(shot.quiet(0));
    }
    delay_ = passages_.front().delay;
    for (const Passage& passage : passages_) {
      delay_ = std::min(delay_, passage.delay);
      longest_ = std::max(longest_, passage.fall);
      tail_ = std::max(tail_, passage.end);
    }
    period_s_ = records.front().period_s;
    require_room();
  }

  void take_off_tails(const Compliance& solid, bool judged) {
    const NoiseSpectrum noise(quiet_);
    double left = 0.0;
    double variance = 0.0;
    double weight = 0.0;
    for (std::size_t i = 0; i < records_.size(); ++i) {
      std::vector<double>& strain = records_[i].strain.front();
      const std::size_t over = sample(passages_[i].foot + kOver * delay_);
      const std::size_t clear = sample(passages_[i].foot + kClear * delay_);
      tails_.push_back(
          incident_tail(strain, over, bench_.input, solid, gauge_.position_m, period_s_));
      double mean = 0.0;
      const auto samples = static_cast<double>(clear - over);
      for (std::size_t n = over; n < clear; ++n) {
        mean += (strain[n] - tails_[i][n]) / samples;
      }
      const double peak = records_[i].peak.front();
      left += passages_[i].sense * peak * mean;
      variance += peak * peak *
                  (noise.variance_of_mean(clear - over) +
                   noise.variance_of_mean(records_[i].quiet_samples));
      weight += peak * peak;
    }
    if (judged && std::abs(left) > kLeft * std::sqrt(variance)) {
      throw InputError("gauge " + gauge_.name,
                       "alone still reads " + in_words(100.0 * left / weight, "%") +
                           " of the pulse before its return, beyond what the bar's own creep "
                           "leaves there and " +
                           in_words(std::abs(left) / std::sqrt(variance), "deviations") +
                           " of its noise",
                       remedy());
    }
  }

  void second_records() {
    const double speed = speed_m_per_s();
    const std::size_t late = sample(kLate * delay_);
    for (std::size_t i = 0; i < records_.size(); ++i) {
      BarRecords& shot = records_[i];
      std::vector<double>& strain = shot.strain.front();
      const double foot = passages_[i].foot;
      const double answered = foot + kArrives * 2.0 * bench_.input.length_m / speed / period_s_;
      const double end = std::min({foot + kLate * delay_, answered - static_cast<double>(late),
                                   static_cast<double>(strain.size() - late)});
      std::vector<double> second;
      double peak = 0.0;
      for (std::size_t n = late; n < late + sample(end); ++n) {
        const bool pulse = n < sample(foot + kOver * delay_);
        const double tail = tails_.empty() ? 0.0 : tails_[i][n];
        second.push_back(pulse ? 0.0 : tail - strain[n]);
        peak = std::max(peak, std::abs(second.back()));
      }
      strain.resize(second.size());
      shot.strain.push_back(std::move(second));
      shot.peak.push_back(peak);
      shot.late_s = static_cast<double>(late) * period_s_;
      shot.rise_s.push_back(shot.rise_s.front() + passages_[i].delay * period_s_);
      shot.position_m.push_back(2.0 * bench_.input.length_m - gauge_.position_m);
      shot.noise_rms.push_back(shot.noise_rms.front());
      shot.step.push_back(shot.step.front());
      shot.channel.push_back(1);
      shot.returned = true;
    }
  }

  void second_gauge() {
    Gauge second = gauge_;
    second.name += " returned";
    second.position_m = {records_.front().position_m.back(),
                         2.0 * std::hypot(bench_.input.length_m.sd, gauge_.position_m.sd)};
    bench_.gauges.front().position_m.sd = 0.0;
    bench_.gauges.push_back(second);
    bench_.input.length_m = {2.0 * bench_.input.length_m, 0.0};
  }

 private:
  [[nodiscard]] double speed_m_per_s() const {
    return 2.0 * (bench_.input.length_m - gauge_.position_m) / (delay_ * period_s_);
  }

  [[nodiscard]] std::string remedy() const {
    const double now_m = bench_.input.length_m - gauge_.position_m;
    const double needed_m = 0.5 * tail_ * period_s_ * speed_m_per_s() / kOver;
    return "put it at least " + in_words(std::max(needed_m, 1.2 * now_m), "m") +
           " before the far end, or give pulses shorter than these " +
           in_words(std::round(1e6 * tail_ * period_s_), "us") +
           ", or put a second gauge on the bar";
  }

  void require_room() const {
    if (longest_ > kOver * delay_) {
      throw InputError("gauge " + gauge_.name, "alone still sees the pulse when its return arrives",
                       remedy());
    }
    const double speed = speed_m_per_s();
    for (std::size_t i = 0; i < records_.size(); ++i) {
      const double answered = kArrives * 2.0 * bench_.input.length_m / speed / period_s_;
      const double recorded =
          static_cast<double>(records_[i].strain.front().size()) - passages_[i].foot;
      const double needed = delay_ + passages_[i].fall;
      if (recorded < needed) {
        throw InputError("gauge " + gauge_.name, "alone shows too little of the pulse's return",
                         "record " + in_words(1e6 * (needed - recorded) * period_s_, "us") +
                             " longer, or put a second gauge on the bar");
      }
      if (answered < needed) {
        throw InputError(
            "gauge " + gauge_.name,
            "alone sees the struck end answer the return before that has passed",
            "put it at least " + in_words(0.5 * speed * passages_[i].fall * period_s_, "m") +
                " behind that end, or give shorter pulses, or put a second gauge on the bar");
      }
    }
  }

  Bench& bench_;
  std::vector<BarRecords>& records_;
  Gauge gauge_;
  std::vector<Passage> passages_;
  std::vector<std::span<const double>> quiet_;
  std::vector<std::vector<double>> tails_;
  double period_s_ = 0.0;
  double delay_ = 0.0;
  double longest_ = 0.0;
  double tail_ = 0.0;
};

}  // namespace

void split_passes(Bench& bench, std::vector<BarRecords>& records, const FirstPass& first) {
  Split split(bench, records);
  if (first.solid != nullptr) {
    split.take_off_tails(*first.solid, first.judged);
  }
  split.second_records();
  split.second_gauge();
}

}  // namespace kolsky
