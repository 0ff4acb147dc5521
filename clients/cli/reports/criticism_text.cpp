#include "clients/cli/reports/criticism_text.hpp"

#include <fmt/format.h>

namespace kolsky::cli {

JsonValue describe(const Misfit& misfit) {
  return JsonObject{{"chi2_reduced", misfit.chi2_reduced},
                    {"repeatable_share", misfit.repeatable_share},
                    {"noise_floor_share", misfit.noise_floor_share},
                    {"scatter_share", misfit.scatter_share},
                    {"degrees_of_freedom", misfit.degrees_of_freedom},
                    {"noise_scale", misfit.noise_scale}};
}

std::string misfit_text(const Misfit& misfit) {
  return fmt::format("misfit: chi2 {:.4f} per degree of freedom ({:.0f})\n", misfit.chi2_reduced,
                     misfit.degrees_of_freedom);
}

}  // namespace kolsky::cli
