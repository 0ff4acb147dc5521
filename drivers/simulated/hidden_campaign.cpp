#include "drivers/simulated/hidden_campaign.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <sstream>

#include "drivers/simulated/front_end.hpp"
#include "drivers/simulated/number_text.hpp"

namespace kolsky {

namespace {

constexpr double kPositionSd_m = 2e-4;
constexpr double kGainSd = 2e-3;
constexpr double kStrainPerVolt = 1e-3;
constexpr double kFullScale_V = 5.0;
constexpr std::size_t kGauges = 4;
/// A bar whose end sends nothing back within a record.
constexpr double kEndless_m = 2.3;

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : engine_(seed) {}

  /// 53 random bits, alike on every machine.
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11U) * 0x1p-53;
  }
  double sign() { return between(0.0, 1.0) < 0.5 ? -1.0 : 1.0; }
  std::size_t below(std::size_t count) {
    return static_cast<std::size_t>(between(0.0, static_cast<double>(count)));
  }
  /// Within what a deviation admits, never far out.
  double error(double sd) { return sd * between(-1.7, 1.7); }

 private:
  std::mt19937_64 engine_;
};

std::string gauge_name(std::size_t gauge) {
  return "g" + std::to_string(gauge + 1);
}

HiddenTruth of_gauge(const std::string& id, std::size_t gauge, const std::string& parameter,
                     const std::string& unit, double strength, const std::string& words) {
  HiddenTruth truth;
  truth.id = id + ":" + gauge_name(gauge);
  truth.parameter = parameter;
  truth.unit = unit;
  truth.strength = strength;
  truth.words = "gauge " + gauge_name(gauge) + " " + words;
  truth.gauge = gauge;
  return truth;
}

HiddenTruth of_bar(const std::string& id, const std::string& parameter, const std::string& unit,
                   double strength, const std::string& words) {
  HiddenTruth truth;
  truth.id = id;
  truth.parameter = parameter;
  truth.unit = unit;
  truth.strength = strength;
  truth.words = words;
  return truth;
}

HiddenTruth draw_truth(Draw& draw) {
  const std::size_t gauge = draw.below(kGauges);
  switch (draw.below(12)) {
    case 0:
      return of_gauge("gauge-position", gauge, "delta", "m", draw.sign() * draw.between(2e-3, 5e-3),
                      "is not glued where the bench file says");
    case 1:
      return of_gauge("gauge-factor", gauge, "kappa", "-", draw.sign() * draw.between(0.025, 0.05),
                      "reads a few percent wrong");
    case 2:
      return of_gauge("channel-delay", gauge, "tau", "s", draw.between(1.5e-6, 5e-6),
                      "is recorded late");
    case 3:
      return of_gauge("amplifier-bandwidth", gauge, "tau", "s", draw.between(4e-6, 1e-5),
                      "has a slow amplifier");
    case 4:
      return of_gauge("crosstalk", gauge, "kappa", "-", draw.between(0.01, 0.04),
                      "picks up its neighbour");
    case 5:
      return of_gauge("baseline-drift", gauge, "b1", "1/s", draw.sign() * draw.between(0.02, 0.06),
                      "drifts while a shot is recorded");
    case 6:
      return of_bar("end-reflection", "r", "-", 0.0, "the bar's free far end sends waves back");
    case 7:
      return of_bar("temperature", "c", "1/K", draw.between(2e-3, 5e-3),
                    "the bar is softer when it is warmer");
    case 8: {
      HiddenTruth truth = of_bar("second-relaxation", "D", "1/Pa", draw.between(3e-12, 8e-12),
                                 "the material relaxes once more, slowly");
      truth.tau_s = draw.between(1.5e-4, 4e-4);
      return truth;
    }
    case 9:
      return of_bar("series-dashpot", "phi", "1/(Pa s)", draw.between(1e-8, 4e-8),
                    "the material flows");
    case 10: {
      HiddenTruth truth = of_gauge("creep of the adhesive", gauge, "share", "-",
                                   draw.between(0.04, 0.1), "creeps in its adhesive");
      truth.tau_s = draw.between(5e-5, 1.5e-4);
      truth.in_library = false;
      return truth;
    }
    default:
      return of_bar("", "", "", 0.0, "nothing is hidden: the paper's model is all there is");
  }
}

HiddenShot draw_shot(Draw& draw, const HiddenCampaign& campaign) {
  HiddenShot shot;
  shot.striker_speed_m_per_s = std::round(draw.between(6.0, 12.0) * 100.0) / 100.0;
  shot.temperature_K = campaign.temperature_K + std::round(draw.between(-4.0, 4.0) * 100.0) / 100.0;
  const double area = 0.25 * std::numbers::pi * campaign.diameter_m * campaign.diameter_m;
  // A striker of the same bar gives half its speed over the wave's as strain.
  const double strain =
      shot.striker_speed_m_per_s / (2.0 * campaign.material.front_speed_m_per_s());
  shot.pulse.peak_force_N = strain * campaign.material.E1_Pa * area * draw.between(0.97, 1.03);
  shot.pulse.duration_s = draw.between(150e-6, 220e-6);
  shot.pulse.ramp_s = draw.between(25e-6, 45e-6);
  shot.fraction = draw.between(0.0, 1.0);
  return shot;
}

/// The rod's strain at every gauge and step after the impact.
std::vector<std::vector<double>> strains(const HiddenCampaign& campaign, const HiddenShot& shot,
                                         double step_s, std::size_t steps) {
  RodMaterial material = campaign.material;
  const HiddenTruth& truth = campaign.truth;
  if (truth.id == "temperature") {
    const double softer = 1.0 - truth.strength * (shot.temperature_K - campaign.temperature_K);
    material.E1_Pa *= softer;
    material.E2_Pa *= softer;
  } else if (truth.id == "second-relaxation") {
    material.relaxations.push_back({truth.strength, truth.tau_s});
  } else if (truth.id == "series-dashpot") {
    material.phi_per_Pa_s = truth.strength;
  }
  BenchModel model;
  const double area = 0.25 * std::numbers::pi * campaign.diameter_m * campaign.diameter_m;
  model.input = {truth.id == "end-reflection" ? campaign.length_m : kEndless_m, area, material};
  model.pulse = shot.pulse;
  for (const double position : campaign.true_position_m) {
    model.gauges.push_back({RodId::input, position});
  }
  return run_bench(model, step_s, steps).gauge_strain;
}

/// y' = (x - y) / tau for a record that is linear between its points.
std::vector<double> slowed(const std::vector<double>& record, double step_s, double tau_s) {
  std::vector<double> out(record.size(), 0.0);
  const double x = step_s / tau_s;
  const double keep = std::exp(-x);
  const double mean = -std::expm1(-x) / x;
  for (std::size_t n = 1; n < out.size(); ++n) {
    out[n] = keep * out[n - 1] + (mean - keep) * record[n - 1] + (1.0 - mean) * record[n];
  }
  return out;
}

/// The record at a time, by the cubic through the four nearest steps; nothing before the impact.
double at(const std::vector<double>& record, double place) {
  const double left = std::floor(place);
  if (left < 1.0 || left + 2.0 >= static_cast<double>(record.size())) {
    return 0.0;
  }
  const double t = place - left;
  const double* const e = &record[static_cast<std::size_t>(left) - 1];
  return -t * (t - 1.0) * (t - 2.0) / 6.0 * e[0] + (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0 * e[1] -
         (t + 1.0) * t * (t - 2.0) / 2.0 * e[2] + (t + 1.0) * t * (t - 1.0) / 6.0 * e[3];
}

/// What happens to a gauge's strain on its way to the converter, before it is sampled.
void through_sensor(const HiddenTruth& truth, std::size_t gauge, double step_s,
                    std::vector<double>& record) {
  if (truth.gauge != gauge) {
    return;
  }
  if (truth.id.starts_with("amplifier-bandwidth")) {
    record = slowed(record, step_s, truth.strength);
  } else if (!truth.in_library) {
    const std::vector<double> late = slowed(record, step_s, truth.tau_s);
    for (std::size_t n = 0; n < record.size(); ++n) {
      record[n] += truth.strength * (late[n] - record[n]);
    }
  }
}

/// The next channel, or the one before the last.
std::size_t neighbour_of(std::size_t gauge) {
  return gauge + 1 < kGauges ? gauge + 1 : gauge - 1;
}

class Recorder {
 public:
  Recorder(const HiddenCampaign& campaign, std::size_t shot, double steps_per_second)
      : campaign_(campaign), shot_(campaign.shots[shot]), steps_per_second_(steps_per_second) {
    settings_.bits = 14;
    settings_.range_microstrain = kStrainPerVolt * kFullScale_V * 1e6;
    settings_.full_scale_V = kFullScale_V;
    settings_.noise_microstrain = campaign.noise_microstrain;
    settings_.hum_microstrain = 0.0;
    settings_.offset_microstrain = 30.0;
    settings_.seed = campaign.seed * 1000 + shot;
  }

  [[nodiscard]] std::vector<std::vector<double>> volts() {
    const double step_s = 1.0 / steps_per_second_;
    const auto steps =
        static_cast<std::size_t>(std::ceil(time_of(campaign_.samples) * steps_per_second_) + 4.0);
    auto records = strains(campaign_, shot_, step_s, steps);
    for (std::size_t g = 0; g < records.size(); ++g) {
      through_sensor(campaign_.truth, g, step_s, records[g]);
    }
    std::vector<std::vector<double>> readings;
    for (std::size_t g = 0; g < records.size(); ++g) {
      readings.push_back(sampled(records, g));
    }
    return digitised(std::move(readings));
  }

 private:
  /// Since the impact.
  [[nodiscard]] double time_of(std::size_t sample) const {
    return (static_cast<double>(sample) - static_cast<double>(campaign_.pre_samples) +
            shot_.fraction) /
           campaign_.sample_rate_Hz;
  }

  [[nodiscard]] std::vector<double> sampled(const std::vector<std::vector<double>>& records,
                                            std::size_t gauge) const {
    const HiddenTruth& truth = campaign_.truth;
    const bool own = truth.gauge == gauge;
    const double late = own && truth.id.starts_with("channel-delay") ? truth.strength : 0.0;
    const double drift = own && truth.id.starts_with("baseline-drift") ? truth.strength : 0.0;
    const double picked = own && truth.id.starts_with("crosstalk") ? truth.strength : 0.0;
    std::vector<double> out(campaign_.samples);
    for (std::size_t n = 0; n < out.size(); ++n) {
      const double time_s = time_of(n);
      out[n] = campaign_.gain[gauge] * at(records[gauge], (time_s - late) * steps_per_second_) +
               drift * time_s;
      if (picked != 0.0) {
        const std::size_t other = neighbour_of(gauge);
        out[n] += picked * campaign_.gain[other] * at(records[other], time_s * steps_per_second_);
      }
    }
    return out;
  }

  [[nodiscard]] std::vector<std::vector<double>> digitised(
      std::vector<std::vector<double>> readings) const {
    std::vector<std::int32_t> codes(campaign_.samples);
    const SampleRate rate{static_cast<std::int64_t>(campaign_.sample_rate_Hz), 1};
    for (std::size_t g = 0; g < readings.size(); ++g) {
      FrontEnd(settings_, g).convert(0, rate, readings[g], codes);
      for (std::size_t n = 0; n < codes.size(); ++n) {
        readings[g][n] = static_cast<double>(codes[n]) * settings_.volts_per_code();
      }
    }
    return readings;
  }

  const HiddenCampaign& campaign_;
  const HiddenShot& shot_;
  double steps_per_second_;
  FrontEndSettings settings_;
};

}  // namespace

HiddenCampaign draw_hidden_campaign(std::uint64_t seed, std::size_t shots) {
  Draw draw(seed);
  HiddenCampaign campaign;
  campaign.seed = seed;
  campaign.truth = draw_truth(draw);
  campaign.material.density_kg_m3 = std::round(draw.between(1175.0, 1200.0));
  campaign.material.E1_Pa = draw.between(5.2e9, 6.1e9);
  campaign.material.E2_Pa = draw.between(2.8e10, 4.5e10);
  campaign.material.eta2_Pa_s = draw.between(1.4e6, 2.3e6);
  campaign.density_kg_m3 = campaign.material.density_kg_m3;
  campaign.length_m = std::round(draw.between(1.3, 1.6) * 1000.0) / 1000.0;
  campaign.diameter_m = 0.016;
  campaign.temperature_K = 293.15;
  campaign.noise_microstrain = draw.between(2.0, 5.0);
  campaign.sample_rate_Hz = 1e6;
  campaign.samples = 1600;
  campaign.pre_samples = 250;
  double position = draw.between(0.18, 0.24);
  for (std::size_t g = 0; g < kGauges; ++g) {
    campaign.filed_position_m.push_back(std::round(position * 1000.0) / 1000.0);
    campaign.true_position_m.push_back(campaign.filed_position_m.back() +
                                       draw.error(kPositionSd_m));
    campaign.gain.push_back(1.0 + draw.error(kGainSd));
    position += draw.between(0.22, 0.34);
  }
  const HiddenTruth& truth = campaign.truth;
  if (truth.id.starts_with("gauge-position")) {
    campaign.true_position_m[truth.gauge] = campaign.filed_position_m[truth.gauge] + truth.strength;
  } else if (truth.id.starts_with("gauge-factor")) {
    campaign.gain[truth.gauge] = 1.0 + truth.strength;
  }
  for (std::size_t n = 0; n < shots; ++n) {
    campaign.shots.push_back(draw_shot(draw, campaign));
  }
  return campaign;
}

std::string bench_toml(const HiddenCampaign& campaign) {
  std::ostringstream out;
  out << "kind = \"bar\"\nsampling_frequency_Hz = " << number_text(campaign.sample_rate_Hz)
      << "\npositive = \"compression\"\ntemperature_K = " << number_text(campaign.temperature_K)
      << "\n\n[bars.input]\nlength_m = " << number_text(campaign.length_m)
      << "\ndiameter_m = " << number_text(campaign.diameter_m)
      << "\ndensity_kg_m3 = " << number_text(campaign.density_kg_m3) << "\npoisson_ratio = 0.35\n";
  for (std::size_t g = 0; g < campaign.filed_position_m.size(); ++g) {
    out << "\n[[gauges]]\nname = \"" << gauge_name(g)
        << "\"\nbar = \"input\"\nposition_m = " << number_text(campaign.filed_position_m[g])
        << "\nposition_m_sd = " << number_text(kPositionSd_m)
        << "\nunit = \"V\"\nstrain_per_V = " << number_text(kStrainPerVolt)
        << "\nstrain_per_V_sd = " << number_text(kStrainPerVolt * kGainSd) << "\n";
  }
  return out.str();
}

std::string shot_table(const HiddenCampaign& campaign, std::size_t shot, double steps_per_second) {
  const auto volts = Recorder(campaign, shot, steps_per_second).volts();
  std::ostringstream out;
  out << "time_s";
  for (std::size_t g = 0; g < volts.size(); ++g) {
    out << "," << gauge_name(g);
  }
  out << "\n";
  for (std::size_t n = 0; n < campaign.samples; ++n) {
    const double time_s = (static_cast<double>(n) - static_cast<double>(campaign.pre_samples)) /
                          campaign.sample_rate_Hz;
    out << number_text(time_s);
    for (const auto& record : volts) {
      out << "," << number_text(record[n]);
    }
    out << "\n";
  }
  return out.str();
}

}  // namespace kolsky
