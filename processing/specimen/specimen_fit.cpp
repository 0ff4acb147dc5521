#include "processing/specimen/specimen_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "processing/base/error.hpp"
#include "processing/reduction/formatted.hpp"
#include "processing/specimen/fit_warnings.hpp"
#include "processing/specimen/specimen_search.hpp"

namespace kolsky {

namespace {

/// A set of assumptions replaces a simpler one when it takes this much more off chi2: odds of 150
/// to 1.
constexpr double kWorthwhile = 10.0;
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
  TheoryChoice(SpecimenLikelihood& likelihood, const SpecimenFitOptions& options)
      : likelihood_(likelihood),
        options_(options),
        kinds_(kinds_of_waves(options, *likelihood.bench().specimen)) {}

  Fitted choose() {
    start_ = SpecimenSearch(likelihood_, options_.solid, {WaveTheory::elementary, kinds_.front()})
                 .start();
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

  [[nodiscard]] std::vector<TriedTheory> tried() const {
    std::vector<TriedTheory> list;
    for (const Fitted& fit : fits_) {
      list.push_back({fit.theory, fit.minimum.chi2});
    }
    return list;
  }

 private:
  void attempt(const ShpbTheory& theory) {
    try {
      fits_.push_back(
          {theory, SpecimenSearch(likelihood_, options_.solid, theory).minimise(start_)});
      if (fits_.size() == 1 || best().theory == theory) {
        start_ = fits_.back().minimum.parameters;
      }
    } catch (const InputError& error) {
      // One set of assumptions may fail to converge while another describes the data.
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
  std::vector<SpecimenWaves> kinds_;
  std::vector<double> start_;
  std::vector<Fitted> fits_;
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

void fill_numbers(const SpecimenLikelihood& likelihood, const SpecimenMinimum& minimum,
                  SpecimenFit& fit) {
  const auto& family = parameters_of(fit.solid);
  const std::vector<double> values = moduli(minimum);
  const double widened = std::max(1.0, fit.chi2_reduced);
  fit.covariance.assign(family.size(), std::vector<double>(family.size()));
  for (std::size_t i = 0; i < family.size(); ++i) {
    for (std::size_t j = 0; j < family.size(); ++j) {
      fit.covariance[i][j] =
          widened * values[i] * values[j] *
          minimum.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    }
    fit.parameters.push_back({family[i].name, values[i], std::sqrt(fit.covariance[i][i])});
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
  constexpr double kPoor = 1.5;
  fit.warnings = warnings_of(fit.parameters);
  if (fit.chi2_reduced > kPoor) {
    fit.warnings.push_back(
        formatted("the model leaves more than noise (chi2 per degree of freedom %.3g): the "
                  "deviations are widened accordingly",
                  fit.chi2_reduced));
  }
  for (std::string& warning : warnings_of(fit.spectrum)) {
    fit.warnings.push_back(std::move(warning));
  }
}

}  // namespace

SpecimenFit fit_specimen(const std::vector<Shot>& shots, const BarPrior& bars,
                         const SpecimenFitOptions& options) {
  if (shots.empty()) {
    throw InputError("captures", "are none", "give at least one shot on the specimen");
  }
  SpecimenWindow window{options.band_limit_Hz, options.after_foot_s.value_or(0.0)};
  const bool may_extend = !options.after_foot_s;
  auto longest = std::make_unique<SpecimenLikelihood>(shots, bars, window);
  if (options.most_band_Hz && longest->band_limit_Hz() > *options.most_band_Hz) {
    window.band_limit_Hz = *options.most_band_Hz;
    longest = std::make_unique<SpecimenLikelihood>(shots, bars, window);
  }
  std::unique_ptr<SpecimenLikelihood> beginning;
  if (may_extend) {
    window.after_foot_s = longest->first_return_s();
    window.band_limit_Hz = longest->band_limit_Hz();
    beginning = std::make_unique<SpecimenLikelihood>(shots, bars, window);
  }
  SpecimenLikelihood* likelihood = beginning ? beginning.get() : longest.get();
  TheoryChoice choice(*likelihood, options);
  Fitted fitted = choice.choose();
  double dof = degrees_of_freedom(*likelihood, options.solid);

  SpecimenFit fit;
  fit.tried = choice.tried();
  if (longest->judged_s() > likelihood->judged_s()) {
    const double longer_dof = degrees_of_freedom(*longest, options.solid);
    const SpecimenMinimum longer =
        SpecimenSearch(*longest, options.solid, fitted.theory).minimise(fitted.minimum.parameters);
    if (same_model(fitted.minimum.chi2, dof, longer.chi2, longer_dof)) {
      fitted.minimum = longer;
      likelihood = longest.get();
      dof = longer_dof;
      fit.to_the_end = true;
    }
  }
  fit.solid = options.solid;
  fit.theory = fitted.theory;
  fit.degrees_of_freedom = static_cast<std::size_t>(dof);
  fit.chi2_reduced = fitted.minimum.chi2 / dof;
  fit.band_limit_Hz = likelihood->band_limit_Hz();
  fit.judged_s = likelihood->judged_s();
  fill_numbers(*likelihood, fitted.minimum, fit);
  fill_spectrum(*likelihood, fitted.minimum, fit);
  warn(fit);
  return fit;
}

}  // namespace kolsky
