#pragma once

#include <memory>
#include <optional>

#include "processing/base/material.hpp"
#include "processing/base/shot.hpp"
#include "processing/reduction/reduction.hpp"
#include "processing/waves/wave_theory.hpp"

namespace kolsky {

struct ReductionOptions {
  std::optional<Material>
      bar_model;  ///< of viscoelastic bars; else the shot's own, else the paper's PMMA
  std::optional<double>
      arrival_s;  ///< manual override: incident foot at gauge 1, from the first sample
  std::optional<double>
      band_limit_Hz;                   ///< manual override of the limit that follows from the noise
  std::optional<double> most_band_Hz;  ///< of the limit that follows from the noise: as far as the
                                       ///< bars are known
  WaveTheory theory = WaveTheory::elementary;
  StressFrom stress = StressFrom::both_faces;
  Corrections corrections;  ///< to the stress
  Separation separation = Separation::as_needed;
  /// How much of what is left of the striker's push where the reflection hides it goes on behind:
  /// 0 none of it (it is over), 1 all of it, as strong as it was last seen, for as long again as it
  /// was seen.
  double push_goes_on = 0.0;
  std::optional<double> duration_s;  ///< of the histories; else until the first wave comes back to
                                     ///< the specimen from a bar's far end, 2 length / front speed;
                                     ///< where waves are separated at least to the end of the first
                                     ///< loading
  bool with_true = false;            ///< true strain and stress beside the engineering ones
};

/// Reduces shots, keeping the transform plans and propagation tables of the last four benches and
/// lengths of record. Not to be used by two threads at once. The same shot gives the same bits each
/// time, whatever was reduced before.
class Reducer {
 public:
  explicit Reducer(ReductionOptions options = {});
  ~Reducer();
  Reducer(Reducer&&) noexcept;
  Reducer& operator=(Reducer&&) noexcept;

  /// Three-wave reduction (paper, eqs 10 to 24 with their errata); of a bench of kind "impact" the
  /// ball's force and rebound instead (BallReducer), in `Reduction::ball`. A shot that cannot be
  /// reduced (gap, clipped codes, no pulse, a bench without a specimen) gives empty histories and
  /// the reason in `quality`.
  /// @throws InputError where the bench itself does not suit (no gauge on a bar, no modulus)
  [[nodiscard]] Reduction reduce(const Shot& shot);

  /// Reduces by these options from now on; what still fits of plans and tables is kept.
  void set_options(ReductionOptions options);

  /// Takes viscoelastic bars to be of another material from now on.
  void set_bar_model(const Material& material);

  /// Takes the striker's push to go on by this share from now on.
  void set_push_goes_on(double share);

  /// Takes the band to end here from now on.
  void set_band_limit_Hz(double limit_Hz);

  /// How often propagation tables of two bars were made, not found.
  [[nodiscard]] std::size_t tables_made() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kolsky
