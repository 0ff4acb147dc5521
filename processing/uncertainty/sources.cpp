#include "processing/uncertainty/sources.hpp"

#include <algorithm>
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
                       [place = std::move(place)](ShotNumbers& moved, double deviations) {
                         Measured& at = place(moved.bench);
                         at.value += deviations * at.sd;
                       }});
  }
}

void add_gauge(Sources& sources, const Bench& bench, std::size_t i) {
  const Gauge& gauge = bench.gauges[i];
  const std::string name = "gauges." + gauge.name + ".";
  add(sources, bench, name + "position_m", "gauge positions",
      [i](Bench& b) -> Measured& { return b.gauges[i].position_m; });
  add(sources, bench, name + "delay_s", "channel delays",
      [i](Bench& b) -> Measured& { return b.gauges[i].delay_s; });
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

void add_density(Sources& sources, const Bench& bench, const BarPrior& bars, bool input) {
  const auto bar = [input](Bench& b) -> Bar& { return input ? b.input : *b.output; };
  const Measured density = (input ? bench.input : *bench.output).density_kg_m3;
  const bool with_moduli = bar_of_density(bench, bars) == std::size_t{input ? 0U : 1U};
  const bool with_own =
      !input && bench.output->material && own_moduli_go_with_density(*bench.output);
  if (density.sd > 0.0) {
    sources.push_back({std::string("bars.") + (input ? "input" : "output") + ".density_kg_m3",
                       "bar densities", density.value, density.sd,
                       [bar, with_moduli, with_own](ShotNumbers& moved, double deviations) {
                         Measured& at = bar(moved.bench).density_kg_m3;
                         const double move = deviations * relative_sd(at);
                         at.value *= 1.0 + move;
                         if (with_moduli) {
                           move_parameters(moved.bars, move * moves_with_density(moved.bars));
                         }
                         if (with_own) {
                           Material& own = *bar(moved.bench).material;
                           move_parameters(own, move * moves_with_density(own));
                         }
                       }});
  }
}

void add_bar(Sources& sources, const Bench& bench, const BarPrior& bars, bool input) {
  const auto bar = [input](Bench& b) -> Bar& { return input ? b.input : *b.output; };
  const std::string name = input ? "bars.input." : "bars.output.";
  add(sources, bench, name + "length_m", "bar lengths",
      [bar](Bench& b) -> Measured& { return bar(b).length_m; });
  const Measured diameter = (input ? bench.input : *bench.output).diameter_m;
  if (diameter.sd > 0.0) {
    sources.push_back({name + "diameter_m", "bar diameters", diameter.value, diameter.sd,
                       [bar](ShotNumbers& numbers, double deviations) {
                         Bar& moved = bar(numbers.bench);
                         const double factor =
                             1.0 + deviations * moved.diameter_m.sd / moved.diameter_m.value;
                         moved.diameter_m.value *= factor;
                         if (moved.side_m) {
                           moved.side_m->value *= factor;
                         }
                       }});
  }
  add(sources, bench, name + "poisson_ratio", "Poisson's ratios",
      [bar](Bench& b) -> Measured& { return bar(b).poisson_ratio; });
  if ((input ? bench.input : *bench.output).youngs_modulus_Pa) {
    add(sources, bench, name + "youngs_modulus_Pa", "bar moduli",
        [bar](Bench& b) -> Measured& { return *bar(b).youngs_modulus_Pa; });
  }
  add_density(sources, bench, bars, input);
}

/// One source for each independent direction of a material's parameters.
void add_directions(Sources& sources, const std::string& name, const Eigen::MatrixXd& directions,
                    const std::function<Material&(ShotNumbers&)>& material) {
  for (Eigen::Index i = directions.cols() - 1; i >= 0; --i) {
    const Eigen::VectorXd along = directions.col(i);
    if (along.norm() > 0.0) {
      sources.push_back({name + ", direction " + std::to_string(directions.cols() - i),
                         "bar moduli", 0.0, along.norm(),
                         [along, material](ShotNumbers& moved, double deviations) {
                           move_parameters(material(moved), deviations * along);
                         }});
    }
  }
}

/// Of viscoelastic bars.
void add_moduli(Sources& sources, const Bench& bench, const BarPrior& bars) {
  if (takes_bar_model(bench)) {
    add_directions(sources, "bar model", moduli_directions(bench, bars),
                   [](ShotNumbers& numbers) -> Material& { return numbers.bars; });
  }
  if (bench.output && bench.output->material) {
    add_directions(
        sources, "output bar's material", own_moduli_directions(*bench.output),
        [](ShotNumbers& numbers) -> Material& { return *numbers.bench.output->material; });
  }
  if (const double change = sd_by_temperature(bench, bars); change > 0.0) {
    sources.push_back({"temperature_K", "temperature", bench.temperature_K->value,
                       bench.temperature_K->sd, [change](ShotNumbers& moved, double deviations) {
                         const auto soften = [&](Material& material) {
                           move_parameters(material,
                                           -deviations * change * moves_with_temperature(material));
                         };
                         soften(moved.bars);
                         if (moved.bench.output && moved.bench.output->material) {
                           soften(*moved.bench.output->material);
                         }
                       }});
  }
}

void add_specimen(Sources& sources, const Bench& bench) {
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
}

}  // namespace

Sources uncertainty_sources(const Bench& bench, const BarPrior& bars) {
  Sources sources;
  for (std::size_t i = 0; i < bench.gauges.size(); ++i) {
    add_gauge(sources, bench, i);
  }
  add_bar(sources, bench, bars, true);
  if (bench.output) {
    add_bar(sources, bench, bars, false);
  }
  if (bench.kind != BenchKind::bar) {
    add_moduli(sources, bench, bars);
  }
  if (bench.specimen) {
    add_specimen(sources, bench);
  }
  return sources;
}

UncertaintySource hidden_push_source(double left_share) {
  return {kHiddenPush, "rest of the push", 0.0, left_share,
          [](ShotNumbers& moved, double deviations) { moved.push_goes_on = deviations; }};
}

UncertaintySource band_limit_source(double limit_Hz, double widest_Hz) {
  return {"band_limit_Hz", "band limit", limit_Hz, widest_Hz - limit_Hz,
          [limit_Hz, widest_Hz](ShotNumbers& moved, double deviations) {
            moved.band_limit_Hz =
                limit_Hz + std::clamp(deviations, 0.0, 1.0) * (widest_Hz - limit_Hz);
          }};
}

}  // namespace kolsky
