#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "processing/reduction/ball/ball_impact.hpp"
#include "processing/waves/wave_theory.hpp"

namespace kolsky {

enum class Verdict { pass, warn, fail };

/// One judged number: what it is, what it came to, what it is held against, and a sentence for
/// people.
struct Check {
  std::string name{};  ///< as "equilibrium", "signal_to_noise", "window_overlap", "clipping",
                       ///< "loop_closure"
  double value = 0.0;
  double limit = 0.0;
  std::string unit{};  ///< "1", "dB", "s", ...
  Verdict verdict = Verdict::pass;
  std::string text{};
};

struct Quality {
  bool reducible = false;
  std::string reason{};  ///< why it is not
  std::string mend{};    ///< what would be right
  std::vector<Check> checks;

  /// The worst of the checks; fail when not reducible.
  [[nodiscard]] Verdict verdict() const;
  /// Null where there is none of that name.
  [[nodiscard]] const Check* find(const std::string& check) const;
};

/// How the waves in a bar are told apart where they overlap.
///   as_needed    by two or more places of gauges on the input bar, where there are as many and the
///                striker still pushes when the specimen's answer is back at the gauge; else never
///   never        by time: the incident pulse is over before the answer comes
///   gauges       by all gauges of each bar, on the output bar also by what its far end does
///   equilibrium  likewise, the output bar's force serving as the force at the input bar's end
enum class Separation { as_needed, never, gauges, equilibrium };

/// @throws InputError for any other name than auto, never, gauges, equilibrium
[[nodiscard]] Separation separation_from(const std::string& name);
[[nodiscard]] std::string name_of(Separation separation);

/// Which forces the specimen's stress is taken from: three-wave, the mean of both faces; one-wave,
/// the transmitted wave's, at the back; two-wave, that of incident and reflected, at the front.
enum class StressFrom { both_faces, back, front };

/// @throws InputError for any other name than three-wave, one-wave, two-wave
[[nodiscard]] StressFrom stress_from(const std::string& name);
[[nodiscard]] std::string name_of(StressFrom from);

/// What is taken off the stress besides. All off unless asked for.
struct Corrections {
  bool axial_inertia = false;
  bool radial_inertia = false;
  std::optional<double> friction;  ///< coefficient between specimen and bars

  [[nodiscard]] bool any() const { return axial_inertia || radial_inertia || friction; }
};

/// For people: axial inertia, radial inertia, friction.
[[nodiscard]] std::vector<std::string> names_of(const Corrections& corrections);

/// A specimen's histories, engineering, compression positive, equally spaced; t = 0 when the pulse
/// arrives at interface A (the input bar's end). All arrays have the same length.
struct Reduction {
  std::vector<double> time_s;
  std::vector<double> stress_Pa;
  std::vector<double> strain;
  std::vector<double> strain_rate_per_s;
  std::vector<double> force_front_N;
  std::vector<double> force_back_N;
  std::vector<double> strain_true;  ///< these two where they are asked for, else empty
  std::vector<double> stress_true_Pa;
  // The waves behind them, as strain at the interfaces.
  std::vector<double> incident;
  std::vector<double> reflected;
  std::vector<double> transmitted;
  double arrival_s = 0.0;  ///< of the incident pulse at interface A, from the shot's first sample
  double arrival_sigma_s = 0.0;
  double band_limit_Hz = 0.0;
  WaveTheory theory = WaveTheory::elementary;       ///< of the bars' waves
  StressFrom stress_from = StressFrom::both_faces;  ///< and `corrections` are of `stress_Pa`
  Corrections corrections{};
  Separation separation = Separation::never;  ///< how waves were separated, never as_needed
  /// Where equilibrium was taken for granted: from when it may be (infinite: nothing says from
  /// when). 0 where it was not.
  double assumed_from_s = 0.0;
  /// What is left of the striker's push, as a share of its peak, where the reflection hides it; 0
  /// where that does not stand out of the noise.
  double push_left_share = 0.0;
  std::size_t quiet_samples = 0;  ///< before the pulse: baselines and noise are theirs
  std::string bar_model{};        ///< what the bars were taken to be, for people
  Quality quality;
  /// Of a ball on a bar: then everything from `time_s` to `transmitted` is empty.
  std::optional<BallImpact> ball{};
};

}  // namespace kolsky
