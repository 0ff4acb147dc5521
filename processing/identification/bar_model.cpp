#include "processing/identification/bar_model.hpp"

#include <algorithm>
#include <cmath>

#include "processing/base/error.hpp"

namespace kolsky {

namespace {

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
  if (records.returned && theory.far_end == FarEndReturn::none) {
    throw InputError("far end", "is to return nothing, which one gauge cannot do without",
                     "put a second gauge on the bar");
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
  return records_->returned ? 0.0 : returned_by_end(at);
}

double BarModel::returned_by_end(std::span<const double> at) const {
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

bool BarModel::varies(KnownUnknown::Of number) const {
  return std::any_of(unknowns_.begin(), unknowns_.end(),
                     [&](const KnownUnknown& unknown) { return unknown.of == number; });
}

/// d log g_j by a known unknown in its standard deviations: a number where it is the same at all
/// frequencies, nothing where it does not move this gauge.
std::optional<BarModel::LogSlope> BarModel::slope_by(const KnownUnknown& unknown, std::size_t gauge,
                                                     const MovedBench& bench,
                                                     const RatioSlopes& ratio,
                                                     const GammaSlopes& gamma) const {
  using Of = KnownUnknown::Of;
  const bool own = unknown.gauge == gauge;
  const bool concerns = own || unknown.gauge == 0;
  const auto relative = [&](const Measured& filed, const Measured& now) {
    return unknown.sd * filed / now;
  };
  switch (unknown.of) {
    case Of::gain:
      if (concerns) {
        return LogSlope{(own ? 1.0 : -1.0) * unknown.sd / bench.gain[unknown.gauge], nullptr,
                        nullptr};
      }
      return std::nullopt;
    case Of::position:
      if (concerns) {
        return LogSlope{unknown.sd, own ? &ratio.by_x : &ratio.by_x0, nullptr};
      }
      return std::nullopt;
    case Of::delay:
      if (concerns) {
        return LogSlope{(own ? 1.0 : -1.0) * unknown.sd, &ratio.by_delay, nullptr};
      }
      return std::nullopt;
    case Of::length:
      return LogSlope{unknown.sd, &ratio.by_length, nullptr};
    case Of::density:
      return LogSlope{relative(bar_.density_kg_m3, bench.bar.density_kg_m3), &ratio.by_gamma,
                      &gamma.by_density};
    case Of::diameter:
      return LogSlope{relative(bar_.diameter_m, bench.bar.diameter_m), &ratio.by_gamma,
                      &gamma.by_diameter};
    case Of::poisson_ratio:
      break;
  }
  return LogSlope{relative(bar_.poisson_ratio, bench.bar.poisson_ratio), &ratio.by_gamma,
                  &gamma.by_poisson};
}

std::vector<BarModel::Derivative> BarModel::derivatives_of(std::span<const double> at,
                                                           std::size_t gauge,
                                                           const Transfers& transfers,
                                                           const GammaSlopes& gamma,
                                                           const std::vector<Complex>& path) const {
  const RatioSlopes ratio(transfers.waves, transfers.bench, gauge, path);
  const Spectrum& g = transfers.g[gauge - 1];
  std::vector<Derivative> list;
  const auto add = [&](std::size_t parameter, const LogSlope& slope) {
    if (slope.ratio == nullptr) {
      list.push_back({parameter, slope.factor, {}});
      return;
    }
    Spectrum of_g(g.size());
    for (std::size_t k = 0; k < of_g.size(); ++k) {
      of_g[k] = slope.factor * g[k] * (*slope.ratio)[k];
    }
    for (std::size_t k = 0; slope.gamma != nullptr && k < of_g.size(); ++k) {
      of_g[k] *= (*slope.gamma)[k];
    }
    list.push_back({parameter, std::nullopt, std::move(of_g)});
  };
  for (std::size_t m = 0; m < solid_parameters(); ++m) {
    add(m, {1.0, &ratio.by_gamma, &gamma.by_solid[m]});
  }
  if (const auto place = reflection_at()) {
    if (records_->returned) {
      add(*place, {1.0 / at[*place], nullptr, nullptr});
    } else {
      add(*place, {1.0, &ratio.by_reflection, nullptr});
    }
  }
  for (std::size_t i = 0; i < unknowns_.size(); ++i) {
    if (const auto slope = slope_by(unknowns_[i], gauge, transfers.bench, ratio, gamma)) {
      add(first_unknown() + i, *slope);
    }
  }
  return list;
}

void BarModel::make_returned(std::span<const double> at, const std::vector<Complex>& path,
                             Spectrum& g) const {
  for (std::size_t k = 0; k < g.size(); ++k) {
    g[k] *= -returned_by_end(at) * std::exp(records_->late_s * path[k]);
  }
}

BarModel::Transfers BarModel::transfers_with(std::span<const double> at, double R,
                                             const std::vector<Complex>& path,
                                             bool to_differentiate) const {
  const bool with_echo = R != 0.0 || (to_differentiate && reflection_at() && !records_->returned);
  const MovedBench bench = moved(at);
  Transfers transfers{
      {}, bench, BarWaves(theory_.waves, bench, *solid(at), R, with_echo, gauge_length_m_, path)};
  for (std::size_t j = 1; j < records_->position_m.size(); ++j) {
    Spectrum& of_gauge = transfers.g.emplace_back(transfers.waves.ratio(bench, j));
    for (Complex& g : of_gauge) {
      g *= bench.gain[j] / bench.gain[0];
    }
    const double late_s = bench.delay_s[j] - bench.delay_s[0];
    for (std::size_t k = 0; late_s != 0.0 && k < of_gauge.size(); ++k) {
      of_gauge[k] *= std::exp(-path[k] * late_s);
    }
    if (records_->returned) {
      make_returned(at, path, of_gauge);
    }
  }
  return transfers;
}

BarModel::Transfers BarModel::transfers(std::span<const double> at,
                                        const std::vector<Complex>& path,
                                        bool to_differentiate) const {
  return transfers_with(at, reflection(at), path, to_differentiate);
}

BarModel::Transfers BarModel::first_passages(std::span<const double> at,
                                             const std::vector<Complex>& path,
                                             bool to_differentiate) const {
  return transfers_with(at, 0.0, path, to_differentiate);
}

std::vector<std::vector<BarModel::Derivative>> BarModel::derivatives(
    std::span<const double> at, const std::vector<Complex>& path,
    const Transfers& transfers) const {
  const GammaSlopes gamma(theory_.waves, transfers.bench.bar, theory_.solid,
                          exponentials(at.first(solid_parameters())), transfers.waves,
                          varies(KnownUnknown::Of::poisson_ratio), path);
  std::vector<std::vector<Derivative>> list;
  for (std::size_t j = 1; j <= transfers.g.size(); ++j) {
    list.push_back(derivatives_of(at, j, transfers, gamma, path));
  }
  return list;
}

std::vector<BarModel::Spectrum> BarModel::returns(std::span<const double> at,
                                                  const std::vector<Complex>& path) const {
  return BarWaves(theory_.waves, moved(at), *solid(at), 0.0, true, gauge_length_m_, path).echo;
}

}  // namespace kolsky
