#include "processing/identification/bar_warnings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "processing/base/bar_model_check.hpp"
#include "processing/base/range.hpp"
#include "processing/identification/better_solid.hpp"
#include "processing/identification/known_unknowns.hpp"
#include "processing/reduction/formatted.hpp"
#include "processing/reduction/gauge_order.hpp"

namespace kolsky {

namespace {

std::string rounded(double value) {
  std::array<char, 32> text{};
  (void)std::snprintf(text.data(), text.size(), "%.3g", value);
  return text.data();
}

/// @param name  of the solid in words
void warn_of_misfit(const BarFit& fit, const std::string& name,
                    std::vector<std::string>& warnings) {
  if (fit.misfit) {
    warnings.push_back("the model does not fit (" + name + ", " + name_of(fit.theory) +
                       " waves): what all shots leave alike is " + rounded(fit.misfit->power) +
                       " times the noise from " + in_words(fit.misfit->low_Hz, "Hz") + " to " +
                       in_words(fit.misfit->high_Hz, "Hz") + ", " +
                       rounded(fit.misfit->deviations) +
                       " deviations from chance; deviations are widened as if it were noise, but "
                       "do not count on them to hold the truth");
  } else if (fit.chi2_reduced > kMoreThanNoise) {
    warnings.push_back("the " + name_of(fit.solid) +
                       " solid leaves more than noise: reduced chi2 " + rounded(fit.chi2_reduced) +
                       "; deviations are widened for what is left, which does not cover what the "
                       "model lacks");
  }
}

std::string as_good_as_elastic(const BarFit& three) {
  constexpr double kKnown = 0.02;
  const FittedNumber& E1 = three.parameters.front();
  return E1.sd < kKnown * E1.value ? "the bar is as good as elastic with E1"
                                   : "nor is E1 by itself: J at low frequencies is 1/E1 + 1/E2";
}

void warn_of_fit(const BarIdentification& result, std::vector<std::string>& warnings) {
  const BarFit& three = result.three_element;
  warn_of_misfit(three, "three elements", warnings);
  if (result.fit.solid != SolidKind::three_element) {
    warn_of_misfit(result.fit, name_of(result.fit.solid), warnings);
  }
  if (!loss_shows(three)) {
    warnings.push_back(result.spectrum.mean_loss.gains()
                           ? "E2 and eta2 are not determined: they stand for a loss, and there is "
                             "none"
                           : "next to no loss stands out of the noise: E2 and eta2 are not "
                             "determined; " +
                                 as_good_as_elastic(three));
    return;
  }
  for (std::size_t i = 0; i < three.parameters.size(); ++i) {
    double scatter = 0.0;
    for (const ShotEstimate& shot : three.shots) {
      scatter += std::pow(
          (shot.parameters[i].value - result.over_shots[i].value) / shot.parameters[i].sd, 2);
    }
    const auto freedom = static_cast<double>(three.shots.size()) - 1.0;
    if (freedom > 0.0 && scatter > freedom + 4.0 * std::sqrt(2.0 * freedom) + 4.0) {
      warnings.push_back("shots differ in " + three.parameters[i].name +
                         " by more than their noise: temperature, amplitude or mounting changed "
                         "between them");
    }
  }
}

void warn_of_choices(const BarIdentification& result, std::vector<std::string>& warnings) {
  if (!result.wave_theory.asked && !result.wave_theory.told_apart) {
    warnings.push_back(
        "the records do not tell the wave theories apart; deviations take in how far they lie from "
        "each other");
  }
  if (!result.far_end.asked && !result.far_end.told_apart && !result.two_passes) {
    warnings.push_back("the records do not show what the far end returns");
  }
  if (result.fit.far_end == FarEndReturn::none && result.far_end.told_apart) {
    warnings.push_back("nothing comes back from the far end, though the bench's bar ends there");
  }
  if (result.fit.far_end == FarEndReturn::partial) {
    const FittedNumber& returned = *result.fit.reflection;
    warnings.push_back(
        "the far end is neither free, which would return -1 of the stress, nor "
        "silent: it returns " +
        formatted("%.4f ± %.2g", returned.value, returned.sd));
  }
  if (const auto better = better_solid(result)) {
    warnings.push_back(cost_of_filing(fit_to_file(result), *better));
  }
}

/// First of all: what is exchanged spoils every number.
void warn_of_order(const std::vector<Shot>& shots, std::vector<std::string>& warnings) {
  std::optional<Check> said;
  for (const Shot& shot : shots) {
    said = gauge_order(shot);
    if (!said) {
      return;
    }
  }
  warnings.push_back(said->text);
}

/// Rounding is noise only where there is some: shots alike are rounded alike.
void warn_of_steps(const BarData& data, std::vector<std::string>& warnings) {
  const BarRecords& records = data.records().front();
  const std::size_t gauges = data.two_passes() ? 1 : data.gauges();
  for (std::size_t j = 0; j < gauges; ++j) {
    if (records.stays_at_a_code(j)) {
      warnings.push_back("gauge " + data.bench().gauges[records.channel[j]].name +
                         " reads in steps of " + in_words(1e6 * records.step[j], "microstrain") +
                         ", more than its noise: what rounding leaves counts as noise, but may be "
                         "more than that, and shots that are alike repeat it");
    }
  }
}

void warn_of_bench(const BarData& data, const BarFit& fit, std::vector<std::string>& warnings) {
  const auto unknowns = known_unknowns(data.bench(), data.records().front());
  for (std::size_t i = 0; i < fit.bench.size(); ++i) {
    const double moves = fit.bench[i].value / unknowns[i].sd;
    if (std::abs(moves) > 3.0) {
      warnings.push_back(fit.bench[i].name + " would have to be off by " + rounded(moves) +
                         " of its filed deviations");
    }
  }
}

/// Moduli of one temperature are asked of all shots: what they differ by beyond that is said.
void warn_of_temperatures(const std::vector<Shot>& shots, std::vector<std::string>& warnings) {
  std::vector<double> known_K;
  for (const Shot& shot : shots) {
    if (const auto temperature_K = temperature_of(shot)) {
      known_K.push_back(*temperature_K);
    }
  }
  if (known_K.empty()) {
    return;
  }
  const auto [coldest, warmest] = std::minmax_element(known_K.begin(), known_K.end());
  if (*warmest - *coldest > kNearEnough_K) {
    warnings.push_back(
        "shots were taken from " + in_words(*coldest, "K") + " to " + in_words(*warmest, "K") +
        ": the moduli are of no one temperature, PMMA's change by some 0.3 % per kelvin; identify "
        "shots within " +
        in_words(kNearEnough_K, "K") + " of each other");
  }
}

/// By how much and where J2 is below zero.
std::string where_negative(const BarSpectrum& spectrum) {
  const MeanLoss& loss = spectrum.mean_loss;
  std::string text;
  if (loss.J2_per_Pa < 0.0) {
    text = ", by " + rounded(-loss.J2_per_Pa / loss.sd_per_Pa) +
           " deviations on average over the band";
  }
  if (loss.negative > 0) {
    text += ", clearly at " + std::to_string(loss.negative) + " of " +
            std::to_string(spectrum.frequency_Hz.size()) + " frequencies";
  }
  return text;
}

void warn_of_gain(const BarSpectrum& spectrum, std::vector<std::string>& warnings) {
  if (spectrum.mean_loss.gains()) {
    warnings.push_back("not passive: J2 is negative" + where_negative(spectrum) +
                       ": waves would grow on their way; check the gauge factors and the order of "
                       "the gauges");
  }
}

}  // namespace

std::vector<std::string> warnings_of(const BarIdentification& result,
                                     const std::vector<Shot>& shots, const BarData& data) {
  std::vector<std::string> warnings;
  warn_of_order(shots, warnings);
  warn_of_steps(data, warnings);
  warn_of_temperatures(shots, warnings);
  warn_of_fit(result, warnings);
  warn_of_choices(result, warnings);
  warn_of_bench(data, result.likeliest, warnings);
  warn_of_gain(result.spectrum, warnings);
  return warnings;
}

}  // namespace kolsky
