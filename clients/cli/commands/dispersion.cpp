#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <memory>
#include <ostream>

#include "clients/cli/bar_model_file.hpp"
#include "clients/cli/bar_options.hpp"
#include "clients/cli/command.hpp"
#include "clients/cli/outputs.hpp"
#include "clients/cli/reports/reduced_shot.hpp"
#include "clients/figure/layout.hpp"
#include "clients/report/svg.hpp"
#include "clients/terminal/plot.hpp"
#include "drivers/files/settings/bench_file.hpp"
#include "processing/base/bar_model_check.hpp"
#include "processing/base/error.hpp"
#include "processing/base/range.hpp"
#include "processing/waves/wave_table.hpp"

namespace kolsky::cli {
namespace {

constexpr std::array kTheories = {WaveTheory::elementary, WaveTheory::love, WaveTheory::exact};

struct Settings {
  std::string bench;
  std::optional<std::string> bar;
  std::optional<std::string> bar_model;
  std::optional<std::string> dispersion;
  std::optional<double> highest_Hz;
  std::optional<std::uint64_t> points;
  std::optional<std::string> csv;
  std::optional<std::string> svg;
};

/// A bar, what it is made of, and how waves go in it by each theory.
struct Tabulated {
  std::string bar;
  std::string bar_model;  ///< for people
  WaveTheory theory = WaveTheory::exact;
  std::array<std::vector<WaveRow>, kTheories.size()> tables;

  [[nodiscard]] const std::vector<WaveRow>& table() const {
    return tables.at(
        static_cast<std::size_t>(std::ranges::find(kTheories, theory) - kTheories.begin()));
  }
};

std::vector<WaveRow> table_of(WaveTheory theory, const Bar& bar, const Compliance& compliance,
                              double highest_Hz, std::uint64_t points) {
  try {
    return wave_table(theory, bar, compliance, highest_Hz, points);
  } catch (const InputError& error) {
    throw InputError(
        std::string("kolsky dispersion: ") + (error.place() == "points" ? "--points" : "--to"),
        error.problem(), error.mend());
  }
}

const Bar& bar_of(const Bench& bench, const std::string& name) {
  try {
    return bar_named(bench, name);
  } catch (const InputError& error) {
    throw InputError("kolsky dispersion: --bar", error.problem(), error.mend());
  }
}

/// The bar model given, and up to where it is known: nothing and without an end of elastic bars.
struct BarModel {
  std::optional<Material> material;
  double most_band_Hz = std::numeric_limits<double>::infinity();
};

/// Its own, as the bench has it.
BarModel own_model_of(const Settings& settings, const Bench& bench, const Bar& bar) {
  const Material& own = *bar.material;
  require_own_material_holds(bench);
  require_own_band_known(bench, settings.highest_Hz);
  BarModel model{own};
  if (own.identified && own.identified->band_limit_Hz) {
    model.most_band_Hz = *own.identified->band_limit_Hz;
  }
  return model;
}

BarModel bar_model_of(const Settings& settings, const Bench& bench, const Bar& bar) {
  if (bar.material) {
    return own_model_of(settings, bench, bar);
  }
  if (!settings.bar_model) {
    return {};
  }
  const BarModelFile file = read_bar_model(*settings.bar_model);
  require_holds(file, bench);
  if (bar.youngs_modulus_Pa) {
    return {};
  }
  require_band(file, settings.highest_Hz);
  BarModel model{file.prior.material};
  model.most_band_Hz = file.band_limit_Hz.value_or(model.most_band_Hz);
  return model;
}

Tabulated tabulate(const Settings& settings) {
  constexpr std::uint64_t kPoints = 120;
  constexpr std::uint64_t kMostPoints = 100'000;
  const std::uint64_t points = settings.points.value_or(kPoints);
  if (points > kMostPoints) {
    throw InputError("kolsky dispersion: --points", "are more than 100000", "give fewer");
  }
  const Bench bench = read_bench(settings.bench).bench;
  Tabulated result;
  result.bar = settings.bar.value_or("input");
  const Bar& bar = bar_of(bench, result.bar);
  if (settings.dispersion) {
    result.theory = wave_theory(*settings.dispersion);
  }
  const BarModel model = bar_model_of(settings, bench, bar);
  std::unique_ptr<const Compliance> compliance;
  try {
    result.bar_model = bar_in_words(bar, bench, model.material);
    compliance = compliance_of(bar, model.material ? *model.material : assumed_bars(bench));
  } catch (const InputError& error) {
    throw error.inside(settings.bench);
  }
  const double highest_Hz =
      settings.highest_Hz.value_or(std::min(thick_from_Hz(bar, *compliance), model.most_band_Hz));
  for (std::size_t i = 0; i < kTheories.size(); ++i) {
    result.tables.at(i) = table_of(kTheories.at(i), bar, *compliance, highest_Hz, points);
  }
  return result;
}

std::vector<double> column(const std::vector<WaveRow>& table, double WaveRow::*number) {
  std::vector<double> values;
  values.reserve(table.size());
  for (const WaveRow& row : table) {
    values.push_back(row.*number);
  }
  return values;
}

Panel panel(const Tabulated& result, const std::string& title, const Axis& y,
            double WaveRow::*number) {
  Panel panel{title, {"frequency", "Hz"}, y, {}};
  for (std::size_t i = 0; i < kTheories.size(); ++i) {
    panel.series.push_back({name_of(kTheories.at(i)),
                            column(result.tables.at(i), &WaveRow::frequency_Hz),
                            column(result.tables.at(i), number)});
  }
  return panel;
}

std::array<Panel, 2> panels(const Tabulated& result) {
  return {panel(result, "phase speed", {"speed", "m/s"}, &WaveRow::phase_speed_m_per_s),
          panel(result, "attenuation", {"attenuation", "1/m"}, &WaveRow::attenuation_per_m)};
}

std::string report(const Tabulated& result, const Terminal& terminal) {
  std::string text = report_row("bar", result.bar + ": " + result.bar_model);
  text += report_row("waves", name_of(result.theory));
  text += fmt::format("\n  {:>9}  {:>10}  {:>9}  {:>10}  {:>12}\n", "f [kHz]", "c [m/s]", "α [1/m]",
                      "k [rad/m]", "mean/surface");
  constexpr std::size_t kRows = 12;
  const std::vector<WaveRow>& table = result.table();
  const std::size_t every = std::max<std::size_t>(1, table.size() / kRows);
  for (std::size_t n = every - 1; n < table.size(); n += every) {
    const WaveRow& row = table[n];
    text += fmt::format("  {:>9.4g}  {:>10.2f}  {:>9.5f}  {:>10.4f}  {:>12.5f}\n",
                        1e-3 * row.frequency_Hz, row.phase_speed_m_per_s, row.attenuation_per_m,
                        row.wavenumber_per_m, std::abs(row.mean_over_surface));
  }
  constexpr int kColumns = 100;
  constexpr int kPlotRows = 12;
  for (const Panel& each : panels(result)) {
    text +=
        "\n" + plot_text(each, {std::min(terminal.columns, kColumns), kPlotRows}, terminal.colour);
  }
  return text;
}

struct Column {
  std::string name;
  std::vector<double> values;
};

/// The table as files have it.
std::vector<Column> columns(const Tabulated& result) {
  const auto of = [&](const std::string& name, const auto& number) {
    Column column{name, {}};
    std::ranges::transform(result.table(), std::back_inserter(column.values), number);
    return column;
  };
  using Row = const WaveRow&;
  return {
      of("frequency_Hz", [](Row row) { return row.frequency_Hz; }),
      of("phase_speed_m_per_s", [](Row row) { return row.phase_speed_m_per_s; }),
      of("alpha_per_m", [](Row row) { return row.attenuation_per_m; }),
      of("wavenumber_per_m", [](Row row) { return row.wavenumber_per_m; }),
      of("mean_over_surface_real", [](Row row) { return row.mean_over_surface.real(); }),
      of("mean_over_surface_imag", [](Row row) { return row.mean_over_surface.imag(); }),
      of("stress_over_strain_real_Pa", [](Row row) { return row.stress_over_strain_Pa.real(); }),
      of("stress_over_strain_imag_Pa", [](Row row) { return row.stress_over_strain_Pa.imag(); })};
}

JsonValue describe(const Tabulated& result) {
  JsonObject object{
      {"bar", result.bar}, {"bar_model", result.bar_model}, {"dispersion", name_of(result.theory)}};
  for (Column& column : columns(result)) {
    object.push_back({column.name, std::move(column.values)});
  }
  return object;
}

std::string csv(const Tabulated& result) {
  const std::vector<Column> all = columns(result);
  std::string text;
  for (const Column& column : all) {
    text += (text.empty() ? "" : ",") + column.name;
  }
  for (std::size_t n = 0; n < result.table().size(); ++n) {
    for (const Column& column : all) {
      text += fmt::format("{}{:.12g}", &column == &all.front() ? "\n" : ",", column.values[n]);
    }
  }
  return text + "\n";
}

int run(const Settings& settings, Context& context) {
  const Tabulated result = tabulate(settings);
  if (settings.csv) {
    write_output(*settings.csv, csv(result));
  }
  if (settings.svg) {
    const std::array<Panel, 2> both = panels(result);
    write_output(*settings.svg, render_svg({"waves in the " + result.bar + " bar",
                                            {result.bar_model},
                                            {both.begin(), both.end()}}));
  }
  context.out << (context.json ? to_text(describe(result)) + "\n"
                               : report(result, context.terminal));
  return kDone;
}

}  // namespace

Command dispersion_command() {
  auto settings = std::make_shared<Settings>();
  Settings& s = *settings;
  Command command;
  command.name = "dispersion";
  command.purpose =
      "how waves travel in a bench's bar: speed, attenuation, wavenumber by frequency\n"
      "Of an elastic bar or a bar model: elementary, Love's, and exact waves (Pochhammer and "
      "Chree,\n"
      "first mode), with mean over surface strain (what gauges miss) and mean stress over strain.";
  command.examples =
      "  kolsky dispersion --bench bench.toml\n"
      "  kolsky dispersion --bench bench.toml --bar-model pmma.toml --to 60e3 --csv pmma.csv\n"
      "  kolsky dispersion --bench bench.toml --bar output --svg waves.svg\n";
  command.arguments = {
      needed("--bench", "B.toml", "bench file with the bar", &s.bench),
      bar_option(&s.bar),
      option("--bar-model", "M.toml", "material file of viscoelastic bars; else the paper's PMMA",
             &s.bar_model),
      dispersion_option(
          "which waves are tabulated: exact (default), love or elementary; plots show all",
          &s.dispersion),
      option(
          "--to", "HZ",
          "highest frequency, in Hz; by default where the radius is 0.3 wavelengths, or as far as\n"
          "the bar model is known",
          &s.highest_Hz),
      option("--points", "N", "how many frequencies, evenly; 120 by default", &s.points),
      option("--csv", "FILE", "the whole table to write", &s.csv),
      option("--svg", "FILE", "a page of plots to write", &s.svg)};
  command.run = [settings](Context& context) { return run(*settings, context); };
  return command;
}

}  // namespace kolsky::cli
