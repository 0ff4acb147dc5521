#include "processing/specimen/shpb_model.hpp"

#include <cmath>
#include <utility>

#include "processing/base/error.hpp"

namespace kolsky {

namespace {

constexpr std::array kNames{std::pair{SpecimenWaves::massless, "massless"},
                            std::pair{SpecimenWaves::rod, "rod"},
                            std::pair{SpecimenWaves::lateral, "lateral"}};

/// The specimen between the bars at one s: admittance of its front, and back force over front
/// force.
struct Loaded {
  Complex admittance;
  Complex transmitted;
};

class SpecimenLine {
 public:
  SpecimenLine(SpecimenWaves waves, const Specimen& specimen)
      : waves_(waves), length_m_(specimen.length_m), area_m2_(specimen.area_m2()) {
    if (waves_ != SpecimenWaves::massless) {
      if (!specimen.density_kg_m3) {
        throw InputError("specimen.density_kg_m3", "is missing, so its inertia is not known",
                         "file it, or take the specimen as massless");
      }
      density_kg_m3_ = *specimen.density_kg_m3;
    }
    if (waves_ == SpecimenWaves::lateral) {
      if (!specimen.poisson_ratio) {
        throw InputError("specimen.poisson_ratio", "is missing, so lateral inertia is not known",
                         "file it, or leave lateral inertia out");
      }
      const double radius_m = specimen.diameter_m / 2.0;
      lateral_ = 0.5 * density_kg_m3_ * std::pow(*specimen.poisson_ratio * radius_m, 2);
    }
  }

  [[nodiscard]] Loaded at(Complex s, Complex J, Complex behind) const {
    if (waves_ == SpecimenWaves::massless) {
      return {behind + s * length_m_ * J / area_m2_, 1.0};
    }
    const Complex gamma = s * std::sqrt(density_kg_m3_ / (1.0 / J + lateral_ * s * s));
    const Complex impedance = area_m2_ * density_kg_m3_ * s / gamma;
    const Complex half = std::exp(-gamma * length_m_);
    const Complex cosh = (1.0 / half + half) / 2.0;
    const Complex sinh = (1.0 / half - half) / 2.0;
    const Complex front = cosh + impedance * sinh * behind;
    return {(sinh / impedance + cosh * behind) / front, 1.0 / front};
  }

 private:
  SpecimenWaves waves_;
  double length_m_;
  double area_m2_;
  double density_kg_m3_ = 0.0;
  double lateral_ = 0.0;
};

}  // namespace

std::string name_of(SpecimenWaves waves) {
  for (const auto& [known, name] : kNames) {
    if (waves == known) {
      return name;
    }
  }
  return {};
}

SpecimenWaves specimen_waves(const std::string& name) {
  for (const auto& [waves, known] : kNames) {
    if (name == known) {
      return waves;
    }
  }
  throw InputError("specimen waves", "\"" + name + "\" is not one",
                   "give massless, rod or lateral");
}

const std::vector<BarMode>& ShpbModel::modes(WaveTheory theory, const MovedShpb& moved,
                                             std::size_t bar, const std::vector<Complex>& path,
                                             std::size_t slot) {
  const Bar& b = moved.bars[bar];
  const double modulus = b.youngs_modulus_Pa ? b.youngs_modulus_Pa->value : 0.0;
  std::vector<double> key = {static_cast<double>(theory),
                             static_cast<double>(path.size()),
                             b.density_kg_m3,
                             modulus,
                             theory == WaveTheory::elementary ? 0.0 : b.dispersion_radius_m(),
                             theory == WaveTheory::elementary ? 0.0 : b.poisson_ratio.value};
  if (!b.youngs_modulus_Pa) {
    const Material& material = b.material ? *b.material : moved.material;
    key.push_back(static_cast<double>(material.solid));
    key.insert(key.end(), material.parameters.begin(), material.parameters.end());
  }
  KeptModes& kept = kept_[slot][bar];
  if (kept.key != key) {
    const auto compliance = compliance_of(b, moved.material);
    kept.modes = bar_modes(theory, b, *compliance, path);
    kept.key = std::move(key);
  }
  return kept.modes;
}

void ShpbModel::evaluate(const ShpbTheory& theory, const MovedShpb& moved,
                         const Compliance& specimen, const std::vector<Complex>& path,
                         std::size_t slot, std::vector<std::vector<Complex>>& transfers,
                         ShpbPerForce* per_N) {
  if (per_N != nullptr) {
    per_N->resize(path.size());
  }
  const auto& input = modes(theory.bars, moved, 0, path, slot);
  const auto& output = modes(theory.bars, moved, 1, path, slot);
  const SpecimenLine line(theory.specimen, moved.specimen);
  const std::array<double, 2> strength = {moved.bars[0].area_m2() * moved.bars[0].density_kg_m3,
                                          moved.bars[1].area_m2() * moved.bars[1].density_kg_m3};
  const double far_m = moved.bars[1].length_m;
  const bool free_end = moved.bars[1].far_end == FarEnd::free;
  const double d0 = moved.to_specimen_m[0];
  transfers.assign(stations_.size() - 1, std::vector<Complex>(path.size()));
  for (std::size_t k = 0; k < path.size(); ++k) {
    const Complex s = path[k];
    const Complex gamma = input[k].gamma;
    const Complex gamma_out = output[k].gamma;
    const Complex Z_in = strength[0] * s / gamma;
    const Complex Z_out = strength[1] * s / gamma_out;
    const Complex there_and_back = free_end ? std::exp(-2.0 * gamma_out * far_m) : 0.0;
    const Complex behind = (1.0 + there_and_back) / (Z_out * (1.0 - there_and_back));
    const Loaded loaded = line.at(s, specimen.at(s), behind);
    const Complex mismatch = Z_in * loaded.admittance;
    const Complex r = (1.0 - mismatch) / (1.0 + mismatch);
    // Strain at the first station for a unit wave of velocity that arrives at the specimen, less
    // the factor exp(gamma d0).
    const Complex reading = gamma / (s * input[k].mean_over_surface);
    const Complex first = moved.gain[0] * reading * (1.0 + r * std::exp(-2.0 * gamma * d0));
    if (per_N != nullptr) {
      const double length_m = moved.bars[0].length_m;
      const Complex round_trips = 1.0 + r * std::exp(-2.0 * gamma * length_m);
      const Complex front = (1.0 + r) * std::exp(-gamma * length_m) / round_trips;
      const Complex back = loaded.transmitted * front;
      per_N->first[k] = first * std::exp(-gamma * (length_m - d0)) / (Z_in * round_trips);
      per_N->force_front[k] = front;
      per_N->force_back[k] = back;
      per_N->velocity_front_m_per_s[k] = loaded.admittance * front;
      per_N->velocity_back_m_per_s[k] = behind * back;
    }
    // Velocity wave into the output bar: what a second bar's strain follows from.
    const Complex launched = loaded.transmitted * Z_in * (1.0 + r) /
                             (Z_out * (1.0 - there_and_back)) * std::exp(-gamma * d0) / first;
    const Complex reading_out = gamma_out / (s * output[k].mean_over_surface);
    for (std::size_t j = 1; j < stations_.size(); ++j) {
      const double d = moved.to_specimen_m[j];
      const double late_s = moved.delay_s[j] - moved.delay_s[0];
      if (stations_[j].on_input) {
        transfers[j - 1][k] = moved.gain[j] * reading * std::exp(-gamma * (d0 - d)) *
                              (1.0 + r * std::exp(-2.0 * gamma * d)) / first;
      } else {
        const Complex back = free_end ? std::exp(-gamma_out * (2.0 * far_m - d)) : 0.0;
        transfers[j - 1][k] =
            moved.gain[j] * reading_out * launched * (std::exp(-gamma_out * d) - back);
      }
      if (late_s != 0.0) {
        transfers[j - 1][k] *= std::exp(-s * late_s);
      }
    }
  }
}

}  // namespace kolsky
