#include "processing/specimen/shpb_unknowns.hpp"

#include <Eigen/Core>
#include <cmath>
#include <optional>

namespace kolsky {

namespace {

using Of = ShpbUnknown::Of;

void add(std::vector<ShpbUnknown>& list, std::string name, Of of, std::size_t index, double sd) {
  if (sd > 0.0) {
    list.push_back({std::move(name), of, index, sd});
  }
}

void add_bar(std::vector<ShpbUnknown>& list, const Bar& bar, std::size_t index) {
  const std::string name = index == 0 ? ":input" : ":output";
  add(list, "bar-length" + name, Of::bar_length, index, bar.length_m.sd);
  add(list, "density" + name, Of::bar_density, index, relative_sd(bar.density_kg_m3));
  add(list, "bar-diameter" + name, Of::bar_diameter, index, relative_sd(bar.diameter_m));
  add(list, "poisson-ratio" + name, Of::bar_poisson, index, relative_sd(bar.poisson_ratio));
  if (bar.youngs_modulus_Pa) {
    add(list, "youngs-modulus" + name, Of::bar_modulus, index, relative_sd(*bar.youngs_modulus_Pa));
  }
}

void add_directions(std::vector<ShpbUnknown>& list, const std::string& name, Of of,
                    const Eigen::MatrixXd& directions) {
  for (Eigen::Index i = 0; i < directions.cols(); ++i) {
    const bool moves = directions.col(i).norm() > 0.0;
    add(list, name + std::to_string(i + 1), of, static_cast<std::size_t>(i), moves ? 1.0 : 0.0);
  }
}

void scale(Measured& number, double move) {
  number.value *= 1.0 + move;
}

/// How an output bar's own material moves.
struct OwnMoves {
  Eigen::MatrixXd directions;
  bool go_with_density;
  Eigen::VectorXd with_density;
  Eigen::VectorXd with_temperature;
  Eigen::VectorXd relative;

  explicit OwnMoves(const Bar& bar)
      : directions(own_moduli_directions(bar)),
        go_with_density(own_moduli_go_with_density(bar)),
        with_density(moves_with_density(*bar.material)),
        with_temperature(moves_with_temperature(*bar.material)),
        relative(Eigen::VectorXd::Zero(directions.rows())) {}
};

}  // namespace

std::vector<ShpbUnknown> shpb_unknowns(const Bench& bench, const std::vector<ShpbStation>& stations,
                                       const BarPrior& bars) {
  std::vector<ShpbUnknown> list;
  for (std::size_t j = 0; j < stations.size(); ++j) {
    const auto& channels = stations[j].channels;
    double gains = 0.0;
    double positions = 0.0;
    double delays = 0.0;
    for (const std::size_t channel : channels) {
      gains += std::pow(gain_sd(bench.gauges[channel]), 2);
      positions += std::pow(bench.gauges[channel].position_m.sd, 2);
      delays += std::pow(bench.gauges[channel].delay_s.sd, 2);
    }
    const auto count = static_cast<double>(channels.size());
    const std::string& name = bench.gauges[channels.front()].name;
    add(list, "gauge-factor:" + name, Of::gain, j, std::sqrt(gains) / count);
    add(list, "gauge-position:" + name, Of::position, j, std::sqrt(positions) / count);
    add(list, "channel-delay:" + name, Of::delay, j, std::sqrt(delays) / count);
  }
  add_bar(list, bench.input, 0);
  add_bar(list, *bench.output, 1);
  if (takes_bar_model(bench)) {
    add_directions(list, "bar-model:", Of::bar_material, moduli_directions(bench, bars));
  }
  if (bench.output->material) {
    add_directions(list, "output-bar-model:", Of::own_material,
                   own_moduli_directions(*bench.output));
  }
  add(list, "temperature", Of::temperature, 0, sd_by_temperature(bench, bars));
  const Specimen& specimen = *bench.specimen;
  add(list, "specimen-length", Of::specimen_length, 0, relative_sd(specimen.length_m));
  add(list, "specimen-diameter", Of::specimen_diameter, 0, relative_sd(specimen.diameter_m));
  if (specimen.density_kg_m3) {
    add(list, "specimen-density", Of::specimen_density, 0, relative_sd(*specimen.density_kg_m3));
  }
  return list;
}

MovedShpb::MovedShpb(const Bench& filed, const std::vector<ShpbStation>& stations,
                     const BarPrior& prior, const std::vector<ShpbUnknown>& unknowns,
                     std::span<const double> moves)
    : bars{filed.input, *filed.output},
      material(prior.material),
      specimen(*filed.specimen),
      gain(stations.size(), 1.0),
      delay_s(stations.size(), 0.0) {
  std::vector<double> shift_m(stations.size(), 0.0);
  const Eigen::MatrixXd root = moduli_directions(filed, prior);
  const Eigen::VectorXd with_density = moves_with_density(material);
  const Eigen::VectorXd with_temperature = moves_with_temperature(material);
  Eigen::VectorXd relative = Eigen::VectorXd::Zero(root.cols());
  std::optional<OwnMoves> own;
  if (filed.output->material) {
    own.emplace(*filed.output);
  }
  const auto moduli_with = bar_of_density(filed, prior);
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    const ShpbUnknown& u = unknowns[i];
    const double move = moves[i] * u.sd;
    switch (u.of) {
      case Of::gain:
        gain[u.index] *= 1.0 + move;
        break;
      case Of::position:
        shift_m[u.index] += move;
        break;
      case Of::delay:
        delay_s[u.index] += move;
        break;
      case Of::bar_length:
        bars[u.index].length_m.value += move;
        break;
      case Of::bar_density:
        scale(bars[u.index].density_kg_m3, move);
        relative += (u.index == moduli_with ? move : 0.0) * with_density;
        if (own && u.index == 1 && own->go_with_density) {
          own->relative += move * own->with_density;
        }
        break;
      case Of::bar_diameter:
        scale(bars[u.index].diameter_m, move);
        if (bars[u.index].side_m) {
          scale(*bars[u.index].side_m, move);
        }
        break;
      case Of::bar_poisson:
        scale(bars[u.index].poisson_ratio, move);
        break;
      case Of::bar_modulus:
        scale(*bars[u.index].youngs_modulus_Pa, move);
        break;
      case Of::bar_material:
        relative += root.col(static_cast<Eigen::Index>(u.index)) * move;
        break;
      case Of::own_material:
        own->relative += own->directions.col(static_cast<Eigen::Index>(u.index)) * move;
        break;
      case Of::temperature:
        relative -= move * with_temperature;
        if (own) {
          own->relative -= move * own->with_temperature;
        }
        break;
      case Of::specimen_length:
        scale(specimen.length_m, move);
        break;
      case Of::specimen_diameter:
        scale(specimen.diameter_m, move);
        break;
      case Of::specimen_density:
        scale(*specimen.density_kg_m3, move);
        break;
    }
  }
  move_parameters(material, relative);
  if (own) {
    move_parameters(*bars[1].material, own->relative);
  }
  for (std::size_t j = 0; j < stations.size(); ++j) {
    // Positions on the input bar count from the impacted end: the specimen is at its length.
    const double filed_m = stations[j].to_specimen_m;
    to_specimen_m.push_back(stations[j].on_input
                                ? filed_m - shift_m[j] + bars[0].length_m - filed.input.length_m
                                : filed_m + shift_m[j]);
  }
}

}  // namespace kolsky
