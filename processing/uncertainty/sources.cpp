#include "processing/uncertainty/sources.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <utility>

namespace kolsky {

namespace {

using Sources = std::vector<UncertaintySource>;
/// Where a number sits in a bench.
using Place = std::function<Measured&(Bench&)>;

void add(Sources& sources, const Bench& bench, std::string name, std::string group, Place place) {
  Bench copy = bench;
  const Measured number = place(copy);
  if (number.sd > 0.0) {
    sources.push_back({std::move(name), std::move(group), number.value, number.sd,
                       [place = std::move(place)](Bench& moved, Material&, double deviations) {
                         Measured& at = place(moved);
                         at.value += deviations * at.sd;
                       }});
  }
}

void add_gauge(Sources& sources, const Bench& bench, std::size_t i) {
  const Gauge& gauge = bench.gauges[i];
  const std::string name = "gauges." + gauge.name + ".";
  add(sources, bench, name + "position_m", "gauge positions",
      [i](Bench& b) -> Measured& { return b.gauges[i].position_m; });
  if (gauge.strain_per_V) {
    add(sources, bench, name + "strain_per_V", "gauge factors",
        [i](Bench& b) -> Measured& { return *b.gauges[i].strain_per_V; });
  }
  if (!gauge.strain_per_V && !gauge.bridge) {
    add(sources, bench, name + "strain", "gauge factors",
        [i](Bench& b) -> Measured& { return b.gauges[i].strain_gain; });
  }
  if (gauge.bridge) {
    add(sources, bench, name + "gauge_factor", "gauge factors",
        [i](Bench& b) -> Measured& { return b.gauges[i].bridge->gauge_factor; });
    add(sources, bench, name + "gauge_factor_per_strain", "gauge factors",
        [i](Bench& b) -> Measured& { return b.gauges[i].bridge->gauge_factor_per_strain; });
    add(sources, bench, name + "excitation_V", "gauge factors",
        [i](Bench& b) -> Measured& { return b.gauges[i].bridge->excitation_V; });
    add(sources, bench, name + "gain", "gauge factors",
        [i](Bench& b) -> Measured& { return b.gauges[i].bridge->gain; });
    add(sources, bench, name + "shunt", "gauge factors",
        [i](Bench& b) -> Measured& { return b.gauges[i].bridge->shunt_gain; });
  }
}

void add_bar(Sources& sources, const Bench& bench, bool input) {
  const auto bar = [input](Bench& b) -> Bar& { return input ? b.input : *b.output; };
  const std::string name = input ? "bars.input." : "bars.output.";
  add(sources, bench, name + "length_m", "bar lengths",
      [bar](Bench& b) -> Measured& { return bar(b).length_m; });
  const Measured diameter = (input ? bench.input : *bench.output).diameter_m;
  if (diameter.sd > 0.0) {
    sources.push_back({name + "diameter_m", "bar diameters", diameter.value, diameter.sd,
                       [bar](Bench& b, Material&, double deviations) {
                         Bar& moved = bar(b);
                         const double factor =
                             1.0 + deviations * moved.diameter_m.sd / moved.diameter_m.value;
                         moved.diameter_m.value *= factor;
                         if (moved.side_m) {
                           moved.side_m->value *= factor;
                         }
                       }});
  }
  add(sources, bench, name + "density_kg_m3", "bar densities",
      [bar](Bench& b) -> Measured& { return bar(b).density_kg_m3; });
  add(sources, bench, name + "poisson_ratio", "Poisson's ratios",
      [bar](Bench& b) -> Measured& { return bar(b).poisson_ratio; });
  if ((input ? bench.input : *bench.output).youngs_modulus_Pa) {
    add(sources, bench, name + "youngs_modulus_Pa", "bar moduli",
        [bar](Bench& b) -> Measured& { return *bar(b).youngs_modulus_Pa; });
  }
}

/// The moduli's covariance as three independent directions, relative.
void add_bar_model(Sources& sources, const Material& bars, const BarModelUncertainty& model) {
  const std::array<double, 3> scale = {bars.E1_Pa, bars.E2_Pa, bars.eta2_Pa_s};
  Eigen::Matrix3d covariance;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const auto a = static_cast<std::size_t>(i);
      const auto b = static_cast<std::size_t>(j);
      covariance(i, j) = model.covariance[a][b] / (scale[a] * scale[b]);
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  for (int i = 2; i >= 0; --i) {
    const double sd = std::sqrt(std::max(0.0, solver.eigenvalues()[i]));
    if (sd <= 0.0) {
      continue;
    }
    const Eigen::Vector3d along = solver.eigenvectors().col(i) * sd;
    sources.push_back({"bar model, direction " + std::to_string(3 - i), "bar moduli", 0.0, sd,
                       [along](Bench&, Material& m, double deviations) {
                         m.E1_Pa.value *= 1.0 + deviations * along[0];
                         m.E2_Pa.value *= 1.0 + deviations * along[1];
                         m.eta2_Pa_s.value *= 1.0 + deviations * along[2];
                       }});
  }
}

}  // namespace

Sources uncertainty_sources(const Bench& bench, const Material& bars,
                            const BarModelUncertainty& model) {
  Sources sources;
  for (std::size_t i = 0; i < bench.gauges.size(); ++i) {
    add_gauge(sources, bench, i);
  }
  add_bar(sources, bench, true);
  add_bar(sources, bench, false);
  const bool viscoelastic = !bench.input.youngs_modulus_Pa || !bench.output->youngs_modulus_Pa;
  if (viscoelastic) {
    add_bar_model(sources, bars, model);
  }
  if (viscoelastic && bench.temperature_K && bench.temperature_K->sd > 0.0) {
    const double change = model.softening_per_K * bench.temperature_K->sd;
    sources.push_back({"temperature_K", "temperature", bench.temperature_K->value,
                       bench.temperature_K->sd, [change](Bench&, Material& m, double deviations) {
                         m.E1_Pa.value *= 1.0 - deviations * change;
                         m.E2_Pa.value *= 1.0 - deviations * change;
                       }});
  }
  add(sources, bench, "specimen.length_m", "specimen length",
      [](Bench& b) -> Measured& { return b.specimen->length_m; });
  add(sources, bench, "specimen.diameter_m", "specimen diameter",
      [](Bench& b) -> Measured& { return b.specimen->diameter_m; });
  // Of corrections for inertia, where these are asked for.
  if (bench.specimen->density_kg_m3) {
    add(sources, bench, "specimen.density_kg_m3", "specimen inertia",
        [](Bench& b) -> Measured& { return *b.specimen->density_kg_m3; });
  }
  if (bench.specimen->poisson_ratio) {
    add(sources, bench, "specimen.poisson_ratio", "specimen inertia",
        [](Bench& b) -> Measured& { return *b.specimen->poisson_ratio; });
  }
  return sources;
}

}  // namespace kolsky
