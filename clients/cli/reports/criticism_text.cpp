#include "clients/cli/reports/criticism_text.hpp"

#include <fmt/format.h>

namespace kolsky::cli {

JsonValue describe(const Misfit& misfit) {
  return JsonObject{{"chi2_reduced", misfit.chi2_reduced},
                    {"repeatable_share", misfit.repeatable_share},
                    {"noise_floor_share", misfit.noise_floor_share},
                    {"scatter_share", misfit.scatter_share},
                    {"degrees_of_freedom", misfit.degrees_of_freedom},
                    {"noise_scale", misfit.noise_scale},
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
