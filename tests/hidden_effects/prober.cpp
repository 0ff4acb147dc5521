#include "tests/hidden_effects/prober.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace kolsky::scoring {

namespace {

using testing::Campaign;
using testing::EffectKind;
using testing::HiddenEffect;
using testing::Readings;

constexpr double kModulusStep = 5e-4;

Whitening whitening_of(const Campaign& campaign) {
  const double step =
      campaign.bits > 0 ? std::ldexp(campaign.full_scale_strain, 1 - campaign.bits) : 0.0;
  const double rms = campaign.wishes.noise_strain;
  const double quantised = step / std::sqrt(12.0);
  if (campaign.wishes.colour == testing::NoiseColour::white) {
    return Whitening(std::hypot(rms, quantised));
  }
  std::mt19937_64 random(17);
  std::vector<std::vector<double>> samples;
  std::normal_distribution<double> rounding(0.0, quantised);
  for (int i = 0; i < 64; ++i) {
    samples.push_back(testing::noise(campaign.wishes.colour, rms, campaign.world.timing.period_s(),
                                     4096, random, campaign.wishes.measured_noise));
    for (double& value : samples.back()) {
      value += rounding(random);
    }
  }
  return Whitening(samples, 48);
}

Readings difference(const Readings& changed, const Readings& base, double step,
                    const Whitening& whiten) {
  Readings out = changed;
  for (std::size_t i = 0; i < out.size(); ++i) {
    for (std::size_t g = 0; g < out[i].size(); ++g) {
      for (std::size_t n = 0; n < out[i][g].size(); ++n) {
        out[i][g][n] = (out[i][g][n] - base[i][g][n]) / step;
      }
      out[i][g] = whiten(out[i][g]);
    }
  }
  return out;
}

std::function<void(Campaign&, double)> hidden_at(const std::string& id, const std::string& gauge) {
  return [id, gauge](Campaign& campaign, double strength) {
    testing::hide(campaign, {id, gauge, strength, {}});
  };
}

}  // namespace

bool is_there_or_not(const std::string& id) {
  return id == "geometric-dispersion" || id == "end-reflection" || id == "specimen-inertia";
}

Prober::Prober(const Campaign& campaign)
    : campaign_(campaign), whiten_(whitening_of(campaign)), base_(forward_.readings(campaign)) {}

std::vector<Direction> Prober::nuisances() {
  std::vector<Direction> out;
  if (campaign_.split) {
    add_specimen(out);
  }
  const bool held = campaign_.split.has_value();
  const auto filed = [&](const Measured& number) { return number.sd / number.value; };
  const auto& bars = campaign_.filed_bars;
  if (campaign_.world.material.elastic) {
    add_modulus(out, &testing::TrueMaterial::E1_Pa, true,
                filed(*campaign_.bench.input.youngs_modulus_Pa));
  } else {
    add_modulus(out, &testing::TrueMaterial::E1_Pa, held, bars ? filed(bars->E1_Pa()) : 0.0);
    add_modulus(out, &testing::TrueMaterial::E2_Pa, held, bars ? filed(bars->E2_Pa()) : 0.0);
    add_modulus(out, &testing::TrueMaterial::eta2_Pa_s, held,
                bars ? filed(bars->eta2_Pa_s()) : 0.0);
  }
  add_gauges(out);
  return out;
}

Readings Prober::unit_change(const Candidate& candidate) {
  const double step = candidate.effect.strength - candidate.null;
  const auto at = [&](double share) {
    Campaign changed_one = campaign_;
    HiddenEffect effect = candidate.effect;
    effect.strength = candidate.null + share * step;
    testing::hide(changed_one, effect);
    return changed_one;
  };
  return unit_change(at, step, differences_of(candidate.kind));
}

Readings Prober::unit_change_everywhere(const Candidate& candidate) {
  const double step = candidate.effect.strength;
  const auto at = [&](double share) {
    Campaign changed_one = campaign_;
    for (const testing::TrueGauge& gauge : campaign_.world.gauges) {
      testing::hide(changed_one, {candidate.effect.id, gauge.name, share * step, {}});
    }
    return changed_one;
  };
  return unit_change(at, step, differences_of(candidate.kind));
}

Readings Prober::whole_change(const Campaign& changed, const Campaign& from) {
  return difference(forward_.readings(changed), forward_.readings(from), 1.0, whiten_);
}

SourceFreedom Prober::freedom() {
  const testing::Timing& timing = campaign_.world.timing;
  std::vector<std::vector<double>> bells;
  const auto first = -static_cast<std::ptrdiff_t>(std::floor(timing.lead_s / timing.period_s()));
  const std::size_t length = timing.samples + static_cast<std::size_t>(-first);
  double largest = 0.0;
  for (const std::vector<double>& bell : forward_.bell_records(campaign_, length)) {
    for (const double value : bell) {
      largest = std::max(largest, std::abs(value));
    }
    bells.push_back(whiten_(bell));
  }
  return {std::move(bells),        whiten_(std::vector<double>(timing.samples, 1.0)),
          timing.samples,          first,
          timing.periods_per_knot, 3e-3 / largest};
}

Prober::Differences Prober::differences_of(const EffectKind& kind) {
  // Bending adds what is proportional to it: no difference is more exact than another.
  if (is_there_or_not(kind.id) || kind.id == "gauge-length" || kind.id == "bending") {
    return Differences::whole;
  }
  return kind.one_sided ? Differences::one_sided : Differences::central;
}

Readings Prober::unit_change(const std::function<Campaign(double)>& at, double step,
                             Differences differences) {
  if (differences == Differences::central) {
    return difference(forward_.readings(at(1.0)), forward_.readings(at(-1.0)), 2.0 * step, whiten_);
  }
  Readings out = difference(forward_.readings(at(1.0)), base_, step, whiten_);
  if (differences == Differences::one_sided) {
    const Readings half = difference(forward_.readings(at(0.5)), base_, 0.5 * step, whiten_);
    for (std::size_t i = 0; i < out.size(); ++i) {
      for (std::size_t g = 0; g < out[i].size(); ++g) {
        for (std::size_t n = 0; n < out[i][g].size(); ++n) {
          out[i][g][n] = 2.0 * half[i][g][n] - out[i][g][n];
        }
      }
    }
  }
  return out;
}

std::function<Campaign(double)> Prober::along(std::function<void(Campaign&, double)> move) const {
  return [this, move = std::move(move)](double share) {
    Campaign campaign = campaign_;
    move(campaign, share * kModulusStep);
    return campaign;
  };
}

// A modulus of the bars, free or within what is filed; held altogether where that is exact.
void Prober::add_modulus(std::vector<Direction>& out, double testing::TrueMaterial::*member,
                         bool held, double relative_sd) {
  if (held && relative_sd == 0.0) {
    return;
  }
  const auto move = [member](Campaign& campaign, double relative) {
    campaign.world.material.*member *= std::exp(relative);
  };
  out.push_back({unit_change(along(move), kModulusStep, Differences::central), relative_sd, move});
}

void Prober::add_specimen(std::vector<Direction>& out) {
  using S = testing::TrueSpecimen;
  const Specimen& filed = *campaign_.bench.specimen;
  for (const auto& [of_specimen, sd] :
       {std::pair{&S::E1_Pa, 0.0},
        {&S::E2_Pa, 0.0},
        {&S::eta2_Pa_s, 0.0},
        {&S::length_m, filed.length_m.sd / filed.length_m.value},
        {&S::diameter_m, filed.diameter_m.sd / filed.diameter_m.value}}) {
    const auto member = of_specimen;
    if (sd > 0.0 || (member != &S::length_m && member != &S::diameter_m)) {
      const auto move = [member](Campaign& campaign, double relative) {
        campaign.split->specimen.*member *= std::exp(relative);
      };
      out.push_back({unit_change(along(move), kModulusStep, Differences::central), sd, move});
    }
  }
}

void Prober::add_gauges(std::vector<Direction>& out) {
  for (std::size_t g = 0; g < campaign_.world.gauges.size(); ++g) {
    const Gauge& filed = campaign_.bench.gauges[g];
    const std::string& name = campaign_.world.gauges[g].name;
    if (filed.position_m.sd > 0.0) {
      out.push_back({unit_change({{"gauge-position", name, 1e-4, {}}, {}, 0.0}),
                     filed.position_m.sd, hidden_at("gauge-position", name)});
    }
    if (filed.strain_per_V && filed.strain_per_V->sd > 0.0) {
      out.push_back({unit_change({{"gauge-factor", name, 1e-3, {}}, {}, 0.0}),
                     filed.strain_per_V->sd / filed.strain_per_V->value,
                     hidden_at("gauge-factor", name)});
    }
  }
}

}  // namespace kolsky::scoring
