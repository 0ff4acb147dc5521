#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "clients/cli/reports/calibration_report.hpp"
#include "processing/identification/known_unknowns.hpp"

namespace kolsky::cli {
namespace {

/// A combined number goes into the file where its deviation is below this share of the filed one.
constexpr double kKnownBetter = 0.9;

std::size_t index_of(const Bench& bench, const std::string& gauge) {
  const auto found = std::find_if(bench.gauges.begin(), bench.gauges.end(),
                                  [&](const Gauge& g) { return g.name == gauge; });
  return static_cast<std::size_t>(found - bench.gauges.begin());
}

std::string value_text(double value) {
  return fmt::format("{:.10g}", value);
}
std::string sd_text(double sd) {
  return fmt::format("{:.3g}", sd);
}

BenchKey key_of(std::string table, std::size_t index, const std::string& shown,
                const std::string& key, const Measured& value) {
  return {shown + "." + key, {std::move(table), index, key, value_text(value.value)}, value};
}

/// The number of a gauge that turns readings into strain, for another gain.
std::optional<BenchKey> gain_key(const Gauge& gauge, std::size_t index, const Measured& gain) {
  const std::string shown = "gauges." + gauge.name;
  const double relative = gain.sd / gain.value;
  if (gauge.strain_per_V) {
    const double value = gauge.strain_per_V->value / gain.value;
    return key_of("gauges", index, shown, "strain_per_V", {value, std::abs(value) * relative});
  }
  if (gauge.bridge) {
    const double value = gauge.bridge->gauge_factor.value * gain.value;
    return key_of("gauges", index, shown, "gauge_factor", {value, std::abs(value) * relative});
  }
  return std::nullopt;
}

void add_edits(const BenchKey& key, const Bench& bench, std::vector<BenchEdit>& edits) {
  edits.push_back(key.edit);
  BenchEdit sd = key.edit;
  sd.key += "_sd";
  sd.text = sd_text(key.value.sd);
  edits.push_back(sd);
  if (key.edit.key == "gauge_factor" && bench.gauges[key.edit.index].bridge) {
    // The deviation found is that of the product, and stands whole beside the gauge factor.
    for (const char* const other : {"excitation_V_sd", "gain_sd"}) {
      edits.push_back({key.edit.table, key.edit.index, other, std::nullopt});
    }
  }
}

void exchange(const Bench& bench, const std::pair<std::string, std::string>& names,
              std::vector<BenchEdit>& edits) {
  const std::size_t a = index_of(bench, names.first);
  const std::size_t b = index_of(bench, names.second);
  for (const auto& [to, from] : {std::pair{a, b}, std::pair{b, a}}) {
    const Gauge& other = bench.gauges[from];
    edits.push_back({"gauges", to, "bar", "\"" + other.bar + "\""});
    edits.push_back({"gauges", to, "position_m", value_text(other.position_m.value)});
    edits.push_back(
        {"gauges", to, "position_m_sd",
         other.position_m.sd > 0.0 ? std::optional(sd_text(other.position_m.sd)) : std::nullopt});
  }
}

/// Elastic bars together have a modulus of both beside their own, and densities go with them, and
/// one's diameter with the other's:
/// none by itself is known better than filed.
bool part_of_a_whole(const CalibratedNumber& number, BarsLay lay) {
  using Of = CalibratedNumber::Of;
  return lay == BarsLay::together && (number.of == Of::elastic_modulus ||
                                      number.of == Of::density || number.of == Of::diameter);
}

/// What leaves nearly all of the records says nothing of the numbers that it seems to agree with.
bool worth_filing(const CalibratedNumber& number, const PartResult& part) {
  constexpr double kFarOff = 20.0;
  return number.standing == Standing::differs ||
         (number.standing == Standing::agrees && part.chi2_reduced < kFarOff &&
          !part_of_a_whole(number, part.lay) && number.filed.sd > 0.0 &&
          number.combined.sd < kKnownBetter * number.filed.sd);
}

}  // namespace

std::optional<BenchKey> bench_key(const CalibratedNumber& number, BarsLay lay, const Bench& bench) {
  using Of = CalibratedNumber::Of;
  const bool of_output = lay == BarsLay::output_alone || number.bar == "output";
  const std::string bar = of_output ? "bars.output" : "bars.input";
  switch (number.of) {
    case Of::gain: {
      const std::size_t index = index_of(bench, number.gauge);
      return gain_key(bench.gauges[index], index, number.combined);
    }
    case Of::position:
      return key_of("gauges", index_of(bench, number.gauge), "gauges." + number.gauge, "position_m",
                    number.combined);
    case Of::delay:
      return key_of("gauges", index_of(bench, number.gauge), "gauges." + number.gauge, "delay_s",
                    number.combined);
    case Of::bar_length:
      return key_of(bar, 0, bar, "length_m", number.combined);
    case Of::diameter: {
      const Bar& filed = number.bar == "output" ? *bench.output : bench.input;
      return filed.side_m ? std::nullopt
                          : std::optional(key_of(bar, 0, bar, "diameter_m", number.combined));
    }
    case Of::density:
      return key_of(bar, 0, bar, "density_kg_m3", number.combined);
    case Of::elastic_modulus:
      return key_of(bar, 0, bar, "youngs_modulus_Pa", number.combined);
    default:
      return std::nullopt;
  }
}

BenchEdit inverting_edit(const std::string& gauge, const Bench& bench) {
  const std::size_t index = index_of(bench, gauge);
  return {"gauges", index, "inverted", bench.gauges[index].inverted ? "false" : "true"};
}

std::vector<BenchEdit> corrections(const Calibration& calibration, const Bench& bench) {
  std::vector<BenchEdit> edits;
  std::map<std::string, Measured> filed;  // by key: the best of several parts counts
  for (const PartResult& part : calibration.parts) {
    for (const auto& names : part.swapped) {
      exchange(bench, names, edits);
    }
    for (const std::string& gauge : part.inverted) {
      edits.push_back(inverting_edit(gauge, bench));
    }
    for (const CalibratedNumber& number : part.numbers) {
      const auto key = bench_key(number, part.lay, bench);
      if (!key || !worth_filing(number, part)) {
        continue;
      }
      const auto before = filed.find(key->name);
      if (before != filed.end() && before->second.sd <= key->value.sd) {
        continue;
      }
      filed[key->name] = key->value;
      add_edits(*key, bench, edits);
      if (number.of == CalibratedNumber::Of::elastic_modulus && number.bar.empty() &&
          part.lay == BarsLay::together) {
        BenchKey output = *key;
        output.edit.table = "bars.output";
        add_edits(output, bench, edits);
      }
    }
  }
  return edits;
}

}  // namespace kolsky::cli
