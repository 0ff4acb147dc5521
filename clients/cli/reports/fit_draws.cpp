#include "clients/cli/reports/fit_draws.hpp"

#include <fmt/format.h>

#include "clients/cli/reports/intervals.hpp"

namespace kolsky::cli {
namespace {

std::string table_of(const DrawnNumbers& drawn) {
  std::string text;
  for (const UncertainFigure& f : drawn.figures) {
    text += fmt::format("    {:<12}{:>12.5g} ± {:.2g} %, 95 %: {:.5g} to {:.5g}\n", f.name, f.value,
                        100.0 * f.sd / f.value, f.low, f.high);
  }
  if (drawn.failed > 0) {
    text += fmt::format("    {} more found nothing\n", drawn.failed);
  }
  for (const std::string& warning : drawn.warnings) {
    text += "    " + warning + "\n";
  }
  return text;
}

JsonObject numbers_json(const DrawnNumbers& drawn) {
  return {{"draws", static_cast<std::uint64_t>(drawn.draws)},
          {"failed", static_cast<std::uint64_t>(drawn.failed)},
          {"coverage", 0.95},
          {"parameters", intervals_json(drawn.figures)},
          {"warnings", drawn.warnings}};
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
  JsonObject object = numbers_json(draws->fit);
  object.push_back({"spectral", draws->spectral ? JsonValue(numbers_json(*draws->spectral))
                                                : JsonValue(nullptr)});
  return object;
}

std::string report(const std::optional<FitDraws>& draws) {
  if (!draws) {
    return "";
  }
  std::string text =
      fmt::format("  by {} draws of noise and of what is filed, through the fit itself\n",
                  draws->fit.draws) +
      table_of(draws->fit);
  if (draws->spectral) {
    text += fmt::format(
        "  strain over stress, whose deviations above are scatter alone, by {} of these draws\n",
        draws->spectral->draws);
    text += table_of(*draws->spectral);
  }
  return text;
}

}  // namespace kolsky::cli
