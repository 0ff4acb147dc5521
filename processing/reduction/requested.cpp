#include "processing/reduction/requested.hpp"

#include <algorithm>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "processing/base/bar_model_check.hpp"
#include "processing/base/error.hpp"
#include "processing/base/range.hpp"
#include "processing/reduction/separated_faces.hpp"
#include "processing/waves/bar_modes.hpp"

namespace kolsky {

namespace {

void require_positive(const std::optional<double>& number, const char* key,
                      const std::string& unit) {
  if (number && !(*number > 0.0)) {
    throw InputError(key, "must be above 0 " + unit, "give a positive number in " + unit);
  }
}

Corrections corrections_of(const ReductionRequest& request) {
  Corrections corrections;
  const std::string inertia = request.inertia.value_or("none");
  if (inertia != "none" && inertia != "axial" && inertia != "radial" && inertia != "both") {
    throw InputError("inertia", "\"" + inertia + "\" is not one",
                     "give axial, radial or both, or none");
  }
  corrections.axial_inertia = inertia == "axial" || inertia == "both";
  corrections.radial_inertia = inertia == "radial" || inertia == "both";
  if (request.friction && !(*request.friction >= 0.0 && *request.friction <= 1.0)) {
    throw InputError("friction", "is outside 0 to 1",
                     "give the coefficient between specimen and bars, as 0.1");
  }
  if (request.friction && *request.friction > 0.0) {
    corrections.friction = request.friction;
  }
  return corrections;
}

void refuse_for_ball(const ReductionRequest& request) {
  const std::pair<const char*, bool> specimens[] = {{"separate", request.separate.has_value()},
                                                    {"stress", request.stress.has_value()},
                                                    {"inertia", request.inertia.has_value()},
                                                    {"friction", request.friction.has_value()},
                                                    {kRequestTrue, request.with_true}};
  const auto* const asked =
      std::ranges::find(specimens, true, &std::pair<const char*, bool>::second);
  if (asked != std::end(specimens)) {
    throw InputError(asked->first, kForSpecimens, kLeaveOutForBall);
  }
}

void require_band_of_model(const std::optional<double>& band_limit_Hz, const Material& bar_model) {
  const auto known_Hz = bar_model.identified ? bar_model.identified->band_limit_Hz : std::nullopt;
  if (band_limit_Hz && known_Hz && *band_limit_Hz > *known_Hz) {
    throw InputError("band_limit_Hz",
                     "the bar model was identified up to " + in_words(*known_Hz, "Hz") + " only",
                     "give at most that, or identify the bars with shorter pulses");
  }
}

/// Before any shot is there; a shot's own tables say it again.
void require_bar_seen(double band_limit_Hz, WaveTheory theory, const Bar& bar,
                      const Material& viscoelastic) {
  constexpr double kBeyond = 1.01;
  const std::unique_ptr<const Compliance> compliance = compliance_of(bar, viscoelastic);
  require_band_seen(band_limit_Hz,
                    blind_from_Hz(theory, bar, *compliance, kBeyond * band_limit_Hz));
}

}  // namespace

ReductionOptions options_of(const ReductionRequest& request) {
  ReductionOptions options;
  if (request.stress) {
    options.stress = stress_from(*request.stress);
  }
  if (request.separate) {
    options.separation = separation_from(*request.separate);
  }
  if (request.dispersion) {
    options.theory = wave_theory(*request.dispersion);
  }
  options.corrections = corrections_of(request);
  require_positive(request.band_limit_Hz, "band_limit_Hz", "Hz");
  require_positive(request.duration_s, "duration_s", "s");
  options.band_limit_Hz = request.band_limit_Hz;
  options.duration_s = request.duration_s;
  options.with_true = request.with_true;
  return options;
}

void require_suits(const ReductionRequest& request, const Bench& bench,
                   const std::optional<Material>& bar_model) {
  const ReductionOptions options = options_of(request);
  if (!request.asks()) {
    return;
  }
  if (bench.kind == BenchKind::bar) {
    throw InputError("",
                     "asks for a reduction, and the bench is of kind \"bar\": nothing is reduced",
                     "leave it out, or give a bench of kind \"shpb\"");
  }
  require_band_of_record(options.band_limit_Hz, bench.sampling_frequency_Hz);
  if (options.band_limit_Hz) {
    const Material bars = bar_model ? *bar_model : assumed_bars(bench);
    require_bar_seen(*options.band_limit_Hz, options.theory, bench.input, bars);
    if (bench.output) {
      require_bar_seen(*options.band_limit_Hz, options.theory, *bench.output, bars);
    }
  }
  if (bench.kind == BenchKind::impact) {
    refuse_for_ball(request);
    return;
  }
  if (bar_model) {
    require_band_of_model(options.band_limit_Hz, *bar_model);
  }
  if (bench.output && bench.output->material) {
    require_band_of_model(options.band_limit_Hz, *bench.output->material);
  }
  if (options.separation == Separation::gauges) {
    try {
      require_two_places(bench);
    } catch (const InputError& error) {
      throw InputError("separate", "the gauges " + error.problem(), error.mend());
    }
  }
  if ((options.corrections.axial_inertia || options.corrections.radial_inertia) && bench.specimen &&
      !bench.specimen->density_kg_m3) {
    throw InputError("inertia", "the bench has no specimen.density_kg_m3, so it is not known",
                     "file it, or leave the inertia corrections out");
  }
}

void require_band_of_record(const std::optional<double>& band_limit_Hz, double rate_Hz) {
  if (band_limit_Hz && !(*band_limit_Hz > 0.0 && *band_limit_Hz <= rate_Hz / 2.0)) {
    throw InputError("band_limit_Hz",
                     in_words(*band_limit_Hz, "Hz") +
                         " is not in the record, which was sampled at " + in_words(rate_Hz, "Hz"),
                     "give at most half of that");
  }
}

void require_band_seen(double band_limit_Hz, double blind_from_Hz) {
  if (band_limit_Hz > blind_from_Hz) {
    throw InputError(
        "band_limit_Hz",
        in_words(band_limit_Hz, "Hz") + " is beyond what gauges on these bars see: from " +
            in_words(blind_from_Hz, "Hz") + " on the surface has less than half of the mean strain",
        "give at most that, or ask for elementary waves");
  }
}

}  // namespace kolsky
