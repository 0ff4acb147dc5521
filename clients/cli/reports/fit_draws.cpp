#include "clients/cli/reports/fit_draws.hpp"

#include <fmt/format.h>

#include "clients/cli/reports/intervals.hpp"

namespace kolsky::cli {
namespace {

std::string table_of(const std::vector<UncertainFigure>& figures) {
  std::string text;
  for (const UncertainFigure& f : figures) {
    text += fmt::format("    {:<12}{:>12.5g} ± {:.2g} %, 95 %: {:.5g} to {:.5g}\n", f.name, f.value,
                        100.0 * f.sd / f.value, f.low, f.high);
  }
  return text;
}

}  // namespace

FitDrawOptions draw_options(std::uint64_t draws, SlowWork& progress) {
  FitDrawOptions options;
  options.draws = draws;
  options.progress = [&progress](std::size_t done, std::size_t of) {
    progress.at(fmt::format("{} of {} draws fitted", done, of));
  };
  return options;
}

JsonValue describe(const std::optional<FitDraws>& draws) {
  if (!draws) {
    return nullptr;
  }
  return JsonObject{{"draws", static_cast<std::uint64_t>(draws->draws)},
                    {"failed", static_cast<std::uint64_t>(draws->failed)},
                    {"coverage", 0.95},
                    {"parameters", intervals_json(draws->parameters)},
                    {"spectral", intervals_json(draws->spectral)}};
}

std::string report(const std::optional<FitDraws>& draws) {
  if (!draws) {
    return "";
  }
  std::string text = fmt::format(
      "  by {} draws of noise and of what is filed, through the fit itself{}\n", draws->draws,
      draws->failed > 0 ? fmt::format(" ({} more could not be fitted)", draws->failed) : "");
  text += table_of(draws->parameters);
  if (!draws->spectral.empty()) {
    text += "  strain over stress, whose deviations above are scatter alone, by the same draws\n";
    text += table_of(draws->spectral);
  }
  return text;
}

}  // namespace kolsky::cli
