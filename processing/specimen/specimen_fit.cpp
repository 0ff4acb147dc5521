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
      starts_ =
          SpecimenSearch(likelihood_, solid_, {WaveTheory::elementary, kinds_.front()}).starts();
    }
    const WaveTheory first = options_.bars.value_or(WaveTheory::elementary);
    for (const SpecimenWaves kind : kinds_) {
      attempt({first, kind});
    }
    if (!options_.bars) {
      const Fitted simple = best();
      attempt({WaveTheory::exact, simple.theory.specimen});
      if (best().theory.bars == WaveTheory::exact) {
        for (const SpecimenWaves kind : kinds_) {
          if (kind != simple.theory.specimen) {
            attempt({WaveTheory::exact, kind});
          }
        }
      }
    }
    return best();
  }

  /// What was fitted, to other records of the same shots: a longer part of them.
  [[nodiscard]] SpecimenMinimum again(SpecimenLikelihood& other, const Fitted& fitted) {
    if (three_element_ == nullptr) {
      return SpecimenSearch(other, solid_, fitted.theory).minimise(fitted.minimum.parameters);
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
               ? search_from_starts(theory)
               : search_family(likelihood_, solid_, theory, three_element_->minimum_under(theory));
  }

  /// From where the best theory so far ended. Before there is one, from the grid's places until
  /// two of them lead to the same; where none do, the least chi2.
  [[nodiscard]] SpecimenMinimum search_from_starts(const ShpbTheory& theory) {
    constexpr double kSame = 0.1;
    SpecimenSearch search(likelihood_, solid_, theory);
    std::optional<SpecimenMinimum> least;
    std::optional<InputError> refusal;
    for (const std::vector<double>& start : starts_) {
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

  void attempt(const ShpbTheory& theory) {
    try {
      fits_.push_back({theory, search(theory)});
      if (three_element_ == nullptr && (fits_.size() == 1 || best().theory == theory)) {
        starts_.insert(starts_.begin(), fits_.back().minimum.parameters);
      }
    } catch (const InputError& error) {
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

void fill_numbers(const SpecimenLikelihood& likelihood, const SpecimenMinimum& minimum,
                  SpecimenFit& fit) {
  const auto& family = parameters_of(fit.solid);
  const std::vector<double> values = moduli(minimum);
  fit.covariance = covariance_of(fit.solid, minimum, std::max(1.0, fit.chi2_reduced));
  fit.parameters = numbers_of(fit.solid, minimum, fit.covariance);
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

/// Standard deviations of J1 and J2 that follow from those of the solid's parameters.
std::pair<double, double> common_sd(const SpecimenFit& fit, Complex s) {
  constexpr double kStep = 1e-4;
  std::vector<double> values;
  for (const FittedNumber& p : fit.parameters) {
    values.push_back(p.value);
  }
  std::vector<Complex> slope;
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::vector<double> moved = values;
    moved[i] *= 1.0 + kStep;
    slope.push_back((make_solid(fit.solid, moved)->at(s) - make_solid(fit.solid, values)->at(s)) /
                    (kStep * values[i]));
  }
  double J1 = 0.0;
  double J2 = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (std::size_t j = 0; j < values.size(); ++j) {
      J1 += slope[i].real() * slope[j].real() * fit.covariance[i][j];
      J2 += slope[i].imag() * slope[j].imag() * fit.covariance[i][j];
    }
  }
  return {std::sqrt(std::max(0.0, J1)), std::sqrt(std::max(0.0, J2))};
}

/// Frequency by frequency about the fit: mean over the shots, and how they scatter. Fewer than
/// three shots do not show their scatter: then it is what the gauges' noise makes it.
void fill_spectrum(SpecimenLikelihood& likelihood, const SpecimenMinimum& minimum,
                   SpecimenFit& fit) {
  constexpr std::size_t kEnoughShots = 3;
  const auto solid = make_solid(fit.solid, moduli(minimum));
  const auto steps = likelihood.compliance_steps(fit.theory, *solid, minimum.moves);
  const auto shots = static_cast<double>(steps.size());
  for (std::size_t k = 0; k < steps.front().size(); ++k) {
    CompliancePoint point;
    point.frequency_Hz = steps.front()[k].frequency_Hz;
    const Complex s(0.0, 2.0 * std::numbers::pi * point.frequency_Hz);
    const Complex assumed = solid->at(s);
    std::vector<Complex> J;
    double noise = 0.0;
    Complex mean = 0.0;
    for (const auto& of_shot : steps) {
      J.push_back(assumed * (1.0 + of_shot[k].relative));
      mean += J.back() / shots;
      noise = std::max(noise, of_shot[k].noise_sd * std::abs(assumed));
    }
    double scatter1 = noise;
    double scatter2 = noise;
    if (steps.size() >= kEnoughShots) {
      scatter1 = scatter2 = 0.0;
      for (const Complex value : J) {
        scatter1 += std::pow((value - mean).real(), 2) / (shots - 1.0);
        scatter2 += std::pow((value - mean).imag(), 2) / (shots - 1.0);
      }
      // A few shots may agree by chance to better than their noise allows.
      scatter1 = std::max(noise, std::sqrt(scatter1));
      scatter2 = std::max(noise, std::sqrt(scatter2));
    }
    const auto [common1, common2] = common_sd(fit, s);
    point.J1_per_Pa = mean.real();
    point.J2_per_Pa = -mean.imag();
    point.J1_sd = std::hypot(scatter1, common1);
    point.J2_sd = std::hypot(scatter2, common2);
    point.J1_sd_of_mean = std::hypot(scatter1 / std::sqrt(shots), common1);
    point.J2_sd_of_mean = std::hypot(scatter2 / std::sqrt(shots), common2);
    fit.spectrum.push_back(point);
  }
}

void warn(SpecimenFit& fit) {
  fit.warnings = warnings_of(fit.parameters);
  if (fit.three_element && fit.three_element->chi2_gain < kWorthwhile) {
    fit.warnings.push_back(no_more_than_three_elements(fit));
  }
  if (fit.chi2_reduced > kPoorChi2) {
    fit.warnings.push_back(
        formatted("the model leaves more than noise (chi2 per degree of freedom %.3g): the "
                  "deviations are widened accordingly",
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
  const SpecimenMinimum& minimum = decision.fitted.minimum;
  fit.solid = decision.solid;
  fit.theory = decision.fitted.theory;
  fit.tried = decision.tried;
  fit.to_the_end = decision.to_the_end;
  fit.degrees_of_freedom = static_cast<std::size_t>(decision.dof());
  fit.chi2_reduced = minimum.chi2 / decision.dof();
  fit.band_limit_Hz = decision.likelihood->band_limit_Hz();
  fit.judged_s = decision.likelihood->judged_s();
  fill_numbers(*decision.likelihood, minimum, fit);
  fill_spectrum(*decision.likelihood, minimum, fit);
  warn(fit);
  return fit;
}

}  // namespace kolsky
