#include "processing/identification/bar_model.hpp"

#include <algorithm>
#include <cmath>

namespace kolsky {

namespace {

/// sinh(z) / z.
Complex sinhc(Complex z) {
  return std::abs(z) < 1e-3 ? 1.0 + z * z / 6.0 : std::sinh(z) / z;
}

/// d log sinhc(z) / dz = coth(z) - 1/z.
Complex log_slope_of_sinhc(Complex z) {
  return std::abs(z) < 1e-2 ? z / 3.0 : 1.0 / std::tanh(z) - 1.0 / z;
}

/// d log J / d log p of each parameter of a solid, by central differences: J is smooth in them to
/// all orders, and the error of 1e-10 is below that of J itself in its effect.
std::vector<std::vector<Complex>> log_slopes(SolidKind kind, std::vector<double> parameters,
                                             const std::vector<Complex>& path) {
  constexpr double kStep = 1e-5;
  std::vector<std::vector<Complex>> slopes(parameters.size());
  for (std::size_t m = 0; m < parameters.size(); ++m) {
    const double value = parameters[m];
    parameters[m] = value * std::exp(kStep);
    const auto above = make_solid(kind, parameters);
    parameters[m] = value * std::exp(-kStep);
    const auto below = make_solid(kind, parameters);
    parameters[m] = value;
    for (const Complex s : path) {
      const Complex up = above->at(s);
      const Complex down = below->at(s);
      slopes[m].push_back((up - down) / (up + down) / kStep);
    }
  }
  return slopes;
}

std::vector<double> exponentials(std::span<const double> logs) {
  std::vector<double> values(logs.size());
  std::transform(logs.begin(), logs.end(), values.begin(),
                 [](double log) { return std::exp(log); });
  return values;
}

}  // namespace

std::string name_of(FarEndReturn far_end) {
  switch (far_end) {
    case FarEndReturn::free:
      return "free";
    case FarEndReturn::none:
      return "none";
    case FarEndReturn::partial:
      break;
  }
  return "partial";
}

BarModel::BarModel(const Bench& bench, const BarRecords& records, const BarTheory& theory)
    : bar_(bench.input),
      records_(&records),
      theory_(theory),
      unknowns_(known_unknowns(bench, records)) {
  for (const std::size_t channel : records.channel) {
    const auto& length = bench.gauges[channel].length_m;
    gauge_length_m_.push_back(length ? length->value : 0.0);
  }
}

std::size_t BarModel::first_unknown() const {
  return solid_parameters() + (theory_.far_end == FarEndReturn::partial ? 1 : 0);
}

std::size_t BarModel::parameters() const {
  return first_unknown() + unknowns_.size();
}

std::optional<std::size_t> BarModel::reflection_at() const {
  if (theory_.far_end == FarEndReturn::partial) {
    return solid_parameters();
  }
  return std::nullopt;
}

std::unique_ptr<const Compliance> BarModel::solid(std::span<const double> at) const {
  return make_solid(theory_.solid, exponentials(at.first(solid_parameters())));
}

MovedBench BarModel::moved(std::span<const double> at) const {
  return {bar_, *records_, unknowns_, at.subspan(first_unknown())};
}

double BarModel::reflection(std::span<const double> at) const {
  switch (theory_.far_end) {
    case FarEndReturn::free:
      return -1.0;
    case FarEndReturn::none:
      return 0.0;
    case FarEndReturn::partial:
      break;
  }
  return at[*reflection_at()];
}

/// What the derivatives of one gauge's transfer need.
struct BarModel::Place {
  std::size_t gauge;
  double x0, x, length_m, length0_m, reflection;
  const MovedBench& moved;
  const std::vector<BarMode>& modes;
  const std::vector<std::vector<Complex>>& solid_slopes;
  const std::vector<BarMode>* other_poisson;  ///< modes at Poisson's ratio 0.1 % up
  double bar_length_m;

  struct Slopes {
    Complex by_gamma, by_x, by_x0, by_length, by_reflection;  ///< of log g
  };
  [[nodiscard]] Slopes at(std::size_t k) const {
    const Complex gamma = modes[k].gamma;
    const Complex q = std::exp(-2.0 * gamma * (bar_length_m - x));
    const Complex q0 = std::exp(-2.0 * gamma * (bar_length_m - x0));
    const Complex e = q / (1.0 + reflection * q);
    const Complex e0 = q0 / (1.0 + reflection * q0);
    const Complex re = reflection * e;
    const Complex re0 = reflection * e0;
    Slopes slopes;
    slopes.by_gamma = x0 - x - 2.0 * (bar_length_m - x) * re + 2.0 * (bar_length_m - x0) * re0;
    if (length_m != length0_m) {
      slopes.by_gamma += 0.5 * length_m * log_slope_of_sinhc(0.5 * gamma * length_m) -
                         0.5 * length0_m * log_slope_of_sinhc(0.5 * gamma * length0_m);
    }
    slopes.by_x = gamma * (2.0 * re - 1.0);
    slopes.by_x0 = -gamma * (2.0 * re0 - 1.0);
    slopes.by_length = -2.0 * gamma * (re - re0);
    slopes.by_reflection = e - e0;
    return slopes;
  }
};

void BarModel::differentiate(const Place& place, Transfer& transfer) const {
  using Of = KnownUnknown::Of;
  constexpr double kPoissonStep = 1e-3;
  std::vector<Place::Slopes> slopes;
  slopes.reserve(transfer.g.size());
  for (std::size_t k = 0; k < transfer.g.size(); ++k) {
    slopes.push_back(place.at(k));
  }
  const auto add = [&](std::size_t parameter, const auto& log_slope) {
    Spectrum of_g(transfer.g.size());
    for (std::size_t k = 0; k < of_g.size(); ++k) {
      of_g[k] = transfer.g[k] * log_slope(k);
    }
    transfer.derivatives.push_back({parameter, std::nullopt, std::move(of_g)});
  };
  for (std::size_t m = 0; m < solid_parameters(); ++m) {
    add(m, [&](std::size_t k) {
      return slopes[k].by_gamma * place.modes[k].gamma * place.modes[k].slope *
             place.solid_slopes[m][k];
    });
  }
  if (const auto at = reflection_at()) {
    add(*at, [&](std::size_t k) { return slopes[k].by_reflection; });
  }
  for (std::size_t i = 0; i < unknowns_.size(); ++i) {
    const KnownUnknown& u = unknowns_[i];
    const std::size_t at = first_unknown() + i;
    const bool own = u.gauge == place.gauge;
    switch (u.of) {
      case Of::gain:
        if (own || u.gauge == 0) {
          const double change = u.sd / place.moved.gain[u.gauge];
          transfer.derivatives.push_back({at, own ? change : -change, {}});
        }
        break;
      case Of::position:
        if (own || u.gauge == 0) {
          add(at, [&](std::size_t k) { return u.sd * (own ? slopes[k].by_x : slopes[k].by_x0); });
        }
        break;
      case Of::length:
        add(at, [&](std::size_t k) { return u.sd * slopes[k].by_length; });
        break;
      case Of::density: {
        const double change = u.sd * bar_.density_kg_m3 / place.moved.bar.density_kg_m3;
        add(at, [&](std::size_t k) {
          return change * slopes[k].by_gamma * place.modes[k].gamma * place.modes[k].slope;
        });
        break;
      }
      case Of::diameter: {
        const double change = u.sd * bar_.diameter_m / place.moved.bar.diameter_m;
        add(at, [&](std::size_t k) {
          return change * slopes[k].by_gamma * place.modes[k].gamma *
                 (2.0 * place.modes[k].slope - 1.0);
        });
        break;
      }
      case Of::poisson_ratio: {
        const double change =
            u.sd * bar_.poisson_ratio / (kPoissonStep * place.moved.bar.poisson_ratio);
        add(at, [&](std::size_t k) {
          return change * slopes[k].by_gamma *
                 ((*place.other_poisson)[k].gamma - place.modes[k].gamma);
        });
        break;
      }
    }
  }
}

std::vector<BarModel::Transfer> BarModel::transfers_with(std::span<const double> at, double R,
                                                         const std::vector<Complex>& path,
                                                         bool with_derivatives) const {
  const auto compliance = solid(at);
  const MovedBench moved_bench = moved(at);
  const std::vector<BarMode> modes = bar_modes(theory_.waves, moved_bench.bar, *compliance, path);
  std::vector<std::vector<Complex>> solid_slopes;
  std::vector<BarMode> other_poisson;
  if (with_derivatives) {
    solid_slopes = log_slopes(theory_.solid, exponentials(at.first(solid_parameters())), path);
    const bool varies = std::any_of(unknowns_.begin(), unknowns_.end(), [](const auto& u) {
      return u.of == KnownUnknown::Of::poisson_ratio;
    });
    if (varies) {
      Bar other = moved_bench.bar;
      other.poisson_ratio.value *= 1.001;
      other_poisson = bar_modes(theory_.waves, other, *compliance, path);
    }
  }
  const double length_m = moved_bench.bar.length_m;
  const double x0 = moved_bench.position_m[0];
  std::vector<Transfer> list(records_->position_m.size() - 1);
  for (std::size_t j = 1; j <= list.size(); ++j) {
    Transfer& transfer = list[j - 1];
    const double x = moved_bench.position_m[j];
    const double gain = moved_bench.gain[j] / moved_bench.gain[0];
    const bool blurred = gauge_length_m_[j] != gauge_length_m_[0];
    for (const BarMode& mode : modes) {
      const Complex gamma = mode.gamma;
      Complex g = gain * std::exp(-gamma * (x - x0));
      if (R != 0.0) {
        g *= (1.0 + R * std::exp(-2.0 * gamma * (length_m - x))) /
             (1.0 + R * std::exp(-2.0 * gamma * (length_m - x0)));
      }
      if (blurred) {
        g *= sinhc(0.5 * gamma * gauge_length_m_[j]) / sinhc(0.5 * gamma * gauge_length_m_[0]);
      }
      transfer.g.push_back(g);
    }
    if (with_derivatives) {
      differentiate({j, x0, x, gauge_length_m_[j], gauge_length_m_[0], R, moved_bench, modes,
                     solid_slopes, &other_poisson, length_m},
                    transfer);
    }
  }
  return list;
}

std::vector<BarModel::Transfer> BarModel::transfers(std::span<const double> at,
                                                    const std::vector<Complex>& path,
                                                    bool with_derivatives) const {
  return transfers_with(at, reflection(at), path, with_derivatives);
}

std::vector<BarModel::Transfer> BarModel::first_passages(std::span<const double> at,
                                                         const std::vector<Complex>& path,
                                                         bool with_derivatives) const {
  return transfers_with(at, 0.0, path, with_derivatives);
}

std::vector<BarModel::Spectrum> BarModel::returns(std::span<const double> at,
                                                  const std::vector<Complex>& path) const {
  const MovedBench moved_bench = moved(at);
  const auto compliance = solid(at);
  const auto modes = bar_modes(theory_.waves, moved_bench.bar, *compliance, path);
  std::vector<Spectrum> list;
  for (const double x : moved_bench.position_m) {
    Spectrum& q = list.emplace_back();
    for (const BarMode& mode : modes) {
      q.push_back(std::exp(-2.0 * mode.gamma * (moved_bench.bar.length_m - x)));
    }
  }
  return list;
}

}  // namespace kolsky
