#include "processing/calibration/calibration.hpp"

#include <algorithm>
#include <cmath>

#include "processing/base/bar_model_check.hpp"
#include "processing/base/error.hpp"
#include "processing/calibration/part_fit.hpp"
#include "processing/identification/bar_misfit.hpp"
#include "processing/models/material_effects.hpp"

namespace kolsky {

namespace {

constexpr double kDeviations = 3.0;

void require_trusted(const Bench& bench, const std::vector<std::string>& trusted) {
  for (const std::string& name : trusted) {
    const bool known = std::any_of(bench.gauges.begin(), bench.gauges.end(),
                                   [&](const Gauge& gauge) { return gauge.name == name; });
    if (!known) {
      throw InputError("gauge " + name, "is not one of the bench",
                       "trust a gauge that the bench file names");
    }
  }
}

/// What the areas and the model say of the same gains.
void compare_areas(const PartResult& part, std::vector<std::string>& warnings) {
  const auto gain_of = [&](const std::string& gauge) {
    for (const CalibratedNumber& number : part.numbers) {
      if (number.of == CalibratedNumber::Of::gain && number.gauge == gauge) {
        return number.combined;
      }
    }
    return Measured{1.0, 0.0};
  };
  for (const AreaRatio& ratio : part.areas.ratios) {
    const Measured own = gain_of(ratio.gauge);
    const Measured first = gain_of(part.areas.first_gauge);
    const double expected = own.value / first.value;
    const double sd = std::hypot(ratio.ratio.sd, own.sd, first.sd);
    if (std::abs(ratio.ratio.value - expected) > kDeviations * sd) {
      warnings.push_back("pulse areas give gauge " + ratio.gauge + " another gain than the waves");
    }
  }
}

/// The bars' moduli as a part of the shots gives them.
BarPrior as_found(const PartResult& part, BarPrior bars) {
  using Of = CalibratedNumber::Of;
  const auto places = three_element_places(bars.material.solid);
  for (const CalibratedNumber& number : part.numbers) {
    if (number.of >= Of::E1) {
      const auto which = static_cast<std::size_t>(number.of) - static_cast<std::size_t>(Of::E1);
      bars.material.parameters[places.at(which)] = number.combined;
    }
  }
  return bars;
}

/// Where one gauge stands for two, what its record is parted by depends on the moduli, and so does
/// where the records of bars together end: they are parted and cut again by those they gave.
PartResult fitted_part(const std::vector<Shot>& shots, const std::vector<CalibrationPart>& parts,
                       std::size_t index, const BarPrior& bars, const CalibrationOptions& options,
                       Channels channels) {
  PartResult fitted = fit_part(parts[index], options);
  const CalibrationPart& part = parts[index];
  const bool elastic = part.shots.front().bench.input.youngs_modulus_Pa.has_value();
  const bool cut_by_guess = part.lay == BarsLay::together && !options.bars;
  if (elastic || !(part.two_passes || cut_by_guess)) {
    return fitted;
  }
  return fit_part(arrange(shots, as_found(fitted, bars), channels)[index], options);
}

bool unexplained(const PartResult& part) {
  return std::ranges::any_of(part.numbers, [](const CalibratedNumber& number) {
    return number.standing == Standing::unexplained;
  });
}

/// Whether nothing that is filed was held against anything.
bool tells_nothing(const PartResult& part) {
  return !part.areas.momentum &&
         std::ranges::all_of(part.numbers, [](const CalibratedNumber& number) {
           return number.standing == Standing::unseen || number.standing == Standing::unfiled;
         });
}

/// What else than numbers of the bench leaves records that none of them explain.
std::string other_than_numbers(BarsLay lay) {
  return lay == BarsLay::together ? "a specimen between the bars, or a bar model that is not theirs"
                                  : "a far end that is not free (`kolsky identify bar` measures "
                                    "what it returns), or a bar model that is not its own";
}

/// Whether channels taken as they read leave so much less than as filed that this is what was
/// wrong. Numbers that were set free do not count for what is filed: a place that may go anywhere
/// does what an exchange does.
bool explains_records(const PartResult& as_they_read, const PartResult& as_filed) {
  constexpr double kFarOff = 20.0;
  const double left = as_they_read.chi2_reduced - 1.0;
  const double most = as_they_read.chi2_reduced > kFarOff ? 0.1 : 0.5;
  return !unexplained(as_they_read) && left < most * (as_filed.chi2_reduced_as_filed - 1.0);
}

std::string exchanged(const std::pair<std::string, std::string>& gauges) {
  return "gauges " + gauges.first + " and " + gauges.second;
}

/// The order and the sense in which pulses come are what made a claim of exchanged or inverted
/// channels; it stands where the fit bears it out.
PartResult believed_part(const std::vector<Shot>& shots, const std::vector<CalibrationPart>& parts,
                         std::size_t index, const BarPrior& bars, const CalibrationOptions& options,
                         Calibration& result) {
  PartResult read = fitted_part(shots, parts, index, bars, options, Channels::as_they_read);
  if (read.swapped.empty() && read.inverted.empty()) {
    return read;
  }
  const std::vector<CalibrationPart> as_filed = arrange(shots, bars, Channels::as_filed);
  PartResult filed = fitted_part(shots, as_filed, index, bars, options, Channels::as_filed);
  if (explains_records(read, filed)) {
    for (const auto& gauges : read.swapped) {
      result.reasons.push_back(exchanged(gauges) +
                               " are exchanged: the pulse arrives in the other order");
    }
    for (const std::string& gauge : read.inverted) {
      result.reasons.push_back(
          "gauge " + gauge + " reads with the other sign: its pulse pulls where the others' push");
    }
    read.chi2_reduced_as_filed = filed.chi2_reduced_as_filed;
    return read;
  }
  for (const auto& gauges : read.swapped) {
    result.reasons.push_back("the pulse comes to " + exchanged(gauges) +
                             " in the other order than filed, and exchanged they explain the "
                             "records no better");
  }
  for (const std::string& gauge : read.inverted) {
    result.reasons.push_back("the pulse at gauge " + gauge +
                             " pulls where the others' push, and with the other sign it explains "
                             "the records no better: did the trigger come too late?");
  }
  return filed;
}

}  // namespace

std::string name_of(Standing standing) {
  switch (standing) {
    case Standing::agrees:
      return "agrees";
    case Standing::differs:
      return "differs";
    case Standing::doubtful:
      return "doubtful";
    case Standing::tied:
      return "tied";
    case Standing::unseen:
      return "unseen";
    case Standing::unexplained:
      return "unexplained";
    case Standing::unfiled:
      break;
  }
  return "unfiled";
}

std::string name_of(Certificate certificate) {
  switch (certificate) {
    case Certificate::pass:
      return "pass";
    case Certificate::fail:
      return "fail";
    case Certificate::undecided:
      break;
  }
  return "undecided";
}

Calibration calibrate(const std::vector<Shot>& shots, const CalibrationOptions& options) {
  for (const Shot& shot : shots) {
    if (shot.bench.output && shot.bench.output->material) {
      throw InputError("bars.output.material",
                       "is filed, and each bar's moduli are what these shots are to tell",
                       "leave it out of the bench that is held against them: `--bench`");
    }
  }
  if (options.bars) {
    for (const Shot& shot : shots) {
      require_bar_model_holds(options.bars->material, shot, "the bar model");
    }
    require_band_known(
        options.bars->material,
        options.band_limit_Hz > 0.0 ? std::optional(options.band_limit_Hz) : std::nullopt,
        "the bar model");
  }
  const BarPrior bars = options.bars ? *options.bars : bars_to_begin_with(shots);
  const std::vector<CalibrationPart> parts = arrange(shots, bars);
  require_trusted(shots.front().bench, options.trusted);
  Calibration result;
  bool differs = false;
  bool undecided = false;
  for (std::size_t index = 0; index < parts.size(); ++index) {
    const CalibrationPart& part = parts[index];
    PartResult fitted = believed_part(shots, parts, index, bars, options, result);
    differs = differs || !fitted.swapped.empty() || !fitted.inverted.empty();
    for (const CalibratedNumber& number : fitted.numbers) {
      differs = differs || number.standing == Standing::differs;
      undecided = undecided || number.standing == Standing::tied;
      if (number.standing == Standing::doubtful) {
        result.warnings.push_back(name_of(part.lay) + ": " + number.id + " is " +
                                  std::to_string(number.deviations).substr(0, 4) +
                                  " deviations off, which among so many numbers may be chance");
      }
    }
    const bool something_else = unexplained(fitted);
    if (something_else || fitted.chi2_reduced > kMoreThanNoise) {
      undecided = true;
      result.reasons.push_back(
          name_of(part.lay) +
          (something_else
               ? ": no numbers of the bench explain these records, so none is called wrong; " +
                     other_than_numbers(part.lay) + ", would leave that"
               : ": no number of the bench explains all that is left; "
                 "`kolsky diagnose` looks for what else it may be"));
    }
    if (tells_nothing(fitted)) {
      undecided = true;
      result.reasons.push_back(
          name_of(part.lay) +
          ": these records tell no number of the bench to what is filed, so none is held against "
          "anything; record longer, file what is known of the bars' moduli, or check that nothing "
          "is between the bars");
    }
    if (fitted.areas.momentum) {
      const Measured& gain = fitted.areas.momentum->gain;
      if (std::abs(fitted.areas.momentum_left) > kDeviations) {
        undecided = true;
        result.reasons.push_back("the striker's momentum gives gauge " +
                                 fitted.areas.momentum->gauge + " the gain " +
                                 std::to_string(gain.value) +
                                 (fitted.two_passes ? ": its gain" : ": all gains together") +
                                 ", or the striker's numbers, are off");
      }
    }
    compare_areas(fitted, result.warnings);
    result.parts.push_back(std::move(fitted));
  }
  result.certificate = differs     ? Certificate::fail
                       : undecided ? Certificate::undecided
                                   : Certificate::pass;
  return result;
}

}  // namespace kolsky
