#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>

#include "processing/base/error.hpp"
#include "tests/generators/interpolation.hpp"
#include "tests/generators/sensor_records.hpp"
#include "tests/generators/shpb_contact.hpp"
#include "tests/generators/solid_specimen.hpp"
#include "tests/generators/unit_source.hpp"

namespace kolsky::testing {

namespace {

// How many cells make every length fit one time step.
struct Mesh {
  int input, output, specimen;
};

double misfit(double cells) {
  return std::abs(cells - std::round(cells)) / cells;
}

Mesh lay_mesh(const ShpbWorld& world, double speed, double step_s) {
  const double in_s = world.base.length_m / speed;
  const double out_s = world.output_length_m / speed;
  const TrueSpecimen& specimen = world.specimen;
  Mesh best{};
  double least = 1e9;
  if (specimen.inertia > 0.0) {
    const double transit_s =
        specimen.length_m / std::sqrt(specimen.E1_Pa / (specimen.inertia * specimen.density_kg_m3));
    const int fewest = std::max(8, static_cast<int>(std::ceil(transit_s / step_s)));
    for (int n = fewest; n < 2 * fewest + 40; ++n) {
      const double step = transit_s / n;
      const double worst = std::max(misfit(in_s / step), misfit(out_s / step));
      if (worst < least) {
        least = worst;
        best = {static_cast<int>(std::lround(in_s / step)),
                static_cast<int>(std::lround(out_s / step)), n};
      }
    }
    return best;
  }
  const int fewest = static_cast<int>(std::ceil(in_s / step_s));
  for (int n = fewest; n < fewest + 400; ++n) {
    const double worst = misfit(out_s * n / in_s);
    if (worst < least) {
      least = worst;
      best = {n, static_cast<int>(std::lround(out_s * n / in_s)), 0};
    }
  }
  return best;
}

double stress_of(const std::vector<double>& bells, const UnitSource& source, double time_s) {
  const auto last = static_cast<std::ptrdiff_t>(std::floor(time_s / source.knot_s));
  double sum = 0.0;
  for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(0, last - 6); k <= last; ++k) {
    if (static_cast<std::size_t>(k) < bells.size()) {
      sum += bells[static_cast<std::size_t>(k)] *
             source.at(time_s - static_cast<double>(k) * source.knot_s);
    }
  }
  return sum;
}

struct Strains {
  double step_s;
  std::vector<std::vector<double>> history;  // per station of all gauges, in their order
};

KelvinChain material_in(const ShpbWorld& world, const TrueShot& shot) {
  const BarWorld& base = world.base;
  return base.material.chain(shot.temperature_K - base.reference_K, shot.peak_strain);
}

// The output bar is as long as its cells, which have the input bar's size.
Strains march(const ShpbWorld& world, const TrueShot& shot, const Mesh& mesh,
              SpecimenHistory* specimen_history) {
  const BarWorld& base = world.base;
  const KelvinChain chain = material_in(world, shot);
  const double cell_m = base.length_m / mesh.input;
  Rod input(chain, base.material.density_kg_m3, base.length_m, mesh.input);
  Rod output(chain, base.material.density_kg_m3, cell_m * mesh.output, mesh.output);
  std::unique_ptr<ShpbContact> contact;
  if (mesh.specimen > 0) {
    contact = std::make_unique<WavySpecimen>(world, mesh.specimen);
  } else if (world.specimen.solid) {
    contact = std::make_unique<SolidSpecimen>(world, input.step_s());
  } else {
    contact = std::make_unique<MasslessSpecimen>(world, input.step_s());
  }
  std::vector<std::pair<const Rod*, double>> stations;
  for (const TrueGauge& gauge : base.gauges) {
    for (const double place : stations_of({gauge})) {
      stations.emplace_back(gauge.bar == "input" ? &input : &output, place);
    }
  }
  const UnitSource source{base.timing.knot_s()};
  Strains out{input.step_s(), std::vector<std::vector<double>>(stations.size(), {0.0})};
  const auto steps = static_cast<std::size_t>(base.timing.window_s() / out.step_s) + 16;
  for (std::size_t n = 1; n < steps; ++n) {
    input.advance();
    output.advance();
    input.close_left(stress_of(shot.source, source, static_cast<double>(n) * out.step_s));
    contact->close(input, output);
    // A dashpot that takes r/2 of what a wall would: all but r of the wave comes back.
    output.close_right(0.5 * base.end_r.value_or(0.0) * output.right().free);
    for (std::size_t i = 0; i < stations.size(); ++i) {
      out.history[i].push_back(stations[i].first->strain_at(stations[i].second));
    }
    if (specimen_history != nullptr) {
      specimen_history->force_N.push_back(contact->force_N());
      specimen_history->strain.push_back(contact->strain());
    }
  }
  if (specimen_history != nullptr) {
    specimen_history->step_s = out.step_s;
  }
  return out;
}

void add(std::vector<double>& sum, const std::vector<double>& part, double weight) {
  sum.resize(part.size(), 0.0);
  for (std::size_t n = 0; n < part.size(); ++n) {
    sum[n] += weight * part[n];
  }
}

// Where no number of cells fits the output bar, by Lagrange's cubic through the four nearest.
Strains solve(const ShpbWorld& world, const TrueShot& shot, double target_step_s,
              SpecimenHistory* specimen_history) {
  constexpr double kFits_m = 1e-6;
  const KelvinChain chain = material_in(world, shot);
  Mesh mesh = lay_mesh(world, std::sqrt(chain.glassy_Pa / world.base.material.density_kg_m3),
                       target_step_s);
  const double cell_m = world.base.length_m / mesh.input;
  const double cells = world.output_length_m / cell_m;
  if (std::abs(cells - mesh.output) * cell_m < kFits_m) {
    return march(world, shot, mesh, specimen_history);
  }
  const int first = static_cast<int>(std::floor(cells)) - 1;
  Strains out{};
  for (int own = first; own < first + 4; ++own) {
    double weight = 1.0;
    for (int other = first; other < first + 4; ++other) {
      weight *= other == own ? 1.0 : (cells - other) / (own - other);
    }
    mesh.output = own;
    SpecimenHistory history;
    const Strains part = march(world, shot, mesh, specimen_history != nullptr ? &history : nullptr);
    out.step_s = part.step_s;
    out.history.resize(part.history.size());
    for (std::size_t i = 0; i < part.history.size(); ++i) {
      add(out.history[i], part.history[i], weight);
    }
    if (specimen_history != nullptr) {
      specimen_history->step_s = part.step_s;
      add(specimen_history->force_N, history.force_N, weight);
      add(specimen_history->strain, history.strain, weight);
    }
  }
  return out;
}

}  // namespace

double TrueSpecimen::area_m2() const {
  return 0.25 * std::numbers::pi * diameter_m * diameter_m;
}

KelvinChain TrueSpecimen::chain() const {
  KelvinChain made = three_element(E1_Pa, E2_Pa, eta2_Pa_s);
  made.add_relaxation(relaxation_per_Pa, relaxation_time_s);
  return made;
}

bool TrueSpecimen::asks_for_equilibrium() const {
  return nonlinearity != 0.0 || radial_inertia != 0.0 || friction != 0.0 || gap_m != 0.0 ||
         punching != 0.0 || permanent_strain != 0.0 || softening_m3_per_J != 0.0 ||
         face_layer_m_per_N != 0.0;
}

void plant(ShpbWorld& world, const HiddenEffect& effect) {
  static const std::map<std::string, double TrueSpecimen::*> members{
      {"specimen-second-relaxation", &TrueSpecimen::relaxation_per_Pa},
      {"specimen-nonlinearity", &TrueSpecimen::nonlinearity},
      {"specimen-inertia", &TrueSpecimen::inertia},
      {"radial-inertia", &TrueSpecimen::radial_inertia},
      {"interface-friction", &TrueSpecimen::friction},
      {"interface-gap", &TrueSpecimen::gap_m},
      {"punching", &TrueSpecimen::punching},
      {"x-permanent-strain", &TrueSpecimen::permanent_strain},
      {"x-softening", &TrueSpecimen::softening_m3_per_J},
      {"x-face-layer", &TrueSpecimen::face_layer_m_per_N}};
  if (const auto found = members.find(effect.id); found != members.end()) {
    world.specimen.*(found->second) = effect.strength;
    world.specimen.relaxation_time_s = effect.detail("tau", world.specimen.relaxation_time_s);
    world.specimen.dry = effect.detail("dry", world.specimen.dry ? 1.0 : 0.0) > 0.0;
    if (world.specimen.solid && effect.id != "interface-friction" &&
        effect.id != "specimen-second-relaxation") {
      throw InputError("--effect " + effect.id, "is not made of a solid specimen",
                       "it has its mass and its friction; take a lumped one for others");
    }
    if (world.specimen.inertia > 0.0 && world.specimen.asks_for_equilibrium()) {
      throw InputError("--effect " + effect.id, "is not made beside specimen-inertia",
                       "hide one of them");
    }
    return;
  }
  if (effect.id == "specimen-dimensions") {
    (effect.detail("diameter", 0.0) > 0.0 ? world.specimen.diameter_m : world.specimen.length_m) +=
        effect.strength;
    return;
  }
  if (effect.id == "bar-length" && effect.detail("output", 0.0) > 0.0) {
    world.output_length_m += effect.strength;
    return;
  }
  if (effect.id == "geometric-dispersion" || effect.id == "bending" || effect.id == "x-clamp" ||
      effect.id == "x-taper") {
    throw InputError("--effect " + effect.id, "is not made on split bars yet",
                     "take a bar campaign");
  }
  plant(world.base, effect);
}

namespace {

WaveRecords waves_of(const ShpbWorld& world, const ShpbNumerics& numerics,
                     std::vector<SpecimenHistory>* histories) {
  WaveRecords waves;
  for (const TrueShot& shot : world.base.shots) {
    SpecimenHistory history;
    Strains strains =
        solve(world, shot, numerics.step_s, histories != nullptr ? &history : nullptr);
    waves.step_s.push_back(strains.step_s);
    waves.strain.push_back(std::move(strains.history));
    if (histories != nullptr) {
      histories->push_back(std::move(history));
    }
  }
  return waves;
}

Readings read(const ShpbWorld& world, const WaveRecords& waves) {
  const Timing& timing = world.base.timing;
  Readings all;
  for (std::size_t i = 0; i < waves.strain.size(); ++i) {
    const auto seen = sensed(world.base.gauges, waves.strain[i], waves.step_s[i]);
    std::vector<std::vector<double>> records;
    for (std::size_t g = 0; g < seen.size(); ++g) {
      std::vector<double> record(timing.samples);
      for (std::size_t n = 0; n < record.size(); ++n) {
        const double time_s = static_cast<double>(n) * timing.period_s() + timing.lead_s -
                              world.base.gauges[g].delay_s;
        record[n] = sample_at(seen[g], time_s / waves.step_s[i]);
      }
      records.push_back(std::move(record));
    }
    apply_sensors(records, world.base, world.base.shots[i]);
    all.push_back(std::move(records));
  }
  return all;
}

// Everything that the waves depend on.
std::vector<double> key_of(const ShpbWorld& world) {
  const TrueSpecimen& s = world.specimen;
  std::vector<double> key{world.base.length_m,
                          world.base.radius_m,
                          world.base.material.density_kg_m3,
                          world.base.material.poisson_ratio,
                          world.output_length_m,
                          world.base.end_r.value_or(0.0),
                          world.base.timing.window_s(),
                          world.base.timing.knot_s(),
                          s.length_m,
                          s.diameter_m,
                          s.density_kg_m3,
                          s.poisson_ratio,
                          s.E1_Pa,
                          s.E2_Pa,
                          s.eta2_Pa_s,
                          s.relaxation_per_Pa,
                          s.relaxation_time_s,
                          s.nonlinearity,
                          s.inertia,
                          s.radial_inertia,
                          s.friction,
                          s.gap_m,
                          s.dry ? 1.0 : 0.0,
                          s.punching,
                          s.permanent_strain,
                          s.softening_m3_per_J,
                          s.face_layer_m_per_N,
                          s.solid ? 1.0 : 0.0};
  for (const TrueShot& shot : world.base.shots) {
    const KelvinChain chain =
        world.base.material.chain(shot.temperature_K - world.base.reference_K, shot.peak_strain);
    key.push_back(chain.glassy_Pa);
    for (const KelvinElement& element : chain.elements) {
      key.insert(key.end(), {element.stiffness_Pa, element.viscosity_Pa_s});
    }
    key.insert(key.end(), shot.source.begin(), shot.source.end());
  }
  for (const double place : stations_of(world.base.gauges)) {
    key.push_back(place);
  }
  return key;
}

}  // namespace

Readings shpb_readings(const ShpbWorld& world, const ShpbNumerics& numerics,
                       std::vector<SpecimenHistory>* histories) {
  return read(world, waves_of(world, numerics, histories));
}

Readings ShpbForward::readings(const ShpbWorld& world) {
  const std::vector<double> key = key_of(world);
  for (const auto& [known, waves] : known_) {
    if (known == key) {
      return read(world, waves);
    }
  }
  if (known_.size() >= 4) {
    known_.pop_back();
  }
  // The first one, nothing hidden, stays.
  known_.emplace(std::next(known_.begin(), known_.empty() ? 0 : 1), key,
                 waves_of(world, {}, nullptr));
  return read(world, std::next(known_.begin(), known_.size() > 1 ? 1 : 0)->second);
}

}  // namespace kolsky::testing
