#pragma once

#include <memory>
#include <string>
#include <vector>

#include "processing/criticism/fit.hpp"
#include "processing/criticism/misfit.hpp"

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

  /// Fits from wherever the model's moduli are. What was just added begins at the best of its
  /// auxiliary parameters' starts or of a few sizes, and what is free to choose among a few is held
  /// at the best from then on.
  [[nodiscard]] Studied fit(const Model& model, LearnNoise learn = LearnNoise::yes);
  /// The same from where it is, with the noise as known by now.
  [[nodiscard]] Studied refit(const Studied& studied);
  /// The model as it is, nothing moved.
  [[nodiscard]] Studied as_it_is(const Model& model);

  [[nodiscard]] WhiteResiduals& residuals() { return residuals_; }
  [[nodiscard]] const Campaign& campaign() const { return campaign_; }
  [[nodiscard]] const Workers& executor() const { return executor_; }

 private:
  [[nodiscard]] Model begun(Model model);
  /// With one of its numbers where the fit from there is best.
  [[nodiscard]] Model best_of(Model model, std::size_t use, std::size_t parameter,
                              const std::vector<double>& starts);

  const Campaign& campaign_;
  Workers executor_;
  WhiteResiduals residuals_;
};

}  // namespace kolsky
