#include "processing/base/striker.hpp"

#include <charconv>
#include <cmath>

#include "processing/base/error.hpp"

namespace kolsky {

std::optional<Measured> filed_striker_speed(const Shot& shot) {
  const auto found = shot.meta.find("striker_speed_m_per_s");
  if (found != shot.meta.end()) {
    double value = 0.0;
    const char* end = found->second.data() + found->second.size();
    if (std::from_chars(found->second.data(), end, value).ptr != end || !(value > 0.0) ||
        !std::isfinite(value)) {
      throw InputError("capture " + shot.id + ": meta striker_speed_m_per_s",
                       "\"" + found->second + "\" is no speed", "give metres per second, as 12.5");
    }
    const double sd = shot.bench.striker && shot.bench.striker->speed_m_per_s
                          ? relative_sd(*shot.bench.striker->speed_m_per_s) * value
                          : 0.0;
    return Measured{value, sd};
  }
  return shot.bench.striker ? shot.bench.striker->speed_m_per_s : std::nullopt;
}

std::optional<double> impedance_share(const Striker& striker, const Bar& bar) {
  const double of_density =
      striker.density_kg_m3 ? *striker.density_kg_m3 / bar.density_kg_m3 : 1.0;
  if (striker.of_material(bar)) {
    return of_density;
  }
  if (striker.youngs_modulus_Pa && bar.youngs_modulus_Pa) {
    return std::sqrt(of_density * *striker.youngs_modulus_Pa / *bar.youngs_modulus_Pa);
  }
  return std::nullopt;
}

}  // namespace kolsky
