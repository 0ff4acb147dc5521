#include "processing/reduction/corrections.hpp"

#include <algorithm>
#include <cmath>

#include "processing/base/error.hpp"

namespace kolsky {

namespace {

/// d/dt by central differences.
std::vector<double> slope_of(const std::vector<double>& history,
                             const std::vector<double>& time_s) {
  const std::size_t count = history.size();
  std::vector<double> slope(count, 0.0);
  for (std::size_t n = 0; n < count && count > 1; ++n) {
    const std::size_t before = n > 0 ? n - 1 : 0;
    const std::size_t after = std::min(n + 1, count - 1);
    slope[n] = (history[after] - history[before]) / (time_s[after] - time_s[before]);
  }
  return slope;
}

/// What a face's stress, or the mean of both, has more than the mean over the specimen.
struct AxialShare {
  double of_straining;  ///< of rho h^2 e'
  double of_motion;     ///< of rho h times the back face's acceleration
};

AxialShare axial_share(StressFrom from) {
  switch (from) {
    case StressFrom::back:
      return {-1.0 / 6.0, -1.0 / 2.0};
    case StressFrom::front:
      return {1.0 / 3.0, 1.0 / 2.0};
    case StressFrom::both_faces:
      break;
  }
  return {1.0 / 12.0, 0.0};
}

/// What is left of the specimen's length.
double length_left(double strain) {
  constexpr double kLeast = 1e-3;
  return std::max(kLeast, 1.0 - strain);
}

void take_off_axial_inertia(StressFrom from, const Specimen& specimen, double density_kg_m3,
                            std::span<const double> rate_of_front_per_s, Reduction& r) {
  const std::vector<double> growth = slope_of(r.strain_rate_per_s, r.time_s);
  std::vector<double> rate_of_back(r.strain_rate_per_s.size());
  for (std::size_t n = 0; n < rate_of_back.size(); ++n) {
    rate_of_back[n] = rate_of_front_per_s[n] - r.strain_rate_per_s[n];
  }
  const std::vector<double> back_growth = slope_of(rate_of_back, r.time_s);
  const AxialShare share = axial_share(from);
  const double unit_Pa_s2 = density_kg_m3 * std::pow(specimen.length_m, 2);
  for (std::size_t n = 0; n < r.stress_Pa.size(); ++n) {
    r.stress_Pa[n] -=
        unit_Pa_s2 * (share.of_straining * growth[n] + share.of_motion * back_growth[n]);
  }
}

void take_off_radial_inertia(const Specimen& specimen, double density_kg_m3, Reduction& r) {
  constexpr double kKeepsItsVolume = 0.5;
  const double nu = specimen.poisson_ratio ? specimen.poisson_ratio->value : kKeepsItsVolume;
  const double unit_Pa_s2 = density_kg_m3 * std::pow(nu * specimen.diameter_m / 2.0, 2) / 2.0;
  const std::vector<double> growth = slope_of(r.strain_rate_per_s, r.time_s);
  for (std::size_t n = 0; n < r.stress_Pa.size(); ++n) {
    const double left = length_left(r.strain[n]);
    const double square = std::pow(r.strain_rate_per_s[n], 2);
    r.stress_Pa[n] -=
        unit_Pa_s2 * std::pow(left, -2.0 - 2.0 * nu) * (growth[n] + (1.0 + nu) * square / left);
  }
}

void take_off_inertia(StressFrom from, const Corrections& corrections, const Specimen& specimen,
                      std::span<const double> rate_of_front_per_s, Reduction& r) {
  if (!specimen.density_kg_m3) {
    throw InputError("specimen.density_kg_m3", "is missing, so its inertia is not known",
                     "file it, or leave the inertia corrections out");
  }
  const double density_kg_m3 = *specimen.density_kg_m3;
  if (corrections.radial_inertia) {
    take_off_radial_inertia(specimen, density_kg_m3, r);
  }
  if (corrections.axial_inertia) {
    take_off_axial_inertia(from, specimen, density_kg_m3, rate_of_front_per_s, r);
  }
}

/// Of faces that are pressed: a specimen that is pulled by a later wave comes off them.
void take_off_friction(double coefficient, const Specimen& specimen, Reduction& r) {
  const double slender = specimen.diameter_m / (3.0 * specimen.length_m);
  for (std::size_t n = 0; n < r.stress_Pa.size(); ++n) {
    if (r.stress_Pa[n] > 0.0) {
      r.stress_Pa[n] /= 1.0 + coefficient * slender * std::pow(length_left(r.strain[n]), -1.5);
    }
  }
}

}  // namespace

StressFrom stress_from(const std::string& name) {
  for (const StressFrom from : {StressFrom::both_faces, StressFrom::back, StressFrom::front}) {
    if (name == name_of(from)) {
      return from;
    }
  }
  throw InputError("stress", "\"" + name + "\" is not a way to take it",
                   "give three-wave, one-wave or two-wave");
}

std::string name_of(StressFrom from) {
  switch (from) {
    case StressFrom::back:
      return "one-wave";
    case StressFrom::front:
      return "two-wave";
    case StressFrom::both_faces:
      break;
  }
  return "three-wave";
}

std::vector<std::string> names_of(const Corrections& corrections) {
  std::vector<std::string> names;
  if (corrections.axial_inertia) {
    names.emplace_back("axial inertia");
  }
  if (corrections.radial_inertia) {
    names.emplace_back("radial inertia");
  }
  if (corrections.friction) {
    names.emplace_back("friction");
  }
  return names;
}

void set_stress(StressFrom from, const Corrections& corrections, const Specimen& specimen,
                std::span<const double> rate_of_front_per_s, Reduction& r) {
  const double area_m2 = specimen.area_m2();
  for (std::size_t n = 0; n < r.stress_Pa.size(); ++n) {
    const double front = r.force_front_N[n];
    const double back = r.force_back_N[n];
    r.stress_Pa[n] = from == StressFrom::back    ? back / area_m2
                     : from == StressFrom::front ? front / area_m2
                                                 : (front + back) / (2.0 * area_m2);
  }
  if (corrections.axial_inertia || corrections.radial_inertia) {
    // Where equilibrium was assumed, both forces are the back face's.
    const StressFrom taken = r.separation == Separation::equilibrium ? StressFrom::back : from;
    take_off_inertia(taken, corrections, specimen, rate_of_front_per_s, r);
  }
  if (corrections.friction) {
    take_off_friction(*corrections.friction, specimen, r);
  }
}

}  // namespace kolsky
