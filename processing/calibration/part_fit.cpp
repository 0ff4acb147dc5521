#include "processing/calibration/part_fit.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "processing/algebra/algebra.hpp"
#include "processing/calibration/null_directions.hpp"
#include "processing/calibration/part_model.hpp"
#include "processing/criticism/fitting/share_of_pulses.hpp"
#include "processing/criticism/fitting/study.hpp"
#include "processing/criticism/records/judged_band.hpp"
#include "processing/criticism/search/candidates.hpp"
#include "processing/identification/bar_misfit.hpp"
#include "processing/identification/known_unknowns.hpp"
#include "processing/models/material_effects.hpp"
#include "processing/waves/bar_modes.hpp"

namespace kolsky {

namespace {

/// What differs by more of its deviations is named, for one number; see `named_from`.
constexpr double kNamed = 3.0;
/// Explanations whose objectives lie nearer to each other are not told apart.
constexpr double kTie = 9.0;
/// Tolerances while waves and far end are chosen, so that a misfiled bench does not choose them.
constexpr double kLoosely = 5.0;
constexpr double kClearlyBetter = 10.0;
constexpr std::size_t kMostRefits = 12;
/// Shots that are enough to tell waves and far end.
constexpr std::size_t kShotsToChoose = 2;
constexpr double kSpeedAt_Hz = 1e4;

/// The highest frequency to judge: where none is asked for, what the noise leaves of that in which
/// the bars' moduli are known.
double band_Hz(const Campaign& campaign, const CalibrationOptions& options) {
  const auto& identified = options.bars ? options.bars->material.identified : std::nullopt;
  if (options.band_limit_Hz > 0.0 || !identified || !identified->band_limit_Hz) {
    return options.band_limit_Hz;
  }
  return std::min(judged_band(campaign, 0.0).limit_Hz, *identified->band_limit_Hz);
}

/// Deviations that the worst of so many numbers exceeds by chance as rarely as one number does
/// three.
double named_from(std::size_t numbers) {
  const double allowed = -std::expm1(std::log1p(-std::erfc(kNamed / std::numbers::sqrt2)) /
                                     static_cast<double>(std::max<std::size_t>(1, numbers)));
  double low = kNamed;
  double high = 2.0 * kNamed;
  constexpr int kHalvings = 40;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (std::erfc(middle / std::numbers::sqrt2) > allowed ? low : high) = middle;
  }
  return high;
}

/// What the data by themselves, with all other priors, say of one number of a fit.
struct Alone {
  double value = 0.0;  ///< of the effect
  double sd = 0.0;
  double deviations = 0.0;  ///< from its prior
};

class PartFit {
 public:
  PartFit(const CalibrationPart& part, const CalibrationOptions& options)
      : part_(part),
        options_(options),
        bars_(options.bars.value_or(part.bars)),
        campaign_(read_campaign(part.shots)) {
    result_.lay = part.lay;
    result_.two_passes = part.two_passes;
    result_.shots = part.shots.size();
    result_.swapped = part.swapped;
    result_.inverted = part.inverted;
    result_.areas = pulse_areas(part, campaign_, bars_);
  }

  PartResult run() {
    choose_variant();
    numbers_ = numbers_of(part_, campaign_.bench, options_, variant_);
    release_what_differs();
    describe();
    return std::move(result_);
  }

 private:
  /// A fit with its study, whose weights it was made under.
  struct Fitted {
    Study study;
    Studied studied;
    Fitted(const Campaign& campaign, const CalibrationOptions& options, const Model& model)
        : study(campaign, band_Hz(campaign, options), options.workers), studied(study.fit(model)) {}
    [[nodiscard]] double widening() const { return std::max(1.0, studied.misfit.chi2_reduced); }
  };

  [[nodiscard]] Model model(const PartVariant& variant, const std::vector<ModelNumber>& numbers,
                            const std::set<std::string>& released, double loosen) const {
    return part_model(part_, campaign_.bench, options_, variant, numbers, released, loosen);
  }

  [[nodiscard]] double objective(const PartVariant& variant) const {
    const auto numbers = numbers_of(part_, campaign_.bench, options_, variant);
    Campaign few = campaign_;
    few.shots.resize(std::min(few.shots.size(), kShotsToChoose));
    return Fitted(few, options_, model(variant, numbers, {}, kLoosely)).studied.fit.objective();
  }

  void tell(const std::string& step) const { options_.progress(name_of(part_.lay) + ": " + step); }

  /// Waves by themselves do not tell: where the far end answers otherwise than a variant has it,
  /// other waves may hide some of that. All combinations are fitted, exact waves and a return each
  /// at a price, as elementary waves and a far end that says nothing are the simpler story.
  void choose_variant() {
    tell("which waves, and whether the far end answers");
    const bool may_return = part_.lay != BarsLay::together && !part_.two_passes;
    double best = std::numeric_limits<double>::infinity();
    for (const bool exact_waves : {false, true}) {
      for (const bool far_end_seen : {false, true}) {
        if (far_end_seen && !may_return) {
          continue;
        }
        const PartVariant variant{exact_waves, far_end_seen};
        const double price =
            kClearlyBetter * (static_cast<int>(exact_waves) + static_cast<int>(far_end_seen));
        const double tried = objective(variant) + price;
        if (tried < best) {
          best = tried;
          variant_ = variant;
        }
      }
    }
    result_.exact_waves = variant_.exact_waves;
    result_.far_end_seen = variant_.far_end_seen;
  }

  [[nodiscard]] static std::size_t place_of(const Composition& composition,
                                            const ModelNumber& number) {
    for (std::size_t i = 0; i < composition.numbers().size(); ++i) {
      const FreeNumber& free = composition.numbers()[i];
      if (composition.uses()[free.use].id() == number.effect &&
          free.parameter == number.parameter) {
        return i;
      }
    }
    return composition.numbers().size();
  }

  /// Prior's weights in the fit's scales.
  [[nodiscard]] static Eigen::VectorXd weights(const Composition& composition) {
    Eigen::VectorXd weight =
        Eigen::VectorXd::Zero(static_cast<Eigen::Index>(composition.numbers().size()));
    for (Eigen::Index i = 0; i < weight.size(); ++i) {
      const FreeNumber& free = composition.numbers()[static_cast<std::size_t>(i)];
      if (free.prior_sd > 0.0) {
        weight[i] = free.scale * free.scale / (free.prior_sd * free.prior_sd);
      }
    }
    return weight;
  }

  [[nodiscard]] static Alone alone(const Fitted& fitted, const ModelNumber& number) {
    const Composition& composition = fitted.studied.composition;
    const ModelFit& fit = fitted.studied.fit;
    const auto i = static_cast<Eigen::Index>(place_of(composition, number));
    const FreeNumber& free = composition.numbers()[static_cast<std::size_t>(i)];
    Eigen::VectorXd weight = weights(composition);
    const double own = weight[i];
    weight[i] = 0.0;
    Eigen::MatrixXd without = fit.jacobian.transpose() * fit.jacobian;
    without.diagonal() += weight;
    const double variance =
        std::abs(solve_symmetric(without, Eigen::VectorXd::Unit(weight.size(), i))[i]) *
        fitted.widening();
    const double mean = free.prior_mean / free.scale;
    const double at = fit.theta[static_cast<std::size_t>(i)];
    Alone result;
    const double shifted = at + variance / fitted.widening() * own * (at - mean);
    result.value = shifted * free.scale;
    result.sd = std::sqrt(variance) * free.scale;
    result.deviations = own > 0.0 ? (shifted - mean) / std::sqrt(variance + 1.0 / own) : 0.0;
    return result;
  }

  struct Explanation {
    const ModelNumber* number = nullptr;
    double objective = 0.0;
    Eigen::VectorXd white;   ///< residuals
    Eigen::VectorXd pulses;  ///< of what stands out of the noise
    Alone measured;
  };

  [[nodiscard]] static LeftByFit left_by(const Explanation& own) { return {own.white, own.pulses}; }

  /// By how much the worse of two explanations is behind, as far as the records can tell.
  [[nodiscard]] static double lag(const Explanation& worse, const Explanation& better) {
    const double chance = (1.0 - share_of_pulses(left_by(worse), left_by(better))) *
                          (worse.white.squaredNorm() - better.white.squaredNorm());
    return worse.objective - better.objective - chance;
  }

  /// Fits with one more number released, under the same weights.
  [[nodiscard]] Explanation explain(Fitted& fitted, const ModelNumber& number) {
    std::set<std::string> more = released_;
    more.insert(number.id);
    const Composition composition(model(variant_, numbers_, more, 0.0), campaign_);
    std::vector<double> start =
        carry(fitted.studied.composition, fitted.studied.fit.theta, composition);
    const std::size_t place = place_of(composition, number);
    start[place] = alone(fitted, number).value / composition.numbers()[place].scale;
    const ModelFit fit =
        fit_model(composition, fitted.study.residuals(), fitted.study.executor(), start);
    Explanation explanation{&number,
                            fit.objective() + momentum_penalty(composition, fit),
                            fit.residual,
                            fitted.study.residuals().whiten_pulses(composition, fit.theta, 0),
                            {}};
    const auto at = static_cast<Eigen::Index>(place);
    explanation.measured.value = fit.theta[place] * composition.numbers()[place].scale;
    explanation.measured.sd =
        std::sqrt(fit.covariance(at, at)) * composition.numbers()[place].scale;
    return explanation;
  }

  /// What the striker's momentum says against a fit's gain of the first gauge.
  [[nodiscard]] double momentum_penalty(const Composition& composition, const ModelFit& fit) const {
    const double left = momentum_left(composition, fit);
    return left * left;
  }
  [[nodiscard]] double momentum_left(const Composition& composition, const ModelFit& fit) const {
    if (!result_.areas.momentum) {
      return 0.0;
    }
    double gain = 1.0;
    double sd = result_.areas.momentum->gain.sd;
    if (part_.two_passes && !trusted(options_, result_.areas.momentum->gauge)) {
      sd = std::hypot(sd, gain_sd(campaign_.bench.gauges[campaign_.reference]));
    }
    for (const ModelNumber& number : numbers_) {
      if (number.of == CalibratedNumber::Of::gain &&
          number.gauge == result_.areas.momentum->gauge) {
        const std::size_t place = place_of(composition, number);
        const double scale = composition.numbers()[place].scale;
        gain += fit.theta[place] * scale;
        const auto at = static_cast<Eigen::Index>(place);
        sd = std::hypot(sd, std::sqrt(fit.covariance(at, at)) * scale);
      }
    }
    return (result_.areas.momentum->gain.value - gain) / sd;
  }

  void release_what_differs() {
    for (std::size_t round = 0;; ++round) {
      tell(round == 0 ? "all " + std::to_string(numbers_.size()) + " numbers as filed"
                      : std::to_string(round) + " set free");
      fitted_ =
          std::make_unique<Fitted>(campaign_, options_, model(variant_, numbers_, released_, 0.0));
      if (round == 0) {
        result_.chi2_reduced_as_filed = fitted_->studied.misfit.chi2_reduced;
      }
      const double named = named_from(numbers_.size());
      std::vector<std::pair<double, const ModelNumber*>> suspects;
      for (const ModelNumber& number : numbers_) {
        const double z = std::abs(alone(*fitted_, number).deviations);
        if (number.believed && released_.count(number.id) == 0 && z > named) {
          suspects.emplace_back(z, &number);
        }
      }
      if (suspects.empty() || round >= numbers_.size()) {
        return;
      }
      release_best_of(suspects);
    }
  }

  void release_best_of(std::vector<std::pair<double, const ModelNumber*>>& suspects) {
    std::sort(suspects.begin(), suspects.end(),
              [](const auto& a, const auto& b) { return a.first > b.first; });
    suspects.resize(std::min(suspects.size(), kMostRefits));
    std::vector<Explanation> explanations;
    for (const auto& [z, number] : suspects) {
      tell("with " + number->id + " free");
      explanations.push_back(explain(*fitted_, *number));
    }
    std::stable_sort(
        explanations.begin(), explanations.end(),
        [](const Explanation& a, const Explanation& b) { return a.objective < b.objective; });
    const Explanation& best = explanations.front();
    released_.insert(best.number->id);
    // Under a model that leaves more than noise, differences count for less.
    const double residuals = static_cast<double>(fitted_->studied.fit.residual.size());
    const double near = kTie * std::max(1.0, best.objective / residuals);
    for (const Explanation& other : explanations) {
      if (other.number != best.number && lag(other, best) < near) {
        ties_[best.number->id].push_back(other.number->id);
        ties_[other.number->id].push_back(best.number->id);
        measured_if_tied_[other.number->id] = other.measured;
      }
    }
  }

  [[nodiscard]] static Measured number_from(const ModelNumber& number, double value, double sd) {
    if (number.relative) {
      return {number.filed.value * (1.0 + value), number.filed.value * sd};
    }
    return {number.filed.value + number.per_value * (value - number.origin), number.per_value * sd};
  }

  void describe() {
    const Studied& studied = fitted_->studied;
    result_.chi2_reduced = studied.misfit.chi2_reduced;
    result_.areas.momentum_left = momentum_left(studied.composition, studied.fit);
    for (const ModelNumber& number : numbers_) {
      result_.numbers.push_back(describe(number));
    }
    describe_speed();
    describe_null_directions();
  }

  [[nodiscard]] CalibratedNumber describe(const ModelNumber& number) const {
    CalibratedNumber out;
    out.of = number.of;
    out.id = number.id;
    out.gauge = number.gauge;
    out.bar = number.bar;
    out.filed = number.filed;
    const auto& [composition, fit] = std::tie(fitted_->studied.composition, fitted_->studied.fit);
    const std::size_t place = place_of(composition, number);
    const auto at = static_cast<Eigen::Index>(place);
    const double scale = composition.numbers()[place].scale;
    const double posterior_sd = std::sqrt(fit.covariance(at, at) * fitted_->widening()) * scale;
    out.combined = number_from(number, fit.theta[place] * scale, posterior_sd);
    Alone own = alone(*fitted_, number);
    const auto tied = ties_.find(number.id);
    if (const auto other = measured_if_tied_.find(number.id); other != measured_if_tied_.end()) {
      own.value = other->second.value;
      own.sd = other->second.sd;
    }
    out.measured = number_from(number, own.value, own.sd);
    const bool released = released_.count(number.id) > 0;
    const double spread = std::hypot(out.measured.sd, out.filed.sd);
    if (number.believed && spread > 0.0) {
      out.deviations = (out.measured.value - out.filed.value) / spread;
    }
    if (!number.believed) {
      out.standing = Standing::unfiled;
    } else if ((tied != ties_.end() || released || std::abs(out.deviations) > kNamed ||
                !(own.sd > 0.0)) &&
               explains_nothing()) {
      out.standing = Standing::unexplained;
      out.combined = out.filed;
    } else if (tied != ties_.end()) {
      out.standing = Standing::tied;
      out.tied_with = tied->second;
    } else if (released) {
      out.standing = Standing::differs;
      out.combined = out.measured;
    } else if (own.sd > kNamed * std::max(number.filed_sd(), number.step)) {
      out.standing = Standing::unseen;
    } else if (std::abs(out.deviations) > kNamed) {
      out.standing = Standing::doubtful;
    }
    return out;
  }

  /// Whether the records are of something else than bars lying like this.
  [[nodiscard]] bool explains_nothing() const { return leaves_most() || at_a_limit(); }

  /// Whether a released number is as far off as any may be, a gain at ten or a tenth: it goes there
  /// for want of what is really between the bars, even where enough such numbers leave but noise. A
  /// fit that describes nothing may stop a little before it gets there.
  [[nodiscard]] bool at_a_limit() const {
    constexpr double kClose = 1e-3;
    const Composition& composition = fitted_->studied.composition;
    return std::any_of(numbers_.begin(), numbers_.end(), [&](const ModelNumber& number) {
      const std::size_t place = place_of(composition, number);
      const FreeNumber& free = composition.numbers()[place];
      const double value = fitted_->studied.fit.theta[place] * free.scale;
      const double close = kClose * (free.upper - free.lower);
      return released_.count(number.id) > 0 &&
             (value < free.lower + close || value > free.upper - close);
    });
  }

  /// Whether what was released explains too little of the misfit to be what differs.
  [[nodiscard]] bool leaves_most() const {
    constexpr double kFarOff = 20.0;
    const double left = result_.chi2_reduced - 1.0;
    const double most = result_.chi2_reduced > kFarOff ? 0.1 : 0.5;
    return result_.chi2_reduced > kMoreThanNoise &&
           !(left < most * (result_.chi2_reduced_as_filed - 1.0));
  }

  /// Phase speed in the input bar with these moduli and, last, the density by this factor.
  [[nodiscard]] double speed(const std::vector<double>& values) const {
    Bar bar = campaign_.bench.input;
    bar.density_kg_m3.value *= values.back();
    Material material = bars_.material;
    const auto places = three_element_places(material.solid);
    for (std::size_t i = 0, m = 0; i < numbers_.size(); ++i) {
      if (numbers_[i].bar == "output") {
        continue;
      }
      switch (numbers_[i].of) {
        case CalibratedNumber::Of::elastic_modulus:
          bar.youngs_modulus_Pa->value *= values[m++] / numbers_[i].filed.value;
          break;
        case CalibratedNumber::Of::E1:
        case CalibratedNumber::Of::E2:
        case CalibratedNumber::Of::eta2:
          material.parameters[places[numbers_[i].parameter]].value = values[m++];
          break;
        default:
          break;
      }
    }
    std::vector<Complex> path;
    constexpr int kSteps = 50;
    for (int k = 1; k <= kSteps; ++k) {
      path.emplace_back(0.0, 2.0 * std::numbers::pi * kSpeedAt_Hz * k / kSteps);
    }
    const auto modes = bar_modes(variant_.exact_waves ? WaveTheory::exact : WaveTheory::elementary,
                                 bar, *compliance_of(bar, material), path);
    return path.back().imag() / modes.back().gamma.imag();
  }

  /// What a modulus of the input bar, or with no number its density's factor, is in a fit.
  struct OfSpeed {
    Eigen::Index place = 0;
    double value = 0.0;
    double per_theta = 0.0;
    bool modulus = false;
  };

  /// As `speed` takes them.
  [[nodiscard]] std::vector<OfSpeed> numbers_of_speed() const {
    const Composition& composition = fitted_->studied.composition;
    const std::vector<double>& theta = fitted_->studied.fit.theta;
    std::vector<OfSpeed> list;
    for (const ModelNumber& number : numbers_) {
      if (number.of >= CalibratedNumber::Of::elastic_modulus && number.bar != "output") {
        const std::size_t place = place_of(composition, number);
        const double scale = composition.numbers()[place].scale;
        list.push_back({static_cast<Eigen::Index>(place),
                        number_from(number, theta[place] * scale, 0.0).value,
                        number.relative ? number.filed.value * scale : scale, true});
      }
    }
    for (std::size_t i = 0; i < composition.numbers().size(); ++i) {
      const FreeNumber& free = composition.numbers()[i];
      if (composition.uses()[free.use].id() == "bar-density") {
        list.push_back(
            {static_cast<Eigen::Index>(i), 1.0 + theta[i] * free.scale, free.scale, false});
      }
    }
    return list;
  }

  /// As the shots alone have it: that moduli are filed, or taken for exact, measures no speed.
  void describe_speed() {
    const Composition& composition = fitted_->studied.composition;
    const ModelFit& fit = fitted_->studied.fit;
    const std::vector<OfSpeed> numbers = numbers_of_speed();
    std::vector<double> values;
    for (const OfSpeed& number : numbers) {
      values.push_back(number.value);
    }
    if (numbers.empty() || numbers.back().modulus) {
      values.push_back(1.0);  // the density's factor
    }
    const double at = speed(values);
    Eigen::VectorXd weight = weights(composition);
    Eigen::VectorXd pull = Eigen::VectorXd::Zero(weight.size());
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(weight.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const Eigen::Index place = numbers[i].place;
      const auto k = static_cast<std::size_t>(place);
      std::vector<double> moved = values;
      const double step = 1e-4 * values[i];
      moved[i] += step;
      slope[place] = (speed(moved) - at) / step * numbers[i].per_theta;
      if (numbers[i].modulus) {
        const FreeNumber& free = composition.numbers()[k];
        pull[place] = weight[place] * (fit.theta[k] - free.prior_mean / free.scale);
        weight[place] = 0.0;
      }
    }
    Eigen::MatrixXd without = fit.jacobian.transpose() * fit.jacobian;
    without.diagonal() += weight;
    const Eigen::VectorXd of_slope = solve_symmetric(without, slope);
    const double variance = slope.dot(of_slope) * fitted_->widening();
    result_.wave_speed_at_Hz = kSpeedAt_Hz;
    // Of what shots do not tell at all rounding may make a variance below nothing.
    result_.wave_speed_m_per_s = {
        at + of_slope.dot(pull),
        variance > 0.0 ? std::sqrt(variance) : std::numeric_limits<double>::infinity()};
  }

  void describe_null_directions() {
    const ModelFit& fit = fitted_->studied.fit;
    const auto& composition = fitted_->studied.composition;
    const Eigen::MatrixXd all = fit.jacobian.transpose() * fit.jacobian;
    std::vector<std::string> names;
    std::vector<Eigen::Index> places;
    std::vector<double> steps;
    for (const ModelNumber& number : numbers_) {
      if (number.of_both) {
        continue;  // both bars' own numbers moved alike
      }
      const std::size_t place = place_of(composition, number);
      places.push_back(static_cast<Eigen::Index>(place));
      steps.push_back(number.step / composition.numbers()[place].scale);
      names.push_back(number.id);
    }
    const auto count = static_cast<Eigen::Index>(places.size());
    Eigen::MatrixXd information(count, count);
    for (Eigen::Index a = 0; a < count; ++a) {
      for (Eigen::Index b = 0; b < count; ++b) {
        const auto i = static_cast<std::size_t>(a);
        const auto j = static_cast<std::size_t>(b);
        information(a, b) = all(places[i], places[j]) * steps[i] * steps[j];
      }
    }
    result_.cannot_tell = null_directions(information, names);
    if (part_.two_passes && !result_.areas.momentum) {
      result_.cannot_tell.push_back("gauge-factor:" + campaign_.bench.gauges.front().name);
    }
  }

  const CalibrationPart& part_;
  const CalibrationOptions& options_;
  BarPrior bars_;
  Campaign campaign_;
  PartVariant variant_;
  std::vector<ModelNumber> numbers_;
  std::set<std::string> released_;
  std::map<std::string, std::vector<std::string>> ties_;
  std::map<std::string, Alone> measured_if_tied_;
  std::unique_ptr<Fitted> fitted_;
  PartResult result_;
};

}  // namespace

PartResult fit_part(const CalibrationPart& part, const CalibrationOptions& options) {
  return PartFit(part, options).run();
}

}  // namespace kolsky
