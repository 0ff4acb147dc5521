#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/criticism/fitting/study.hpp"

namespace kolsky {

/// One change on the way from a model to another.
struct LineageStep {
  std::string effect;    ///< its id; empty for the model that the lineage begins with
  bool removed = false;  ///< taken out, not put in
  Model model;           ///< after it
};

/// The models from `first` to `last`, one effect more (or less) at a time. A filed number that the
/// last model has freed of its prior counts as an effect added, and so does a choice (numbers that
/// are held in both) that has become another.
/// @param order  ids in the order in which they were added, as the ledger has them; what is not
/// named there follows in the order of `last`
[[nodiscard]] std::vector<LineageStep> lineage(const Model& first, const Model& last,
                                               const std::vector<std::string>& order);

/// A number of the material as one model of the lineage has it.
struct MovedNumber {
  std::string name;  ///< "E1_Pa", or "bar.E1_Pa" beside a specimen
  std::string unit;
  double value = 0.0;
  double sd = 0.0;
};

/// A specimen's stress under a strain that grows at a constant rate, as a model has it.
struct SpecimenCurve {
  std::vector<double> strain;
  std::vector<double> stress_Pa;
  std::vector<double> sd_Pa;
};

/// How far a model is from the impacts of one speed.
struct SpeedMisfit {
  double speed_m_per_s = 0.0;
  double rms_percent = 0.0;    ///< of the mean force's deviation, of its peak
  double noise_percent = 0.0;  ///< what noise leaves there
  double restitution_foretold = 0.0;
  double restitution_measured = 0.0;  ///< 0: no rebound speeds
};

struct WaterfallStep {
  std::string effect;
  bool removed = false;
  double held_out = 0.0;   ///< chi2 per residual on folds the fit did not see, as `HeldOut` has it
  double gain = 0.0;       ///< chi2 that the step took off them
  std::size_t better = 0;  ///< in so many of them
  double relief = 0.0;     ///< chi2 of the filed numbers\' priors that the step took off
  Misfit misfit;           ///< of all shots, all of them fitted
  /// As the model's own fit has them, deviations widened by what it leaves.
  std::vector<MovedNumber> numbers;
  std::vector<MovedNumber> strengths;  ///< of the effect put in, as this model has them
  SpecimenCurve curve;                 ///< empty where there is no specimen
  std::vector<SpeedMisfit> speeds;     ///< empty where no ball strikes
};

/// From a first model's misfit through what each effect takes off it to what is left.
struct Waterfall {
  std::vector<WaterfallStep> steps;
  double floor = 1.0;    ///< chi2 per residual that noise leaves
  double repeats = 0.0;  ///< chi2 per residual that still repeats from shot to shot
  double signal = 0.0;   ///< chi2 per residual of the records themselves
  /// chi2 per degree of freedom that the last model leaves beside the noise before the pulses
  /// (`judged`): what differs from shot to shot counts as noise in all the levels. Not of impacts.
  std::optional<double> last_beside_quiet;
  /// What else the model may be off by that held_out and floor count as they do noise; repeats and
  /// signal are by the noise alone.
  std::string allowance;
  bool within_allowance = false;   ///< what still repeats
  double strain_rate_per_s = 0.0;  ///< of the curves
  std::size_t shots = 0;
  std::string fold = "shots";  ///< held out one at a time: shots, speeds, or "parts" of one record
  std::size_t folds = 0;
  bool pull_counts = true;  ///< what filed numbers pull is part of every level

  /// Of what stood over the floor at first, the share that is gone; 1 where nothing stood there.
  [[nodiscard]] double closed() const;
};

/// Whether a model is so far from the records that what its fit says of its numbers is worth
/// little: most of what it leaves is not noise.
[[nodiscard]] bool far_from_fitting(const WaterfallStep& step, const Waterfall& fall);

/// Fits every model of a lineage to one campaign: by itself, for its numbers, and under the noise
/// that the last one shows, for its level beside the others'.
[[nodiscard]] Waterfall waterfall(Study& study, const std::vector<LineageStep>& lineage);

/// An effect's numbers as a model has them, their names behind `prefix`.
[[nodiscard]] std::vector<MovedNumber> numbers_of(const EffectUse& use, const std::string& prefix);

/// What a model leaves on every fold, and the pull of the filed numbers that it takes for that.
struct LeftOnFolds {
  std::vector<double> squares;
  double penalty = 0.0;
};

/// Takes into a step what it left. @param before  of the step before; null: none
/// @param residuals  how many there are on all folds
void take_drop(WaterfallStep& step, const LeftOnFolds& left, const LeftOnFolds* before,
               double residuals);

/// By what a deviation grows where a fit leaves more than noise (Birge's ratio).
[[nodiscard]] double widening(const Misfit& misfit);

/// Stress of the specimen of a model at a constant strain rate, with its deviation from the fit's
/// covariance, widened by what the fit leaves. With stiffening; friction and a gap are not of its
/// material and are left out.
[[nodiscard]] SpecimenCurve specimen_curve(const Studied& studied, const Campaign& campaign,
                                           double strain_rate_per_s);

}  // namespace kolsky
