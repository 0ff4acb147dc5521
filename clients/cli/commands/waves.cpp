#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <ostream>

#include "clients/cli/bar_model_file.hpp"
#include "clients/cli/bar_options.hpp"
#include "clients/cli/command.hpp"
#include "clients/cli/numbers.hpp"
#include "clients/cli/outputs.hpp"
#include "clients/cli/reports/reduced_shot.hpp"
#include "clients/figure/layout.hpp"
#include "clients/figure/recorded_waves_figure.hpp"
#include "clients/report/svg.hpp"
#include "clients/terminal/plot.hpp"
#include "drivers/files/captures/capture.hpp"
#include "processing/base/error.hpp"
#include "processing/reduction/first_pulse.hpp"

namespace kolsky::cli {
namespace {

struct Settings {
  std::string capture;
  std::optional<std::string> bar;
  std::optional<std::string> at;
  std::optional<std::string> bar_model;
  std::optional<std::string> dispersion;
  std::optional<double> band_limit_Hz;
  bool gauges_only = false;
  bool equilibrium = false;
  std::optional<std::string> csv;
  std::optional<std::string> svg;
};

/// A shot with the waves in one of its bars.
struct Told {
  Shot shot;
  std::string capture;
  std::string bar_model;  ///< what the bar was taken to be, for people
  RecordedWavesOptions options;
  RecordedWaves waves;

  [[nodiscard]] double period_s() const { return shot.rate.period_s(); }
  [[nodiscard]] double time_s(std::size_t sample) const {
    return static_cast<double>(sample) * period_s();
  }
};

RecordedWavesOptions options_of(const Settings& settings, const std::optional<BarModelFile>& bars) {
  RecordedWavesOptions options;
  options.bar = settings.bar.value_or(options.bar);
  if (settings.at) {
    options.positions_m = numbers_in(*settings.at, "kolsky waves: --at");
  }
  if (settings.dispersion) {
    options.theory = wave_theory(*settings.dispersion);
  }
  options.band_limit_Hz = settings.band_limit_Hz;
  options.gauges_only = settings.gauges_only;
  options.equilibrium = settings.equilibrium;
  if (bars) {
    options.bar_model = bars->prior.material;
  }
  return options;
}

std::string model_in_words(const Told& told) {
  const Bar& bar = bar_named(told.shot.bench, told.options.bar);
  const auto& given = told.options.bar_model ? told.options.bar_model : told.shot.bar_model;
  std::string text = bar_in_words(bar, told.shot.bench, given);
  if (given && bar.takes_bar_model()) {
    text += doubts_in_brackets(*given, told.shot);
  }
  return text;
}

/// What was asked for is named as it was given, all else as the capture's.
InputError as_given(const InputError& error, const std::string& capture) {
  constexpr std::array<std::pair<const char*, const char*>, 4> kOptions = {
      {{"position", "--at"},
       {"band_limit_Hz", "--band-limit"},
       {"bar", "--bar"},
       {"equilibrium", "--equilibrium"}}};
  for (const auto& [key, option] : kOptions) {
    if (error.place() == key) {
      return {std::string("kolsky waves: ") + option, error.problem(), error.mend()};
    }
  }
  return error.inside(capture);
}

Told tell(const Settings& settings) {
  Told told;
  std::optional<BarModelFile> bars;
  if (settings.bar_model) {
    bars = read_bar_model(*settings.bar_model);
    require_band(*bars, settings.band_limit_Hz);
  }
  told.options = options_of(settings, bars);
  told.shot = read_capture(settings.capture);
  told.capture = absolute_name(settings.capture);
  if (bars) {
    require_holds(*bars, told.shot);
  }
  try {
    told.waves = recorded_waves(told.shot, told.options);
  } catch (const InputError& error) {
    throw as_given(error, settings.capture);
  }
  told.bar_model = model_in_words(told);
  return told;
}

/// As far as the records tell it.
std::vector<double> known_part(const Told& told, const std::vector<double>& history) {
  return {history.begin(), history.begin() + static_cast<std::ptrdiff_t>(told.waves.known)};
}

JsonValue describe(const Told& told) {
  JsonList places;
  for (const WavesAtPlace& place : told.waves.places) {
    places.push_back(
        JsonObject{{"position_m", place.position_m},
                   {"right_going", known_part(told, place.waves.right_going)},
                   {"left_going", known_part(told, place.waves.left_going)},
                   {"stress_Pa", known_part(told, place.waves.stress_Pa)},
                   {"stress_sd_Pa", known_part(told, place.stress_noise_Pa)},
                   {"velocity_m_per_s", known_part(told, place.waves.velocity_m_per_s)}});
  }
  JsonList blind;
  for (const BlindFrequency& frequency : told.waves.blind) {
    blind.push_back(
        JsonObject{{"frequency_Hz", frequency.frequency_Hz}, {"noise_gain", frequency.noise_gain}});
  }
  JsonList left;
  for (const GaugeLeft& gauge : told.waves.left) {
    left.push_back(JsonObject{
        {"gauge", gauge.gauge}, {"left_rms", gauge.left_rms}, {"noise_rms", gauge.noise_rms}});
  }
  std::vector<double> time_s;
  time_s.reserve(told.waves.known);
  for (std::size_t n = 0; n < told.waves.known; ++n) {
    time_s.push_back(told.time_s(n));
  }
  return JsonObject{{"shot", told.shot.id},
                    {"capture", told.capture},
                    {"bar", told.options.bar},
                    {"bar_model", told.bar_model},
                    {"dispersion", name_of(told.options.theory)},
                    {"gauges", told.waves.gauges},
                    {"far_end_known", told.waves.end_known},
                    {"equilibrium", told.options.equilibrium},
                    {"band_limit_Hz", told.waves.band_limit_Hz},
                    {"quiet_samples", static_cast<double>(told.waves.quiet)},
                    {"quiet_until_s", told.time_s(told.waves.quiet)},
                    {"known_until_s", told.time_s(told.waves.known)},
                    {"blind", std::move(blind)},
                    {"left", std::move(left)},
                    {"time_s", std::move(time_s)},
                    {"places", std::move(places)}};
}

double most(const std::vector<double>& history, std::size_t known) {
  double largest = 0.0;
  for (std::size_t n = 0; n < known; ++n) {
    largest = std::abs(history[n]) > std::abs(largest) ? history[n] : largest;
  }
  return largest;
}

std::string place_text(const Told& told, const WavesAtPlace& place) {
  const std::size_t known = told.waves.known;
  const double noise_Pa = place.stress_noise_Pa[known - 1];
  return report_row(
      "at " + with_unit(place.position_m, "m"),
      fmt::format("right-going {}, left-going {}, stress {}, velocity {} at most{}",
                  with_unit(most(place.waves.right_going, known), "strain"),
                  with_unit(most(place.waves.left_going, known), "strain"),
                  with_unit(most(place.waves.stress_Pa, known), "Pa"),
                  with_unit(most(place.waves.velocity_m_per_s, known), "m/s"),
                  noise_Pa > 0.0 ? "; stress in the end to " + with_unit(noise_Pa, "Pa") : ""));
}

/// Gauges that see the same of both ways' waves tell nothing, by whatever number.
std::string how_blind(double noise_gain) {
  constexpr double kNothingElse = 1000.0;
  return noise_gain < kNothingElse ? fmt::format("{:.0f} times the noise", noise_gain)
                                   : std::string("noise and nothing else");
}

std::string blind_text(const RecordedWaves& waves) {
  if (waves.blind.empty()) {
    return report_row("blind", "nowhere in the band");
  }
  std::string text;
  constexpr std::size_t kMostNamed = 4;
  for (std::size_t i = 0; i < std::min(waves.blind.size(), kMostNamed); ++i) {
    text += (text.empty() ? "" : ", ") + with_unit(waves.blind[i].frequency_Hz, "Hz") + " (" +
            how_blind(waves.blind[i].noise_gain) + ")";
  }
  if (waves.blind.size() > kMostNamed) {
    text += fmt::format(" and {} more", waves.blind.size() - kMostNamed);
  }
  return report_row("blind", "at " + text);
}

std::string end_text(const Told& told) {
  if (told.options.equilibrium) {
    return " and the output bar's force, as if the specimen were in equilibrium";
  }
  return told.waves.end_known ? " and the far end as filed" : "";
}

std::string report(const Told& told, const Terminal& terminal) {
  const RecordedWaves& waves = told.waves;
  std::string text = told.shot.id + "  " + told.capture + "\n";
  text += report_row("bar", told.options.bar + ": " + told.bar_model + "; " +
                                name_of(told.options.theory) + " waves up to " +
                                with_unit(waves.band_limit_Hz, "Hz"));
  text += report_row("told apart by", joined(waves.gauges) + end_text(told) + ", until " +
                                          with_unit(told.time_s(waves.known), "s"));
  if (waves.quiet < kFewestQuiet) {
    text += report_row("quiet start",
                       fmt::format("baselines and noise are from {} samples before the pulse "
                                   "(wanted: {})",
                                   waves.quiet, kFewestQuiet));
  }
  for (const WavesAtPlace& place : waves.places) {
    text += place_text(told, place);
  }
  text += blind_text(waves);
  for (const GaugeLeft& gauge : waves.left) {
    text += report_row("left at " + gauge.gauge,
                       fmt::format("{} rms, its noise is {}", with_unit(gauge.left_rms, "strain"),
                                   with_unit(gauge.noise_rms, "strain")));
  }
  constexpr int kColumns = 100;
  constexpr int kRows = 12;
  for (const WavesAtPlace& place : waves.places) {
    text += "\n" + plot_text(waves_panel(waves, place, told.period_s()),
                             {std::min(terminal.columns, kColumns), kRows}, terminal.colour);
  }
  return text;
}

std::string table(const Told& told) {
  std::string text = "time_s";
  for (const WavesAtPlace& place : told.waves.places) {
    for (const char* quantity : {"right_going", "left_going", "stress_Pa", "velocity_m_per_s"}) {
      text += fmt::format(",{}_at_{:g}_m", quantity, place.position_m);
    }
  }
  text += "\n";
  for (std::size_t n = 0; n < told.waves.known; ++n) {
    text += fmt::format("{:.9g}", told.time_s(n));
    for (const WavesAtPlace& place : told.waves.places) {
      text += fmt::format(",{:.9g},{:.9g},{:.9g},{:.9g}", place.waves.right_going[n],
                          place.waves.left_going[n], place.waves.stress_Pa[n],
                          place.waves.velocity_m_per_s[n]);
    }
    text += "\n";
  }
  return text;
}

int run(const Settings& settings, Context& context) {
  const Told told = tell(settings);
  if (settings.csv) {
    write_output(*settings.csv, table(told));
  }
  if (settings.svg) {
    write_output(*settings.svg,
                 render_svg(recorded_waves_figure(told.waves, told.period_s(), told.shot.id)));
  }
  context.out << (context.json ? to_text(describe(told)) + "\n" : report(told, context.terminal));
  return kDone;
}

}  // namespace

Command waves_command() {
  auto settings = std::make_shared<Settings>();
  Settings& s = *settings;
  Command command;
  command.name = "waves";
  command.purpose =
      "a bar's right- and left-going waves, stress and velocity anywhere along it, from its "
      "gauges\n"
      "By maximum likelihood with each gauge's noise: two gauges, or one and the far end as "
      "filed,\n"
      "tell waves apart that overlap. Names the frequencies to which they are blind, and with "
      "more\n"
      "gauges than it takes what the waves leave of each record. Compression positive.";
  command.examples =
      "  kolsky waves shot.h5\n"
      "  kolsky waves shot.h5 --bar output --at 0,0.5 --csv waves.csv --svg waves.svg\n"
      "  kolsky waves bar.h5 --bar-model pmma.toml --dispersion exact --at 0.7\n";
  command.arguments = {
      needed("CAPTURE", "", "the capture, of a bench of any kind", &s.capture),
      bar_option(&s.bar),
      option("--at", "M,M,...",
             "where, in m from the bar's start (its impacted end, or the specimen's); else at\n"
             "both of its ends",
             &s.at),
      option("--bar-model", "M.toml",
             "material file of viscoelastic bars; else the capture's own, else the paper's PMMA",
             &s.bar_model),
      dispersion_option(
          "how waves travel in the bar: elementary (the paper, default), love or exact",
          &s.dispersion),
      option("--band-limit", "HZ",
             "upper end of the frequencies used, in Hz; else what noise and bar model allow",
             &s.band_limit_Hz),
      flag("--gauges-only",
           "take nothing for known of the bar's far end, which else is free, or matched as filed",
           &s.gauges_only),
      flag("--equilibrium",
           "of the input bar: take the output bar's force for the force at its end, as of a\n"
           "specimen in equilibrium; one gauge is enough then",
           &s.equilibrium),
      option("--csv", "FILE", "a table of the histories to write", &s.csv),
      option("--svg", "FILE", "a page of plots to write", &s.svg)};
  command.run = [settings](Context& context) { return run(*settings, context); };
  return command;
}

}  // namespace kolsky::cli
