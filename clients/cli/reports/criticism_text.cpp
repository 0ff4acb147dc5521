#include "clients/cli/reports/criticism_text.hpp"

#include <fmt/format.h>

namespace kolsky::cli {

bool was_reckoned(const Misfit& misfit) {
  return misfit.degrees_of_freedom > 0.0;
}

JsonValue describe(const Misfit& misfit) {
  const auto known = [&](double value) {
    return was_reckoned(misfit) ? JsonValue(value) : JsonValue(nullptr);
  };
  return JsonObject{{"chi2_reduced", known(misfit.chi2_reduced)},
                    {"repeatable_share", known(misfit.repeatable_share)},
                    {"noise_floor_share", known(misfit.noise_floor_share)},
                    {"scatter_share", known(misfit.scatter_share)},
                    {"degrees_of_freedom", known(misfit.degrees_of_freedom)},
                    {"noise_scale", known(misfit.noise_scale)},
                    {"judged_to_Hz", misfit.judged_to_Hz > 0.0 ? JsonValue(misfit.judged_to_Hz)
                                                               : JsonValue(nullptr)}};
}

std::string misfit_text(const Misfit& misfit) {
  return fmt::format("misfit: chi2 {:.4f} per degree of freedom ({:.0f}){}\n", misfit.chi2_reduced,
                     misfit.degrees_of_freedom, judged_text(misfit));
}

std::string judged_text(const Misfit& misfit) {
  return misfit.judged_to_Hz > 0.0
             ? fmt::format(", judged up to {:.3g} kHz", 1e-3 * misfit.judged_to_Hz)
             : "";
}

}  // namespace kolsky::cli
