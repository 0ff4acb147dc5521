#include "processing/identification/bar_fit.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "processing/algebra/algebra.hpp"
#include "processing/base/error.hpp"
#include "processing/identification/bar_likelihood.hpp"

namespace kolsky {

namespace {

constexpr double kPriorOfLogs = 5.0;
constexpr double kTypicalTime_s = 50e-6;  // of a glassy polymer's retardation
/// E2 over E1 of a bar that counts as elastic, and how tightly that is held.
constexpr double kUnseen = 1e6;
constexpr double kHeld = 1e-3;
constexpr double kPriorOfReflection = 2.0;
constexpr int kMostSteps = 60;
/// A step is not worth taking when it gains less in chi2: a hundredth of a standard deviation.
constexpr double kNegligibleGain = 1e-4;
/// Of a search whose end is only where another one begins: a third of a deviation of one shot.
constexpr double kNearEnough = 0.1;
/// Nor does it matter that a step foretold to gain less than this does not: the gradient leaves out
/// what the parameters do to the weights in second order.
constexpr double kDoubtfulGain = 1e-2;
constexpr double kLongestLogStep = 1.0;

struct Prior {
  Eigen::VectorXd centre;
  Eigen::VectorXd weight;  ///< 1 / variance

  [[nodiscard]] double chi2(const Eigen::VectorXd& at) const {
    return ((at - centre).array().square() * weight.array()).sum();
  }
};

Prior prior_of(const BarData& data, const BarModel& model) {
  const auto size = static_cast<Eigen::Index>(model.parameters());
  Prior prior{Eigen::VectorXd::Zero(size), Eigen::VectorXd::Ones(size)};
  const std::vector<double> guess = first_guess(data, model.theory().solid);
  for (std::size_t m = 0; m < guess.size(); ++m) {
    prior.centre[static_cast<Eigen::Index>(m)] = guess[m];
    prior.weight[static_cast<Eigen::Index>(m)] = 1.0 / (kPriorOfLogs * kPriorOfLogs);
  }
  if (model.theory().lossless) {
    prior.centre[1] = prior.centre[0] + std::log(kUnseen);
    prior.centre[2] = prior.centre[1] + std::log(kTypicalTime_s);
    prior.weight[1] = prior.weight[2] = 1.0 / (kHeld * kHeld);
  }
  if (const auto at = model.reflection_at()) {
    prior.centre[static_cast<Eigen::Index>(*at)] = -1.0;
    prior.weight[static_cast<Eigen::Index>(*at)] = 1.0 / (kPriorOfReflection * kPriorOfReflection);
  }
  return prior;
}

/// A place in the parameters with what the data say there.
struct Place {
  Eigen::VectorXd at;
  std::vector<ShotTerms> shots;
  double objective = 0.0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd information;
};

double objective_at(BarLikelihood& likelihood, const Prior& prior, const Eigen::VectorXd& at,
                    BarLikelihood::Shots shots) {
  return likelihood.chi2_at({at.data(), static_cast<std::size_t>(at.size())}, shots) +
         prior.chi2(at);
}

/// The place whose objective was asked for last.
Place place_at(BarLikelihood& likelihood, const Prior& prior, const Eigen::VectorXd& at,
               double objective) {
  Place place{at, likelihood.terms(), objective, prior.weight.cwiseProduct(at - prior.centre),
              prior.weight.asDiagonal()};
  for (const ShotTerms& shot : place.shots) {
    place.gradient += shot.gradient;
    place.information += shot.information;
  }
  return place;
}

Eigen::VectorXd step_from(const Place& place, double damping, std::size_t logs) {
  Eigen::MatrixXd damped = place.information;
  damped.diagonal() *= 1.0 + damping;
  Eigen::VectorXd step = -solve_symmetric(damped, place.gradient);
  const double longest = step.head(static_cast<Eigen::Index>(logs)).cwiseAbs().maxCoeff();
  if (longest > kLongestLogStep) {
    step *= kLongestLogStep / longest;
  }
  return step;
}

InputError not_converged() {
  return {"fit", "does not converge",
          "try another family of solids, another --dispersion or a narrower band"};
}

/// Levenberg's and Marquardt's search, undamped as long as it goes downhill.
Place minimise(BarLikelihood& likelihood, const Prior& prior, const Eigen::VectorXd& start,
               BarLikelihood::Shots shots, double negligible_gain) {
  const std::size_t logs = likelihood.model().solid_parameters();
  const double judged =
      static_cast<double>(likelihood.residuals()) /
      (shots == BarLikelihood::Shots::each ? 1.0 : static_cast<double>(likelihood.data().shots()));
  Place place =
      place_at(likelihood, prior, start, objective_at(likelihood, prior, start, shots));
  double damping = 0.0;
  for (int i = 0; i < kMostSteps; ++i) {
    const Eigen::VectorXd step = step_from(place, damping, logs);
    if (!step.allFinite() || !std::isfinite(place.objective)) {
      throw not_converged();
    }
    const double gain = -place.gradient.dot(step);
    // Where the model leaves more than noise, deviations are that much wider.
    const double widened = std::max(1.0, place.objective / judged);
    if (gain < negligible_gain * widened) {
      return place;
    }
    const Eigen::VectorXd next = place.at + step;
    const double objective = objective_at(likelihood, prior, next, shots);
    if (objective < place.objective + 1e-9 * std::abs(place.objective)) {
      place = place_at(likelihood, prior, next, objective);
      damping = damping > 1e-6 ? damping / 10.0 : 0.0;
    } else if (gain < kDoubtfulGain * widened) {
      return place;
    } else {
      damping = std::max(1e-3, damping * 10.0);
    }
  }
  throw not_converged();
}

std::vector<std::vector<double>> rows_of(const Eigen::MatrixXd& matrix) {
  std::vector<std::vector<double>> rows(static_cast<std::size_t>(matrix.rows()));
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
      rows[static_cast<std::size_t>(i)].push_back(matrix(i, j));
    }
  }
  return rows;
}

std::vector<FittedNumber> numbers_of(SolidKind kind, const Eigen::VectorXd& logs,
                                     const Eigen::MatrixXd& covariance) {
  std::vector<FittedNumber> numbers;
  const auto& family = parameters_of(kind);
  for (std::size_t m = 0; m < family.size(); ++m) {
    const auto i = static_cast<Eigen::Index>(m);
    const double value = std::exp(logs[i]);
    numbers.push_back({family[m].name, value, value * std::sqrt(covariance(i, i))});
  }
  return numbers;
}

/// The solid's parameters as one shot has them, the others held: one step from the common place.
ShotEstimate estimate_of(const ShotTerms& shot, const Place& common, const Prior& prior,
                         const BarLikelihood& likelihood) {
  const auto n = static_cast<Eigen::Index>(likelihood.model().solid_parameters());
  const Eigen::MatrixXd prior_information = prior.weight.head(n).asDiagonal();
  const Eigen::MatrixXd covariance =
      inverse_of(shot.information.topLeftCorner(n, n) + prior_information);
  const Eigen::VectorXd own_step = -covariance * shot.gradient.head(n);
  const auto judged =
      static_cast<double>(likelihood.residuals()) / static_cast<double>(likelihood.data().shots());
  ShotEstimate estimate;
  estimate.parameters =
      numbers_of(likelihood.model().theory().solid, common.at.head(n) + own_step, covariance);
  estimate.chi2_reduced = shot.chi2 / judged;
  return estimate;
}

BarFit describe(const BarLikelihood& likelihood, const Prior& prior, const Place& place) {
  const BarModel& model = likelihood.model();
  const std::size_t solid = model.solid_parameters();
  BarFit fit;
  fit.solid = model.theory().solid;
  fit.theory = model.theory().waves;
  fit.far_end = model.theory().far_end;
  fit.lossless = model.theory().lossless;
  fit.band_limit_Hz = likelihood.data().band_limit_Hz();
  fit.degrees_of_freedom = likelihood.residuals() - model.first_unknown();
  double chi2 = 0.0;
  for (const ShotTerms& shot : place.shots) {
    chi2 += shot.chi2;
    fit.shots.push_back(estimate_of(shot, place, prior, likelihood));
  }
  fit.chi2_reduced = chi2 / static_cast<double>(fit.degrees_of_freedom);
  fit.log_evidence =
      -0.5 * (place.objective + static_cast<double>(model.first_unknown()) *
                                    std::log(static_cast<double>(likelihood.residuals())));
  const Eigen::MatrixXd posterior = inverse_of(place.information) * std::max(1.0, fit.chi2_reduced);
  fit.at.assign(place.at.data(), place.at.data() + place.at.size());
  fit.posterior = rows_of(posterior);
  fit.parameters = numbers_of(model.theory().solid, place.at, posterior);
  fit.covariance.assign(solid, std::vector<double>(solid));
  for (std::size_t i = 0; i < solid; ++i) {
    for (std::size_t j = 0; j < solid; ++j) {
      fit.covariance[i][j] =
          fit.posterior[i][j] * fit.parameters[i].value * fit.parameters[j].value;
    }
  }
  if (const auto at = model.reflection_at()) {
    fit.reflection = {"reflection", fit.at[*at], std::sqrt(fit.posterior[*at][*at])};
  }
  for (std::size_t i = 0; i < model.unknowns().size(); ++i) {
    const KnownUnknown& unknown = model.unknowns()[i];
    const std::size_t at = model.first_unknown() + i;
    fit.bench.push_back(
        {unknown.name, fit.at[at] * unknown.sd, std::sqrt(fit.posterior[at][at]) * unknown.sd});
  }
  return fit;
}

BarFit search(BarData& data, const BarTheory& theory, const std::vector<double>& start) {
  BarLikelihood likelihood(data, BarModel(data.bench(), data.records().front(), theory));
  const Prior prior = prior_of(data, likelihood.model());
  Eigen::VectorXd at = prior.centre;
  if (!start.empty()) {
    at = Eigen::Map<const Eigen::VectorXd>(start.data(), static_cast<Eigen::Index>(start.size()));
  }
  const auto weigh = [&](bool exact) {
    likelihood.weigh({at.data(), static_cast<std::size_t>(at.size())}, exact);
  };
  const auto find = [&](BarLikelihood::Shots shots, double negligible_gain) {
    return minimise(likelihood, prior, at, shots, negligible_gain);
  };
  // Most of the way at the price of one shot; weights turn with the waves' phases, so that those of
  // where it began do not do for where it ends.
  for (int round = 0; round < 2; ++round) {
    weigh(false);
    at = find(BarLikelihood::Shots::as_one, kNearEnough).at;
  }
  weigh(true);
  at = find(BarLikelihood::Shots::as_one, kNegligibleGain).at;
  return describe(likelihood, prior, find(BarLikelihood::Shots::each, kNegligibleGain));
}

}  // namespace

std::vector<double> values_of(const std::vector<FittedNumber>& numbers) {
  std::vector<double> values;
  for (const FittedNumber& number : numbers) {
    values.push_back(number.value);
  }
  return values;
}

std::vector<double> first_guess(const BarData& data, SolidKind solid) {
  constexpr double kLeastTangent = 1e-4;
  constexpr double kMostTangent = 0.3;
  constexpr double kTypicalFrequency_Hz = 5e3;
  const BarRecords& records = data.records().front();
  const double span_m = records.position_m.back() - records.position_m.front();
  const double time_s = records.rise_s.back() - records.rise_s.front();
  if (time_s <= 0.0) {
    throw InputError("gauges", "see the pulse in another order than they lie along the bar",
                     "give positions from the impacted end, gauges in the order of the channels, "
                     "and records that begin before the pulse passes the first");
  }
  const double speed = span_m / time_s;
  const double E1 = data.bench().input.density_kg_m3 * speed * speed;
  const double decay_per_m = std::log(records.peak.front() / records.peak.back()) / span_m;
  const double wavenumber = 2.0 * std::numbers::pi * kTypicalFrequency_Hz / speed;
  const double tangent = std::clamp(2.0 * decay_per_m / wavenumber, kLeastTangent, kMostTangent);
  const double E2 = E1 / (2.0 * tangent);
  const double eta2 = E2 * kTypicalTime_s;
  std::vector<double> guess;
  switch (solid) {
    case SolidKind::three_element:
      guess = {E1, E2, eta2};
      break;
    case SolidKind::four_element_fluid:
      guess = {E1, 100.0 * eta2, E2, eta2};
      break;
    case SolidKind::two_kelvin:
      guess = {E1, 2.0 * E2, eta2, 2.0 * E2, 10.0 * eta2};
      break;
    case SolidKind::fractional:
      guess = {E1, E2, eta2, 0.9};
      break;
  }
  std::transform(guess.begin(), guess.end(), guess.begin(), [](double x) { return std::log(x); });
  return guess;
}

BarFit fit_bar(BarData& data, const BarTheory& theory, const std::vector<double>& start) {
  try {
    return search(data, theory, start);
  } catch (const InputError&) {
    if (theory.solid != SolidKind::three_element || theory.lossless) {
      throw;
    }
  }
  BarTheory elastic = theory;
  elastic.lossless = true;
  return search(data, theory, search(data, elastic, {}).at);
}

BarData bar_data(const std::vector<Shot>& shots, double band_limit_Hz, WaveTheory theory) {
  constexpr int kMostRounds = 8;
  constexpr double kSettled = 0.1;  // of a deviation
  constexpr double kSeen = 0.3;
  BarData data(shots, band_limit_Hz);
  std::vector<FittedNumber> before;
  const auto moved = [&](const std::vector<FittedNumber>& now) {
    for (std::size_t i = 0; i < before.size(); ++i) {
      if (std::abs(now[i].value - before[i].value) > kSettled * now[i].sd) {
        return true;
      }
    }
    return before.empty();
  };
  int rounds = 0;
  for (bool settled = !data.two_passes(); !settled;) {
    // What the far end returns is not known yet, and would else be taken for loss.
    const std::vector<FittedNumber> found =
        fit_bar(data, {.waves = theory, .far_end = FarEndReturn::partial}).parameters;
    settled = ++rounds == kMostRounds || !moved(found);
    // A loss that does not stand out of the noise would make up a tail of its own.
    const bool lossy = found[1].sd < kSeen * found[1].value;
    const auto solid = make_solid(SolidKind::three_element, values_of(found));
    const ElasticSolid elastic(found[0].value);
    data =
        BarData(shots, band_limit_Hz, {.solid = lossy ? solid.get() : &elastic, .judged = settled});
    before = found;
  }
  return data;
}

BarFit fit_bar(const std::vector<Shot>& shots, const BarFitOptions& options) {
  if (shots.empty()) {
    throw InputError("captures", "are none", "give at least one shot on the bar");
  }
  BarData data = bar_data(shots, options.band_limit_Hz, options.theory);
  return fit_bar(data, {options.theory, options.solid, options.far_end});
}

}  // namespace kolsky
