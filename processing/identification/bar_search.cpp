#include "processing/identification/bar_search.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "processing/algebra/algebra.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

constexpr double kPriorOfLogs = 5.0;
/// E2 over E1 of a bar that counts as elastic, and how tightly that is held.
constexpr double kUnseen = 1e6;
constexpr double kHeld = 1e-3;
constexpr double kPriorOfReflection = 2.0;
constexpr int kMostSteps = 100;
/// A step is not worth taking when it gains less in chi2: a hundredth of a standard deviation.
constexpr double kNegligibleGain = 1e-4;
/// Of a search whose end is only where another one begins, or compared with others: a third of a
/// deviation, a twentieth of what odds are counted in.
constexpr double kNearEnough = 0.1;
/// Nor does it matter that a step foretold to gain less than this does not: the gradient leaves out
/// what the parameters do to the weights in second order. Damped steps that gain less go along a
/// valley that the data leave open.
constexpr double kDoubtfulGain = 1e-2;
constexpr double kLongestLogStep = 1.0;

ParameterPrior prior_of(const BarData& data, const BarModel& model) {
  const auto size = static_cast<Eigen::Index>(model.parameters());
  ParameterPrior prior{Eigen::VectorXd::Zero(size), Eigen::VectorXd::Ones(size)};
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

Eigen::VectorXd step_from(const BarPlace& place, double damping, std::size_t logs) {
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
ShotEstimate estimate_of(const ShotTerms& shot, const BarPlace& common, const ParameterPrior& prior,
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

/// Of how many shots, those that tell most first, the gradient's scatter must be known well.
std::size_t count_that_matters(const std::vector<ShotTerms>& shots,
                               const Eigen::MatrixXd& posterior) {
  constexpr double kOfInformation = 0.95;
  std::vector<double> told;
  double all = 0.0;
  for (const ShotTerms& shot : shots) {
    told.push_back(posterior.cwiseProduct(shot.information).sum());
    all += told.back();
  }
  double sum = 0.0;
  std::size_t count = 0;
  while (count < told.size() && sum < kOfInformation * all) {
    sum += told[count++];
  }
  return count;
}

}  // namespace

BarSearch::BarSearch(const BarData& data, const BarTheory& theory)
    : likelihood_(data, BarModel(data.bench(), data.records().front(), theory)),
      prior_(prior_of(data, likelihood_.model())) {}

std::vector<double> BarSearch::at() const {
  return {place_.at.data(), place_.at.data() + place_.at.size()};
}

double BarSearch::objective_at(const Eigen::VectorXd& at, BarLikelihood::Shots shots) {
  return likelihood_.chi2_at({at.data(), static_cast<std::size_t>(at.size())}, shots) +
         prior_.chi2(at);
}

/// @param objective  which must have been asked for last
BarPlace BarSearch::looked_at(const Eigen::VectorXd& at, double objective) {
  BarPlace place{at, likelihood_.terms(), objective, prior_.weight.cwiseProduct(at - prior_.centre),
                 prior_.weight.asDiagonal()};
  for (const ShotTerms& shot : place.shots) {
    place.gradient += shot.gradient;
    place.information += shot.information;
  }
  return place;
}

/// Levenberg's and Marquardt's search, undamped as long as it goes downhill.
bool BarSearch::minimise(BarLikelihood::Shots shots, double negligible_gain, double hopeless) {
  // A foretold gain is of the same size as what a step gains, but far from the end.
  constexpr double kForetold = 10.0;
  const std::size_t logs = likelihood_.model().solid_parameters();
  const double judged = static_cast<double>(likelihood_.residuals() * likelihood_.count_of(shots)) /
                        static_cast<double>(likelihood_.data().shots());
  place_ = looked_at(place_.at, objective_at(place_.at, shots));
  double damping = 0.0;
  for (int i = 0; i < kMostSteps; ++i) {
    const Eigen::VectorXd step = step_from(place_, damping, logs);
    if (!step.allFinite() || !std::isfinite(place_.objective)) {
      throw not_converged();
    }
    const double gain = -place_.gradient.dot(step);
    // Where the model leaves more than noise, deviations are that much wider.
    const double widened = std::max(1.0, place_.objective / judged);
    if (gain < negligible_gain * widened) {
      return true;
    }
    if (damping == 0.0 && place_.objective - kForetold * gain > hopeless) {
      return false;
    }
    const Eigen::VectorXd next = place_.at + step;
    const double objective = objective_at(next, shots);
    if (objective < place_.objective + 1e-9 * std::abs(place_.objective)) {
      const bool in_a_valley =
          damping > 0.0 && place_.objective - objective < kDoubtfulGain * widened;
      place_ = looked_at(next, objective);
      if (in_a_valley) {
        return true;
      }
      damping = damping > 1e-6 ? damping / 10.0 : 0.0;
    } else if (gain < kDoubtfulGain * widened) {
      return true;
    } else {
      damping = std::max(1e-3, damping * 10.0);
    }
  }
  throw not_converged();
}

void BarSearch::go_to(const std::vector<double>& at) {
  place_.at = Eigen::Map<const Eigen::VectorXd>(at.data(), static_cast<Eigen::Index>(at.size()));
}

void BarSearch::roughly(const std::vector<double>& start, double hopeless) {
  place_.at = prior_.centre;
  if (!start.empty()) {
    go_to(start);
  }
  for (int round = 0; round < 2; ++round) {
    const Eigen::VectorXd before = place_.at;
    likelihood_.use(likelihood_.weights_at(at(), false));
    if (!minimise(BarLikelihood::Shots::as_one, kNearEnough, hopeless) || place_.at == before) {
      return;  // as the other round would
    }
  }
}

void BarSearch::closely() {
  closely(at(), likelihood_.weights_at(at(), true));
}

void BarSearch::closely(const std::vector<double>& start, const BarLikelihood::Weights& weights) {
  go_to(start);
  likelihood_.use(weights);
  minimise(BarLikelihood::Shots::as_one, kNearEnough);
}

BarFit BarSearch::so_far() {
  return describe(objective_at(place_.at, BarLikelihood::Shots::each));
}

/// Not on every shot by itself: what combinations that hold noise alone add to the gradient is its
/// square, which no weights make vanish on average where they leave anything out.
void BarSearch::to_the_end() {
  minimise(BarLikelihood::Shots::as_one, kNegligibleGain);
  if (likelihood_.count_of(BarLikelihood::Shots::telling) > 1) {
    minimise(BarLikelihood::Shots::telling, kNegligibleGain);
  }
  if (rings_with_a_loss_that_shows()) {
    take_off_what_noise_adds();
  }
}

/// Of a loss that is not seen, the step that takes off noise would have no end.
bool BarSearch::rings_with_a_loss_that_shows() {
  constexpr double kRings = 0.7;
  const auto logs = static_cast<Eigen::Index>(likelihood_.model().solid_parameters());
  const Eigen::MatrixXd posterior = inverse_of(place_.information);
  const double widest_log = std::sqrt(posterior.diagonal().head(logs).maxCoeff());
  return !likelihood_.model().theory().lossless && widest_log <= kWidestLogOfALoss &&
         likelihood_.left_of_a_return(at()) > kRings;
}

/// Where waves ring in a bar, bins above the lowest are tied as the weights do not know, and noise
/// by itself pulls: of bars that hardly lose anything eta2 came out two deviations low.
void BarSearch::take_off_what_noise_adds() {
  using Shots = BarLikelihood::Shots;
  const auto looked_at_shots = static_cast<double>(likelihood_.count_of(Shots::telling));
  const Eigen::VectorXd by_noise = looked_at_shots * likelihood_.gradient_of_noise_alone(at());
  const Eigen::VectorXd next = place_.at + inverse_of(place_.information) * by_noise;
  place_ = looked_at(next, objective_at(next, Shots::telling));
}

/// Evidence and chi2 stay those of the noise that the quiet samples show: all theories are compared
/// by that, and what a model lacks must not pass for noise.
BarFit BarSearch::finished() {
  to_the_end();
  const double by_quiet = objective_at(place_.at, BarLikelihood::Shots::each);
  const BarFit compared = describe(by_quiet);
  const auto noise = likelihood_.noise_by_residuals();
  if (!noise) {
    return described_with_shots();
  }
  const BarLikelihood::Weights weights = likelihood_.weights();
  likelihood_.use(likelihood_.weights_at(at(), true, *noise));
  to_the_end();
  BarFit fit = described_with_shots();
  fit.chi2_reduced = compared.chi2_reduced;
  fit.log_evidence = compared.log_evidence;
  likelihood_.use(weights);
  return fit;
}

/// How bins are tied costs as much as a fit and is looked at only where a model seems not to fit.
std::vector<OctaveLeft> BarSearch::left_over() {
  std::vector<OctaveLeft> left = likelihood_.left_over();
  for (std::size_t i = 0; i < left.size(); ++i) {
    if (beyond_chance(left[i], likelihood_.data().shots())) {
      left[i].count_as = std::min(left[i].count_as, likelihood_.independent_numbers(i));
    }
  }
  return left;
}

/// From where a search to the end has come to. Deviations are those of the estimate,
/// (information)^-1 scatter (information)^-1: weights that leave out what ties bins cost it little,
/// but would have it state too small ones. What is left beyond noise widens them as noise of that
/// power would; where the model does not fit, by what the shots have in common, which is all that a
/// fit goes by: over many shots the noise that they do not share would hide it.
BarFit BarSearch::described_with_shots() {
  const double objective = objective_at(place_.at, BarLikelihood::Shots::each);
  const std::vector<ShotTerms> shots = likelihood_.terms();
  const std::vector<OctaveLeft> left = left_over();
  const auto misfit = common_misfit(left, likelihood_.data().shots());
  double squares = 0.0;
  double numbers = 0.0;
  std::vector<double> power;
  for (const OctaveLeft& octave : left) {
    power.push_back(misfit ? std::max(octave.of_all, octave.in_common) : octave.of_all);
    squares += octave.numbers * power.back();
    numbers += octave.numbers;
  }
  const double everywhere = std::max(1.0, squares / numbers);
  for (double& beyond : power) {
    beyond = std::max(0.0, beyond - everywhere);
  }
  (void)objective_at(place_.at, BarLikelihood::Shots::telling);
  const Eigen::MatrixXd inverse = inverse_of(place_.information);
  BarLikelihood::Scatter scatter =
      likelihood_.scatter_of_gradient(count_that_matters(place_.shots, inverse), power);
  scatter.by_noise.diagonal() += prior_.weight;
  BarFit fit =
      describe(objective, inverse * (everywhere * scatter.by_noise + scatter.beyond) * inverse);
  fit.misfit = misfit;
  for (const ShotTerms& shot : shots) {
    fit.shots.push_back(estimate_of(shot, place_, prior_, likelihood_));
  }
  return fit;
}

/// @param objective  of every shot by itself
BarFit BarSearch::describe(double objective) const {
  return describe(objective,
                  inverse_of(place_.information) * std::max(1.0, chi2_reduced(objective)));
}

double BarSearch::chi2_reduced(double objective) const {
  return (objective - prior_.chi2(place_.at)) /
         static_cast<double>(likelihood_.residuals() - likelihood_.model().first_unknown());
}

BarFit BarSearch::describe(double objective, const Eigen::MatrixXd& posterior) const {
  const BarModel& model = likelihood_.model();
  const std::size_t solid = model.solid_parameters();
  BarFit fit;
  fit.solid = model.theory().solid;
  fit.theory = model.theory().waves;
  fit.far_end = model.theory().far_end;
  fit.lossless = model.theory().lossless;
  fit.band_limit_Hz = likelihood_.data().band_limit_Hz();
  fit.degrees_of_freedom = likelihood_.residuals() - model.first_unknown();
  fit.chi2_reduced = chi2_reduced(objective);
  fit.log_evidence =
      -0.5 * (objective + static_cast<double>(model.first_unknown()) *
                              std::log(static_cast<double>(likelihood_.residuals())));
  const Eigen::MatrixXd inverse = inverse_of(place_.information);
  fit.at.assign(place_.at.data(), place_.at.data() + place_.at.size());
  fit.posterior = rows_of(posterior);
  fit.parameters = numbers_of(model.theory().solid, place_.at, posterior);
  fit.covariance.assign(solid, std::vector<double>(solid));
  fit.by_bench.resize(solid);
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
    for (std::size_t p = 0; p < solid; ++p) {
      fit.by_bench[p].push_back(fit.parameters[p].value * inverse(static_cast<Eigen::Index>(p),
                                                                  static_cast<Eigen::Index>(at)));
    }
  }
  return fit;
}

std::unique_ptr<BarSearch> rough_search(const BarData& data, const BarTheory& theory,
                                        const std::vector<double>& start, double hopeless) {
  auto search = std::make_unique<BarSearch>(data, theory);
  try {
    search->roughly(start, hopeless);
  } catch (const InputError&) {
    if (!may_be_elastic(theory)) {
      throw;
    }
    return search_from_elastic(data, theory);
  }
  return search;
}

bool may_be_elastic(const BarTheory& theory) {
  return theory.solid == SolidKind::three_element && !theory.lossless;
}

std::vector<double> elastic_start(std::vector<double> at, double E_Pa) {
  at[0] = std::log(E_Pa);
  at[1] = at[0] + std::log(kUnseen);
  at[2] = at[1] + std::log(kTypicalTime_s);
  return at;
}

std::unique_ptr<BarSearch> search_from_elastic(const BarData& data, const BarTheory& theory) {
  BarTheory elastic_theory = theory;
  elastic_theory.lossless = true;
  BarSearch elastic(data, elastic_theory);
  elastic.roughly({});
  auto search = std::make_unique<BarSearch>(data, theory);
  search->roughly(elastic.at());
  return search;
}

}  // namespace kolsky
