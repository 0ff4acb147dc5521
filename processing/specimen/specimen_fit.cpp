#include "processing/specimen/specimen_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

#include "processing/base/error.hpp"
#include "processing/reduction/formatted.hpp"
#include "processing/specimen/fit_warnings.hpp"
#include "processing/specimen/specimen_family.hpp"

namespace kolsky {

namespace {

/// Beyond so many standard deviations of chi2 a longer window does not follow the same model.
constexpr double kSameModel = 4.0;

struct Fitted {
  ShpbTheory theory;
  SpecimenMinimum minimum;
  Loss loss = Loss::open;
};

std::vector<SpecimenWaves> kinds_of_waves(const SpecimenFitOptions& options,
                                          const Specimen& specimen) {
  if (options.specimen) {
    return {*options.specimen};
  }
  std::vector<SpecimenWaves> kinds = {SpecimenWaves::massless};
  if (specimen.density_kg_m3) {
    kinds.push_back(SpecimenWaves::rod);
    if (specimen.poisson_ratio) {
      kinds.push_back(SpecimenWaves::lateral);
    }
  }
  return kinds;
}

std::vector<double> logarithms(const std::vector<double>& values) {
  std::vector<double> logs(values.size());
  std::transform(values.begin(), values.end(), logs.begin(),
                 [](double value) { return std::log(value); });
  return logs;
}

/// Fits under every set of assumptions that is open; the simplest of those that explain the data.
class TheoryChoice {
 public:
  /// @param three_element  the choice with three elements, from which another family is searched;
  ///   null: from a coarse grid. Outlives this.
  TheoryChoice(SpecimenLikelihood& likelihood, const SpecimenFitOptions& options, SolidKind solid,
               TheoryChoice* three_element = nullptr)
      : likelihood_(likelihood),
        options_(options),
        solid_(solid),
        three_element_(three_element),
        kinds_(kinds_of_waves(options, *likelihood.bench().specimen)) {}

  Fitted choose() {
    if (three_element_ == nullptr) {
      starts_ = first_starts();
    }
    attempt_all(options_.bars.value_or(WaveTheory::elementary), kinds_);
    if (!options_.bars) {
      attempt_exact_bars();
    }
    return best();
  }

  /// What was fitted, to other records of the same shots: a longer part of them.
  [[nodiscard]] SpecimenMinimum again(SpecimenLikelihood& other, const Fitted& fitted) {
    if (three_element_ == nullptr) {
      return SpecimenSearch(other, solid_, fitted.theory, fitted.loss)
          .minimise(fitted.minimum.parameters);
    }
    const Fitted beside{fitted.theory, three_element_->minimum_under(fitted.theory)};
    return search_family(other, solid_, fitted.theory, three_element_->again(other, beside));
  }

  [[nodiscard]] SolidKind solid() const { return solid_; }

  [[nodiscard]] std::vector<TriedTheory> tried() const {
    std::vector<TriedTheory> list;
    for (const Fitted& fit : fits_) {
      list.push_back({fit.theory, fit.minimum.chi2, solid_});
    }
    list.insert(list.end(), refused_.begin(), refused_.end());
    return list;
  }

 private:
  [[nodiscard]] std::vector<std::vector<double>> first_starts() {
    if (solid_ == SolidKind::three_element && !options_.start.empty()) {
      return {logarithms(options_.start)};
    }
    return SpecimenSearch(likelihood_, solid_, {WaveTheory::elementary, kinds_.front()}).starts();
  }

  [[nodiscard]] SpecimenMinimum minimum_under(const ShpbTheory& theory) {
    for (const Fitted& fit : fits_) {
      if (fit.theory == theory) {
        return fit.minimum;
      }
    }
    return search(theory);
  }

  [[nodiscard]] SpecimenMinimum search(const ShpbTheory& theory) {
    return three_element_ == nullptr
               ? search_from(starts_, theory, options_.lossless ? Loss::none : Loss::open)
               : search_family(likelihood_, solid_, theory, three_element_->minimum_under(theory));
  }

  /// From where the best theory so far ended. Before there is one, from the grid's places until
  /// two of them lead to the same; where none do, the least chi2.
  [[nodiscard]] SpecimenMinimum search_from(const std::vector<std::vector<double>>& starts,
                                            const ShpbTheory& theory, Loss loss) {
    constexpr double kSame = 0.1;
    SpecimenSearch search(likelihood_, solid_, theory, loss);
    std::optional<SpecimenMinimum> least;
    std::optional<InputError> refusal;
    for (const std::vector<double>& start : starts) {
      try {
        SpecimenMinimum found = search.minimise(start);
        const bool same = least && std::abs(found.chi2 - least->chi2) < kSame;
        if (!least || found.chi2 < least->chi2) {
          least = std::move(found);
        }
        if (same || !fits_.empty()) {
          break;
        }
      } catch (const InputError& error) {
        refusal = error;
      }
    }
    if (!least) {
      throw *refusal;
    }
    return *least;
  }

  /// Where elementary waves in the bars lead nowhere, lateral inertia may be why.
  void attempt_exact_bars() {
    if (fits_.empty()) {
      attempt_all(WaveTheory::exact, kinds_);
      return;
    }
    const SpecimenWaves simple = best().theory.specimen;
    attempt({WaveTheory::exact, simple});
    if (best().theory.bars == WaveTheory::exact) {
      std::vector<SpecimenWaves> others = kinds_;
      std::erase(others, simple);
      attempt_all(WaveTheory::exact, others);
    }
  }

  void attempt_all(WaveTheory bars, const std::vector<SpecimenWaves>& kinds) {
    for (const SpecimenWaves kind : kinds) {
      attempt({bars, kind});
    }
  }

  /// A specimen that loses nothing, where that leaves little but noise: a loss that is not there is
  /// sought without end, and a theory that is wrong would be taken for want of the right one.
  bool attempt_without_loss(const ShpbTheory& theory) {
    constexpr double kFits = 1.5;
    if (solid_ != SolidKind::three_element || options_.lossless) {
      return false;
    }
    try {
      auto starts = SpecimenSearch(likelihood_, solid_, theory, Loss::none).starts();
      for (const Fitted& fit : fits_) {
        if (fit.loss == Loss::none) {
          starts.insert(starts.begin(), fit.minimum.parameters);
        }
      }
      SpecimenMinimum found = search_from(starts, theory, Loss::none);
      const auto judged =
          static_cast<double>(likelihood_.shots() * likelihood_.residuals_per_shot());
      if (found.chi2 < kFits * judged) {
        fits_.push_back({theory, std::move(found), Loss::none});
        return true;
      }
    } catch (const InputError&) {
      // Then it is not that either: what is said is why a loss was not found.
      return false;
    }
    return false;
  }

  void attempt(const ShpbTheory& theory) {
    try {
      fits_.push_back({theory, search(theory), options_.lossless ? Loss::none : Loss::open});
      if (three_element_ == nullptr && (fits_.size() == 1 || best().theory == theory)) {
        starts_.insert(starts_.begin(), fits_.back().minimum.parameters);
      }
    } catch (const InputError& error) {
      if (attempt_without_loss(theory)) {
        return;
      }
      // One set of assumptions may fail to converge while another describes the data.
      refused_.push_back(
          {theory, std::numeric_limits<double>::quiet_NaN(), solid_, error.problem()});
      refusal_ = error;
    }
  }

  [[nodiscard]] Fitted best() const {
    if (fits_.empty()) {
      throw *refusal_;
    }
    double least = std::numeric_limits<double>::infinity();
    for (const Fitted& fit : fits_) {
      least = std::min(least, fit.minimum.chi2);
    }
    return *std::find_if(fits_.begin(), fits_.end(), [&](const Fitted& fit) {
      return fit.minimum.chi2 <= least + kWorthwhile;
    });
  }

  SpecimenLikelihood& likelihood_;
  const SpecimenFitOptions& options_;
  SolidKind solid_;
  TheoryChoice* three_element_;
  std::vector<SpecimenWaves> kinds_;
  std::vector<std::vector<double>> starts_;  ///< the one to begin from first
  std::vector<Fitted> fits_;
  std::vector<TriedTheory> refused_;
  std::optional<InputError> refusal_;
};

double degrees_of_freedom(const SpecimenLikelihood& likelihood, SolidKind solid) {
  return static_cast<double>(likelihood.shots() * likelihood.residuals_per_shot()) -
         static_cast<double>(parameters_of(solid).size());
}

/// Whether the longer window's misfit is what its added data would leave under the same model.
bool same_model(double chi2, double dof, double longer_chi2, double longer_dof) {
  const double scale = std::max(1.0, chi2 / dof);
  const double added = longer_dof - dof;
  return added > 0.0 && longer_chi2 - chi2 <= scale * (added + kSameModel * std::sqrt(2.0 * added));
}

std::vector<double> moduli(const SpecimenMinimum& minimum) {
  std::vector<double> values(minimum.parameters.size());
  std::transform(minimum.parameters.begin(), minimum.parameters.end(), values.begin(),
                 [](double log) { return std::exp(log); });
  return values;
}

std::vector<std::vector<double>> covariance_of(SolidKind solid, const SpecimenMinimum& minimum,
                                               double widened) {
  const std::size_t size = parameters_of(solid).size();
  const std::vector<double> values = moduli(minimum);
  std::vector<std::vector<double>> covariance(size, std::vector<double>(size));
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < size; ++j) {
      covariance[i][j] =
          widened * values[i] * values[j] *
          minimum.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    }
  }
  return covariance;
}

std::vector<FittedNumber> numbers_of(SolidKind solid, const SpecimenMinimum& minimum,
                                     const std::vector<std::vector<double>>& covariance) {
  const auto& family = parameters_of(solid);
  const std::vector<double> values = moduli(minimum);
  std::vector<FittedNumber> numbers;
  for (std::size_t i = 0; i < family.size(); ++i) {
    numbers.push_back({family[i].name, values[i], std::sqrt(covariance[i][i])});
  }
  return numbers;
}

/// The same solid with its Kelvin branches in the order of their retardation times: the search
/// finds them in any.
SpecimenMinimum quickest_first(SolidKind solid, SpecimenMinimum minimum) {
  if (kelvin_branches(solid) < 2) {
    return minimum;
  }
  const SpecimenMinimum found = minimum;
  const auto& logs = found.parameters;
  std::vector<std::size_t> branches;  // by the place of E
  for (std::size_t place = 1; place < logs.size(); place += 2) {
    branches.push_back(place);
  }
  std::ranges::sort(branches, {}, [&](std::size_t place) { return logs[place + 1] - logs[place]; });
  Eigen::VectorXi from = Eigen::VectorXi::LinSpaced(found.covariance.rows(), 0,
                                                    static_cast<int>(found.covariance.rows()) - 1);
  for (std::size_t i = 0; i < branches.size(); ++i) {
    for (const std::size_t part : {0U, 1U}) {
      minimum.parameters[1 + 2 * i + part] = logs[branches[i] + part];
      from[static_cast<Eigen::Index>(1 + 2 * i + part)] = static_cast<int>(branches[i] + part);
    }
  }
  for (Eigen::Index i = 0; i < from.size(); ++i) {
    for (Eigen::Index j = 0; j < from.size(); ++j) {
      minimum.covariance(i, j) = found.covariance(from[i], from[j]);
    }
  }
  return minimum;
}

void fill_numbers(const SpecimenLikelihood& likelihood, const SpecimenMinimum& minimum,
                  SpecimenFit& fit) {
  const auto& family = parameters_of(fit.solid);
  const std::vector<double> values = moduli(minimum);
  fit.covariance = covariance_of(fit.solid, minimum, std::max(1.0, fit.chi2_reduced));
  fit.parameters = numbers_of(fit.solid, minimum, fit.covariance);
  for (std::size_t i = 1; fit.lossless && i < fit.parameters.size(); ++i) {
    FittedNumber& open = fit.parameters[i];
    open.sd = open.value;
    for (std::size_t j = 0; j < fit.parameters.size(); ++j) {
      fit.covariance[i][j] = fit.covariance[j][i] = i == j ? open.sd * open.sd : 0.0;
    }
  }
  const auto& unknowns = likelihood.unknowns();
  fit.by_bench.assign(family.size(), std::vector<double>(unknowns.size()));
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(family.size() + i);
    for (std::size_t p = 0; p < family.size(); ++p) {
      fit.by_bench[p][i] = values[p] * minimum.covariance(static_cast<Eigen::Index>(p), at);
    }
    fit.bench.push_back({unknowns[i].name, minimum.moves[i] * unknowns[i].sd,
                         std::sqrt(minimum.covariance(at, at)) * unknowns[i].sd});
  }
}

using ComplianceSteps = std::vector<std::vector<SpecimenLikelihood::ComplianceStep>>;

/// Over the shots, frequency by frequency.
std::vector<Complex> mean_of(const ComplianceSteps& steps) {
  std::vector<Complex> mean(steps.front().size(), 0.0);
  for (const auto& of_shot : steps) {
    for (std::size_t k = 0; k < mean.size(); ++k) {
      mean[k] += of_shot[k].relative / static_cast<double>(steps.size());
    }
  }
  return mean;
}

/// Relative variances of J1 and J2, in units of |J|, that all shots share: what the compliance at a
/// frequency would be if bench and bars were elsewhere within their deviations. The noise's part in
/// the fit is not among it, since each frequency's own step takes that back.
std::vector<std::pair<double, double>> common_variances(SpecimenLikelihood& likelihood,
                                                        const ShpbTheory& theory,
                                                        const Compliance& solid,
                                                        const SpecimenMinimum& minimum,
                                                        const std::vector<Complex>& mean,
                                                        std::span<const Complex> direction) {
  constexpr double kStep = 0.1;  // deviations
  const std::size_t unknowns = minimum.moves.size();
  const auto first = minimum.covariance.rows() - static_cast<Eigen::Index>(unknowns);
  Eigen::MatrixXd slope1(mean.size(), unknowns);
  Eigen::MatrixXd slope2(mean.size(), unknowns);
  for (std::size_t i = 0; i < unknowns; ++i) {
    std::vector<double> moves(minimum.moves.begin(), minimum.moves.end());
    moves[i] += kStep;
    const std::vector<Complex> moved = mean_of(likelihood.compliance_steps(theory, solid, moves));
    for (std::size_t k = 0; k < mean.size(); ++k) {
      const Complex slope = direction[k] * (moved[k] - mean[k]) / kStep;
      slope1(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) = slope.real();
      slope2(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) = slope.imag();
    }
  }
  const Eigen::MatrixXd bench = minimum.covariance.bottomRightCorner(
      minimum.covariance.rows() - first, minimum.covariance.rows() - first);
  const Eigen::VectorXd of1 = (slope1 * bench).cwiseProduct(slope1).rowwise().sum();
  const Eigen::VectorXd of2 = (slope2 * bench).cwiseProduct(slope2).rowwise().sum();
  std::vector<std::pair<double, double>> variances;
  for (Eigen::Index k = 0; k < of1.size(); ++k) {
    variances.emplace_back(std::max(0.0, of1[k]), std::max(0.0, of2[k]));
  }
  return variances;
}

/// By how much shots scatter more than the gauges' noise makes them, as a factor of the deviation
/// and at least 1: some may agree by chance to better than their noise allows. Neighbouring
/// frequencies and J1 and J2 are taken together, since a few shots say little of one number's
/// scatter. Fewer than three shots do not show theirs.
std::vector<double> excess_scatter(const ComplianceSteps& steps, const std::vector<Complex>& mean) {
  constexpr std::size_t kEnoughShots = 3;
  constexpr std::size_t kEitherSide = 4;
  std::vector<double> factor(mean.size(), 1.0);
  if (steps.size() < kEnoughShots) {
    return factor;
  }
  for (std::size_t k = 0; k < mean.size(); ++k) {
    const std::size_t begin = k - std::min(k, kEitherSide);
    const std::size_t end = std::min(mean.size(), k + kEitherSide + 1);
    double squares = 0.0;
    for (std::size_t n = begin; n < end; ++n) {
      for (const auto& of_shot : steps) {
        squares += std::norm((of_shot[n].relative - mean[n]) / of_shot[n].noise_sd);
      }
    }
    const auto freedoms = static_cast<double>(2 * (end - begin) * (steps.size() - 1));
    factor[k] = std::sqrt(std::max(1.0, squares / freedoms));
  }
  return factor;
}

/// Frequency by frequency about the fit: mean over the shots, how they scatter, and what bench and
/// bars leave open.
void fill_spectrum(SpecimenLikelihood& likelihood, const SpecimenMinimum& minimum,
                   SpecimenFit& fit) {
  const auto solid = make_solid(fit.solid, moduli(minimum));
  const auto steps = likelihood.compliance_steps(fit.theory, *solid, minimum.moves);
  const std::vector<Complex> mean = mean_of(steps);
  std::vector<Complex> assumed;
  std::vector<Complex> direction;
  for (const SpecimenLikelihood::ComplianceStep& step : steps.front()) {
    assumed.push_back(solid->at({0.0, 2.0 * std::numbers::pi * step.frequency_Hz}));
    direction.push_back(assumed.back() / std::abs(assumed.back()));
  }
  const auto common = common_variances(likelihood, fit.theory, *solid, minimum, mean, direction);
  const std::vector<double> excess = excess_scatter(steps, mean);
  const auto shots = static_cast<double>(steps.size());
  for (std::size_t k = 0; k < mean.size(); ++k) {
    double scatter = 0.0;
    for (const auto& of_shot : steps) {
      scatter += std::pow(of_shot[k].noise_sd * excess[k], 2) / shots;
    }
    const double size = std::abs(assumed[k]);
    const auto& [common1, common2] = common[k];
    const Complex J = assumed[k] * (1.0 + mean[k]);
    CompliancePoint point;
    point.frequency_Hz = steps.front()[k].frequency_Hz;
    point.J1_per_Pa = J.real();
    point.J2_per_Pa = -J.imag();
    point.J1_sd = size * std::sqrt(scatter + common1);
    point.J2_sd = size * std::sqrt(scatter + common2);
    point.J1_sd_of_mean = size * std::sqrt(scatter / shots + common1);
    point.J2_sd_of_mean = size * std::sqrt(scatter / shots + common2);
    fit.spectrum.push_back(point);
  }
}

void warn(SpecimenFit& fit) {
  if (fit.lossless) {
    fit.warnings.emplace_back(
        "no loss stands out of the noise: E2_Pa and eta2_Pa_s are not determined; the specimen is "
        "as good as elastic with E1_Pa, and no family of solids is compared with another");
  } else {
    fit.warnings = warnings_of(fit.parameters);
  }
  if (fit.three_element && fit.three_element->chi2_gain < kWorthwhile) {
    fit.warnings.push_back(no_more_than_three_elements(fit));
  }
  if (leaves_more_than_noise(fit)) {
    fit.warnings.push_back(
        formatted("the model leaves more than noise (chi2 per degree of freedom %.3g): deviations "
                  "are widened for what is left, which does not cover what the model lacks, nor "
                  "what is not as filed",
                  fit.chi2_reduced));
  }
  for (std::string& warning : warnings_of(fit.spectrum)) {
    fit.warnings.push_back(std::move(warning));
  }
}

/// The parts of the records that are judged.
struct Windows {
  std::unique_ptr<SpecimenLikelihood> longest;
  std::unique_ptr<SpecimenLikelihood> beginning;  ///< null: only the longest

  [[nodiscard]] SpecimenLikelihood& first() const { return beginning ? *beginning : *longest; }
};

Windows windows_of(const std::vector<Shot>& shots, const BarPrior& bars,
                   const SpecimenFitOptions& options) {
  SpecimenWindow window{options.band_limit_Hz, options.after_foot_s.value_or(0.0)};
  Windows windows;
  windows.longest = std::make_unique<SpecimenLikelihood>(shots, bars, window);
  if (options.most_band_Hz && windows.longest->band_limit_Hz() > *options.most_band_Hz) {
    window.band_limit_Hz = *options.most_band_Hz;
    windows.longest = std::make_unique<SpecimenLikelihood>(shots, bars, window);
  }
  if (!options.after_foot_s) {
    window.after_foot_s = windows.longest->first_return_s();
    window.band_limit_Hz = windows.longest->band_limit_Hz();
    windows.beginning = std::make_unique<SpecimenLikelihood>(shots, bars, window);
  }
  return windows;
}

/// What is taken, of which part of the records.
struct Decision {
  SolidKind solid = SolidKind::three_element;
  Fitted fitted;
  SpecimenLikelihood* likelihood = nullptr;
  bool to_the_end = false;
  std::vector<TriedTheory> tried;

  [[nodiscard]] double dof() const { return degrees_of_freedom(*likelihood, solid); }
};

/// To the records' end where the same model holds there too.
void lengthen(TheoryChoice& choice, SpecimenLikelihood& longest, Decision& decision) {
  try {
    const SpecimenMinimum longer = choice.again(longest, decision.fitted);
    if (same_model(decision.fitted.minimum.chi2, decision.dof(), longer.chi2,
                   degrees_of_freedom(longest, decision.solid))) {
      decision.fitted.minimum = longer;
      decision.likelihood = &longest;
      decision.to_the_end = true;
    }
  } catch (const InputError&) {
    // A model that does not even converge there does not hold there.
    return;
  }
}

Decision decide(const Windows& windows, TheoryChoice& choice) {
  Decision decision;
  decision.solid = choice.solid();
  decision.likelihood = &windows.first();
  decision.fitted = choice.choose();
  decision.tried = choice.tried();
  if (windows.longest->judged_s() > decision.likelihood->judged_s()) {
    lengthen(choice, *windows.longest, decision);
  }
  return decision;
}

ThreeElementsBeside beside(const Decision& three, double chi2) {
  const SpecimenMinimum& minimum = three.fitted.minimum;
  const double widened = std::max(1.0, minimum.chi2 / three.dof());
  ThreeElementsBeside result;
  result.parameters =
      numbers_of(three.solid, minimum, covariance_of(three.solid, minimum, widened));
  result.chi2_gain = minimum.chi2 - chi2;
  return result;
}

/// Another family than three elements, by what those decide unless it is worth more than they are.
Decision decide_family(const Windows& windows, const SpecimenFitOptions& options,
                       SpecimenFit& fit) {
  TheoryChoice three_element(windows.first(), options, SolidKind::three_element);
  Decision three;
  try {
    three = decide(windows, three_element);
  } catch (const InputError&) {
    TheoryChoice alone(windows.first(), options, options.solid);
    return decide(windows, alone);
  }
  // Families differ in how they lose.
  if (three.fitted.loss == Loss::none) {
    return three;
  }
  Decision decision = three;
  decision.solid = options.solid;
  decision.fitted.minimum =
      search_family(*three.likelihood, options.solid, three.fitted.theory, three.fitted.minimum);
  fit.three_element = beside(three, decision.fitted.minimum.chi2);
  if (fit.three_element->chi2_gain <= kWorthwhile) {
    return decision;
  }
  TheoryChoice own(windows.first(), options, options.solid, &three_element);
  return decide(windows, own);
}

Decision decide(const Windows& windows, const SpecimenFitOptions& options, SpecimenFit& fit) {
  if (options.solid != SolidKind::three_element) {
    return decide_family(windows, options, fit);
  }
  TheoryChoice choice(windows.first(), options, options.solid);
  return decide(windows, choice);
}

}  // namespace

SpecimenFit fit_specimen(const std::vector<Shot>& shots, const BarPrior& bars,
                         const SpecimenFitOptions& options) {
  if (shots.empty()) {
    throw InputError("captures", "are none", "give at least one shot on the specimen");
  }
  const Windows windows = windows_of(shots, bars, options);
  SpecimenFit fit;
  const Decision decision = decide(windows, options, fit);
  const SpecimenMinimum minimum = quickest_first(decision.solid, decision.fitted.minimum);
  fit.solid = decision.solid;
  fit.lossless = decision.fitted.loss == Loss::none;
  fit.theory = decision.fitted.theory;
  fit.tried = decision.tried;
  fit.to_the_end = decision.to_the_end;
  fit.degrees_of_freedom = static_cast<std::size_t>(decision.dof());
  fit.chi2_reduced = minimum.chi2 / decision.dof();
  fit.band_limit_Hz = decision.likelihood->band_limit_Hz();
  fit.judged_s = decision.likelihood->judged_s();
  fit.after_foot_s = decision.likelihood->after_foot_s();
  fill_numbers(*decision.likelihood, minimum, fit);
  fill_spectrum(*decision.likelihood, minimum, fit);
  warn(fit);
  return fit;
}

}  // namespace kolsky
