#include "processing/reduction/shpb_pass.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "processing/reduction/corrections.hpp"
#include "processing/reduction/formatted.hpp"
#include "processing/reduction/loop_summary.hpp"
#include "processing/reduction/record_faults.hpp"
#include "processing/reduction/requested.hpp"

namespace kolsky {

ShpbPass::ShpbPass(const Shot& shot, const BarStation& in, const BarStation& out,
                   const ReductionOptions& options, ShpbPlans& plans, ShpbTables& tables)
    : shot_(shot),
      in_(in),
      out_(out),
      options_(options),
      t_(plans),
      bars_(tables),
      rate_Hz_(shot.rate.Hz()),
      period_s_(shot.rate.period_s()) {}

double ShpbPass::largest(std::span<const double> values) {
  double most = 0.0;
  for (const double value : values) {
    most = std::max(most, std::abs(value));
  }
  return most;
}

Reduction ShpbPass::run() {
  Reduction reduction = reduced();
  if (incident_found_ && quiet_ == 0) {
    tell_late_record(reduction.quality);
  }
  return reduction;
}

void ShpbPass::tell_late_record(Quality& quality) const {
  if (!quality.reducible) {
    quality.reason = "the record begins within the pulse at " + first_gauge() +
                     ", or less than 10 us before it, and " + quality.reason;
    quality.mend = std::string(kRecordFromBefore) + "; else " + quality.mend;
  }
}

Reduction ShpbPass::reduced() {
  if (!find_incident()) {
    return not_reducible("no incident pulse stands out of the noise on " + first_gauge(),
                         "give a shot's whole record, from before the impact, with that gauge's "
                         "bridge supplied");
  }
  if (split_ >= shot_.samples()) {
    return not_reducible("the record ends before the specimen's answer reaches " + first_gauge(),
                         record_longer());
  }
  transform_records();
  locate_arrival();
  weigh_hidden_push();
  separate();
  if (!faces_ && push_still_rises()) {
    return push_not_seen();
  }
  if (!choose_window()) {
    return nothing_in_window();
  }
  if (faces_) {
    take_separated();
  } else {
    fill_histories();
  }
  fill_strain();
  // The checks go by the sense in which the stress loads.
  set_stress(options_.stress, options_.corrections, *shot_.bench.specimen,
             std::span<const double>(front_rate_per_s_).first(reduction_.time_s.size()),
             reduction_);
  if (options_.corrections.friction && is_pulled(reduction_)) {
    return not_reducible("friction is asked for, of a specimen that is pulled: no face is pressed",
                         "leave friction out");
  }
  judge_quality();
  reduction_.assumed_from_s = assumed_from_s();
  return std::move(reduction_);
}

Reduction ShpbPass::push_not_seen() const {
  if (arrival_late_s_ && std::abs(*arrival_late_s_) > kArrivalLimit_s) {
    return not_reducible(
        formatted("the arrival given is %.1f us %s than the foot of the first pulse at %s",
                  1e6 * std::abs(*arrival_late_s_), *arrival_late_s_ > 0.0 ? "later" : "earlier",
                  first_gauge().c_str()),
        "give the foot at that gauge: the arrival that is printed is at the specimen");
  }
  return not_reducible(
      formatted("the reflection hides the push at %s %.0f us after its foot, while it still "
                "rises: the bar is too short for this pulse",
                first_gauge().c_str(), 2e6 * travel_to_specimen_s()),
      "it takes " + longer_window(in_.gauge_to_specimen_m, wave_speed_m_per_s()) +
          "; of a record that begins within the pulse the reflection is taken for it: record for "
          "longer before the trigger");
}

Reduction ShpbPass::nothing_in_window() const {
  const double asked = options_.duration_s.value_or(HUGE_VAL) * rate_Hz_;
  if (asked < kFewestSamples) {
    return not_reducible(formatted("the duration asked for, %.3g us, is less than %.0f samples",
                                   1e6 * asked * period_s_, kFewestSamples),
                         formatted("ask for %.3g us at least", 1e6 * kFewestSamples * period_s_));
  }
  return not_reducible("the record ends before the pulse has loaded the specimen", record_longer());
}

const std::string& ShpbPass::first_gauge() const {
  return shot_.channels[in_.channels.front()].gauge;
}

double ShpbPass::travel_to_specimen_s() const {
  return bars_.input.front_time_s(in_.gauge_to_specimen_m);
}

double ShpbPass::wave_speed_m_per_s() const {
  return in_.gauge_to_specimen_m / travel_to_specimen_s();
}

std::string ShpbPass::record_longer() const {
  const double answered = gauge_foot_ + 4.0 * travel_to_specimen_s() * rate_Hz_;
  const double missing = answered - static_cast<double>(shot_.samples());
  return formatted("record for longer, by some %.0f us",
                   1e6 * period_s_ * std::max(missing, rate_Hz_ * 10e-6));
}

std::span<Complex> ShpbPass::in_band(std::vector<Complex>& spectrum) const {
  return std::span(spectrum).first(bins_);
}

}  // namespace kolsky
