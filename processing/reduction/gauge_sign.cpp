#include "processing/reduction/gauge_sign.hpp"

#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "processing/reduction/first_pulse.hpp"
#include "processing/reduction/gauge_order.hpp"
#include "processing/reduction/loop_summary.hpp"

namespace kolsky {

namespace {

const char* name_of_sense(PositiveSense sense) {
  return sense == PositiveSense::tension ? "tension" : "compression";
}

PositiveSense other(PositiveSense sense) {
  return sense == PositiveSense::tension ? PositiveSense::compression : PositiveSense::tension;
}

/// How the faces' forces go together, -1 to 1.
double correlation(const std::vector<double>& front, const std::vector<double>& back) {
  double together = 0.0;
  double of_front = 0.0;
  double of_back = 0.0;
  for (std::size_t n = 0; n < front.size(); ++n) {
    together += front[n] * back[n];
    of_front += front[n] * front[n];
    of_back += back[n] * back[n];
  }
  const double both = std::sqrt(of_front * of_back);
  return both > 0.0 ? together / both : 0.0;
}

std::string joined(const std::vector<std::string>& names) {
  std::string list;
  for (std::size_t i = 0; i < names.size(); ++i) {
    list += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  }
  return list;
}

std::string all_text(PositiveSense loading) {
  const std::string seen = name_of_sense(other(loading));
  return "the incident pulse is a " + seen + ", and the bars are loaded in " +
         name_of_sense(loading) + ": file loading = \"" + seen + "\" if they are not; else the " +
         "bench's `positive` or every channel has the other sign, or the record begins within the "
         "incident pulse or behind it";
}

}  // namespace

std::optional<PositiveSense> first_sense(const std::vector<double>& strain, double sample_rate_Hz) {
  const auto pulse = first_pulse(strain, sample_rate_Hz);
  if (!pulse) {
    return std::nullopt;
  }
  return pulse->sense < 0.0 ? PositiveSense::tension : PositiveSense::compression;
}

std::string other_sign_text(const std::vector<std::string>& odd, PositiveSense loading,
                            bool on_input) {
  const std::string others = odd.size() == 1 ? odd.front() + " seems" : joined(odd) + " seem";
  return "the first pulse is a " + std::string(name_of_sense(other(loading))) + " at " +
         joined(odd) + " and a " + name_of_sense(loading) + " at the other gauges: " + others +
         " to read with the other sign (leads exchanged?): file inverted = true there" +
         (on_input ? "; or the record begins within the incident pulse or behind it" : "");
}

bool signs_in_doubt(const Shot& shot, const Reduction& reduction) {
  constexpr double kAgainst = -0.5;
  const bool pulled = shot.bench.loading == PositiveSense::tension;
  const double incident =
      std::accumulate(reduction.incident.begin(), reduction.incident.end(), 0.0);
  return is_pulled(reduction) != pulled || (incident < 0.0) != pulled ||
         correlation(reduction.force_front_N, reduction.force_back_N) < kAgainst;
}

std::optional<Check> gauge_sign(const Shot& shot) {
  const Bench& bench = shot.bench;
  std::vector<std::string> odd;
  std::size_t seen = 0;
  bool on_input = false;
  for (std::size_t i = 0; i < bench.gauges.size(); ++i) {
    const auto sense = first_sense(strain_of_gauge(shot, i), shot.rate.Hz());
    seen += sense ? 1 : 0;
    if (sense && *sense != bench.loading) {
      odd.push_back(bench.gauges[i].name);
      on_input = on_input || bench.gauges[i].bar == "input";
    }
  }
  if (odd.empty()) {
    return std::nullopt;
  }
  const bool all = odd.size() == seen;
  return Check{
      .name = "gauge_sign",
      .value = static_cast<double>(odd.size()),
      .limit = 0.0,
      .unit = "gauges",
      .verdict = all ? Verdict::warn : Verdict::fail,
      .text = all ? all_text(bench.loading) : other_sign_text(odd, bench.loading, on_input)};
}

}  // namespace kolsky
