#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "drivers/simulated/bench_model.hpp"
#include "drivers/simulated/front_end.hpp"
#include "processing/base/bench.hpp"
#include "processing/base/material.hpp"

namespace kolsky {

/// A ball that is thrown at the bar: the bench says how large, this what of and how fast.
struct ThrownBall {
  double speed_m_per_s = 0.0;
  Material core;
  Material cover;
};

/// A bench that the simulated digitiser can stand at: what is nominally there, what really moves,
/// and the electronics.
struct Scenario {
  std::string name;
  std::string text;  ///< one line for people
  Bench bench;       ///< as its bench file states it; gauge i is channel i
  BenchModel model;  ///< the same in the time domain
  std::optional<ThrownBall> ball{};
  FrontEndSettings front_end;
  double record_s = 4e-3;  ///< from the impact on, as the model has it
  double fade_s = 4e-3;    ///< then the bars come to rest, so that the record's end is no step
};

[[nodiscard]] std::vector<Scenario> scenarios();

/// @throws InputError that lists the names
[[nodiscard]] Scenario find_scenario(const std::string& name);

/// The bench file of a scenario whose front end may have been changed: gauges in volts with the
/// factor that makes them strain.
[[nodiscard]] std::string bench_toml(const Scenario& scenario);

/// A shot of the scenario at the model's own steps, faded out at its end.
[[nodiscard]] BenchHistory run_shot(const Scenario& scenario);

/// The model's steps per second: a multiple of every rate.
inline constexpr double kStepsPerSecond = 8e6;

/// Rates of the simulated converter in Hz; each divides kStepsPerSecond.
inline constexpr double kSampleRates_Hz[] = {250e3, 500e3, 1e6, 2e6};

/// What the model knows of a ball, as CSV: time_s (from first touch), force_N. Of a specimen, with
/// one row per sample of the scenario's rate: time_s (from the arrival of the pulse's very front at
/// interface A), stress_Pa (mean of both faces), strain, strain_rate_per_s, force_front_N,
/// force_back_N. @throws InputError where there is neither
void write_truth(const Scenario& scenario, const BenchHistory& shot, std::ostream& out);

}  // namespace kolsky
