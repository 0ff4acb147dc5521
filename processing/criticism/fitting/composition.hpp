#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "processing/criticism/records/campaign.hpp"
#include "processing/models/model.hpp"
#include "processing/models/physics.hpp"

namespace kolsky {

/// One number that a fit may move. What moves is theta = (value / scale)^power.
struct FreeNumber {
  std::size_t use = 0;
  std::size_t parameter = 0;
  double start = 0.0;  ///< in its unit
  double scale = 1.0;
  double lower = 0.0;  ///< in its unit
  double upper = 0.0;
  double prior_mean = 0.0;
  double prior_sd = 0.0;     ///< 0: none
  std::ptrdiff_t shot = -1;  ///< the only one it acts on; -1: all
  double difference = 2e-3;  ///< step of numeric derivatives, in scales
  double power = 1.0;
  double filed_share = 0.0;  ///< relative deviation by filed numbers, beside that of the fit

  [[nodiscard]] double theta_of(double value) const;
  [[nodiscard]] double value_at(double theta) const;
  /// Deviation of the value where theta has this one: the larger side's.
  [[nodiscard]] double sd_at(double theta, double theta_sd) const;
  [[nodiscard]] double inside(double theta) const;  ///< the bounds
};

/// A model laid out for a campaign: every number that is free, once, per shot or per gauge, and the
/// known unknowns of the bench as effects of their own with what is filed of them as prior.
class Composition {
 public:
  Composition(const Model& model, const Campaign& campaign);

  [[nodiscard]] const std::vector<EffectUse>& uses() const { return uses_; }
  [[nodiscard]] const std::vector<FreeNumber>& numbers() const { return numbers_; }
  [[nodiscard]] std::vector<double> start() const;  ///< in scales
  /// Inverse covariance of the priors, in scales; rows of zeros where there is none.
  [[nodiscard]] Eigen::MatrixXd prior_precision() const;

  /// What acts on one shot. @param theta  one per free number, in scales
  [[nodiscard]] std::vector<AppliedEffect> applied(const std::vector<double>& theta,
                                                   std::size_t shot) const;
  /// Whether shots differ in how waves travel, not only in what is added to their records.
  [[nodiscard]] bool differs_by_shot() const { return differs_by_shot_; }
  /// Whether any record is changed before waves are sought in it.
  [[nodiscard]] bool changes_records() const { return changes_records_; }

  /// The free numbers of one use: by parameter, shot and gauge.
  [[nodiscard]] std::vector<std::size_t> numbers_of(std::size_t use) const;

 private:
  struct Slot {
    std::ptrdiff_t number = -1;  ///< index of the free number; -1: fixed
    double fixed = 0.0;
  };
  void add(const EffectUse& use, const Campaign& campaign);

  std::size_t shots_ = 0;
  std::size_t gauges_ = 0;
  std::vector<EffectUse> uses_;
  std::vector<std::size_t> gauge_of_use_;
  /// A parameter's numbers: one, or one per shot, per gauge or both.
  struct Slots {
    std::size_t shots = 1;
    std::size_t gauges = 1;
    std::vector<Slot> of;

    [[nodiscard]] const Slot& at(std::size_t shot, std::size_t gauge) const {
      return of[(shots > 1 ? shot : 0) * gauges + (gauges > 1 ? gauge : 0)];
    }
  };
  std::vector<std::vector<Slots>> slots_;  ///< by use and parameter
  std::vector<FreeNumber> numbers_;
  bool differs_by_shot_ = false;
  bool changes_records_ = false;
};

/// What a number is counted in: its prior's deviation, or without one its typical size.
[[nodiscard]] double scale_of(const ModelValue& value, const EffectParameter& parameter);

/// What all gauges have alike is the source's: strengths of each gauge's own run away together
/// unless a prior bounds them. In a record much shorter than a period only slopes show, so that the
/// bound is one on them: with the same for all frequencies a strong hum would look more likely as
/// its third harmonic. Does nothing to other effects.
void bound_strengths(EffectUse& use);

/// Whether an effect has strengths of each shot's or each gauge's own: a model keeps their mean.
[[nodiscard]] bool has_own_strengths(const EffectUse& use);

/// The model with every number held, those filed of the bench too, but the strengths that its file
/// does not hold.
[[nodiscard]] Model all_but_own_held(Model model, const Bench& bench);

/// The bench's filed deviations as effects with priors: gauge factors, positions, density, the
/// bars' and the specimen's dimensions.
[[nodiscard]] std::vector<EffectUse> known_unknowns_of(const Bench& bench);

}  // namespace kolsky
