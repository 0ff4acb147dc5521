#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "processing/criticism/fitting/fit.hpp"
#include "processing/criticism/fitting/misfit.hpp"

namespace kolsky {

/// A model fitted to a campaign.
struct Studied {
  Model model;  ///< with values and deviations, the bench's known unknowns among its effects
  Composition composition;
  ModelFit fit;
  Misfit misfit;
};

/// Whether a fit's residuals say of the noise what the quiet before the pulses does not.
enum class LearnNoise { yes, no };

/// A campaign under study: its records ready, models fitted and compared one after the other.
class Study {
 public:
  /// @param campaign  outlives this
  /// @param band_limit_Hz  0: where the pulses fall below the noise
  Study(const Campaign& campaign, double band_limit_Hz, Workers executor);

  /// Fits from wherever the model's moduli are, and where an earlier fit has led them astray from
  /// the library's too. What was just added begins at the best of its auxiliary parameters' starts
  /// or of a few sizes, and what is free to choose among a few is held at the best from then on.
  /// Where it is open whether shots share a strength, a likelihood-ratio test at 0.1 % settles it.
  [[nodiscard]] Studied fit(const Model& model, LearnNoise learn = LearnNoise::yes);
  /// The same from where it is, with the noise as known by now.
  [[nodiscard]] Studied refit(const Studied& studied);
  /// The model as it is, its misfit not yet reckoned. Nothing moves but strengths of each shot's or
  /// each gauge's own: a model keeps their mean, these shots have their own.
  [[nodiscard]] Studied with_own_strengths(const Model& model);
  /// The same, its misfit as `beside_quiet` has it.
  [[nodiscard]] Studied as_it_is(const Model& model) {
    return beside_quiet(with_own_strengths(model));
  }
  /// What was fitted, its misfit beside the noise that the quiet parts show, slow noise corrected
  /// as far as they are too short for it. A fit counts as noise what does not repeat from shot to
  /// shot, a pulse that the record cuts among it: by that measure a model that lacks an end's
  /// reflection fitted as well as one that has it.
  /// @param humming  the same beside a hum that is no noise: noise is learned from what that leaves
  [[nodiscard]] Studied beside_quiet(Studied studied, const Studied* humming = nullptr);

  [[nodiscard]] WhiteResiduals& residuals() { return residuals_; }
  [[nodiscard]] const Campaign& campaign() const { return campaign_; }
  [[nodiscard]] const Workers& executor() const { return executor_; }

 private:
  /// The model with every form that is open settled.
  [[nodiscard]] Model formed(Model model);
  [[nodiscard]] Model begun(Model model);
  struct Attempt {
    Model begun;
    Composition composition;
    ModelFit fit;
  };
  /// A fit from where a model begins, its own residuals known as noise.
  [[nodiscard]] Attempt attempt(const Model& model);
  /// The same from where nobody has fitted the moduli, where those of an earlier fit lead astray
  /// and that is better.
  [[nodiscard]] Attempt best_attempt(const Model& model);

  const Campaign& campaign_;
  Workers executor_;
  WhiteResiduals residuals_;
};

}  // namespace kolsky
