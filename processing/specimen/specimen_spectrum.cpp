#include "processing/specimen/specimen_spectrum.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "processing/algebra/algebra.hpp"
#include "processing/base/error.hpp"
#include "processing/reduction/reducer.hpp"
#include "processing/specimen/fit_warnings.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

namespace {

constexpr double kDamping = 1e-3;  // over the histories
constexpr std::size_t kEnoughShots = 3;
constexpr Eigen::Index kParameters = 3;

/// Strain and stress of one shot along the damped line.
struct ShotSpectra {
  std::vector<Complex> strain;
  std::vector<Complex> stress;
};

/// The points that a solid is put through.
struct Points {
  std::vector<Complex> s;
  std::vector<Complex> J;
  std::vector<double> weight;  ///< one over the deviation, up to a factor
};

std::vector<Reduction> reduce_all(const std::vector<Shot>& shots, const Material& bars,
                                  WaveTheory theory, Separation separation) {
  ReductionOptions options;
  options.bar_model = bars;
  options.theory = theory;
  options.separation = separation;
  Reducer reducer(options);
  std::vector<Reduction> reductions;
  for (const Shot& shot : shots) {
    reductions.push_back(reducer.reduce(shot));
    if (!reductions.back().quality.reducible) {
      throw InputError("capture " + shot.id, reductions.back().quality.reason,
                       "repeat the shot, or leave this capture out");
    }
  }
  return reductions;
}

/// Whether the striker still pushed when the specimen's answer hid it at the gauge.
bool overlap(const std::vector<Reduction>& reductions) {
  return std::any_of(reductions.begin(), reductions.end(), [](const Reduction& reduction) {
    const Check* check = reduction.quality.find("window_overlap");
    return check != nullptr && check->verdict != Verdict::pass;
  });
}

/// As each shot needs it; by equilibrium where time does not part the waves of one.
std::vector<Reduction> reduce_apart(const std::vector<Shot>& shots, const Material& bars,
                                    WaveTheory theory) {
  auto reductions = reduce_all(shots, bars, theory, Separation::as_needed);
  return overlap(reductions) ? reduce_all(shots, bars, theory, Separation::equilibrium)
                             : std::move(reductions);
}

/// Sums over shots: the ratio is then weighed by how hard each shot drove a frequency.
Points mean_over(const std::vector<ShotSpectra>& shots, const std::vector<Complex>& s,
                 std::size_t left_out) {
  Points points;
  points.s = s;
  for (std::size_t k = 0; k < s.size(); ++k) {
    Complex cross = 0.0;
    double power = 0.0;
    for (std::size_t i = 0; i < shots.size(); ++i) {
      if (i != left_out) {
        cross += shots[i].strain[k] * std::conj(shots[i].stress[k]);
        power += std::norm(shots[i].stress[k]);
      }
    }
    points.J.push_back(cross / power);
    points.weight.push_back(std::sqrt(power));
  }
  return points;
}

Eigen::VectorXd misfit(const Points& points, const Eigen::VectorXd& x) {
  const ThreeElementSolid solid(std::exp(x[0]), std::exp(x[1]), std::exp(x[2]));
  Eigen::VectorXd r(2 * static_cast<Eigen::Index>(points.s.size()));
  for (std::size_t k = 0; k < points.s.size(); ++k) {
    const Complex left = points.weight[k] * (points.J[k] - solid.at(points.s[k]));
    r[static_cast<Eigen::Index>(2 * k)] = left.real();
    r[static_cast<Eigen::Index>(2 * k + 1)] = left.imag();
  }
  return r;
}

struct SolidFit {
  Eigen::VectorXd x;  ///< logarithms
  Eigen::MatrixXd covariance;
};

Eigen::MatrixXd slopes(const Points& points, const Eigen::VectorXd& x) {
  constexpr double kStep = 1e-4;
  Eigen::MatrixXd J(2 * static_cast<Eigen::Index>(points.s.size()), kParameters);
  for (Eigen::Index i = 0; i < kParameters; ++i) {
    Eigen::VectorXd moved = x;
    moved[i] += kStep;
    J.col(i) = misfit(points, moved);
    moved[i] -= 2.0 * kStep;
    J.col(i) = (J.col(i) - misfit(points, moved)) / (2.0 * kStep);
  }
  return J;
}

SolidFit fit_solid(const Points& points) {
  const double J0 = std::abs(points.J.front());
  SolidFit fit;
  double least = std::numeric_limits<double>::infinity();
  for (const double E1 : {1.2, 1.7, 3.0, 6.0}) {
    for (const double tau_s : {3e-6, 10e-6, 30e-6, 100e-6}) {
      Eigen::VectorXd x(kParameters);
      const double E2 = 1.0 / (J0 * (1.0 - 1.0 / E1));
      x << std::log(E1 / J0), std::log(E2), std::log(E2 * tau_s);
      const double sum = misfit(points, x).squaredNorm();
      if (sum < least) {
        least = sum;
        fit.x = x;
      }
    }
  }
  double damping = 1e-3;
  Eigen::VectorXd r = misfit(points, fit.x);
  for (int step = 0; step < 100 && damping < 1e10; ++step) {
    const Eigen::MatrixXd J = slopes(points, fit.x);
    Eigen::MatrixXd normal = J.transpose() * J;
    normal.diagonal() *= 1.0 + damping;
    const Eigen::VectorXd change = -solve_symmetric(normal, J.transpose() * r);
    const Eigen::VectorXd moved = fit.x + change.cwiseMax(-1.0).cwiseMin(1.0);
    const Eigen::VectorXd next = misfit(points, moved);
    if (next.squaredNorm() < r.squaredNorm()) {
      fit.x = moved;
      r = next;
      damping = std::max(damping / 10.0, 1e-12);
      if (change.cwiseAbs().maxCoeff() < 1e-9) {
        break;
      }
    } else {
      damping *= 10.0;
    }
  }
  const Eigen::MatrixXd J = slopes(points, fit.x);
  const auto dof = std::max<Eigen::Index>(1, r.size() - kParameters);
  fit.covariance = inverse_of(J.transpose() * J) * r.squaredNorm() / static_cast<double>(dof);
  return fit;
}

/// By leaving one shot out in turn.
Eigen::VectorXd jackknife_sd(const std::vector<ShotSpectra>& shots, const std::vector<Complex>& s) {
  const auto count = static_cast<double>(shots.size());
  Eigen::MatrixXd x(kParameters, static_cast<Eigen::Index>(shots.size()));
  for (std::size_t i = 0; i < shots.size(); ++i) {
    x.col(static_cast<Eigen::Index>(i)) = fit_solid(mean_over(shots, s, i)).x;
  }
  const Eigen::VectorXd mean = x.rowwise().mean();
  return ((x.colwise() - mean).rowwise().squaredNorm() * (count - 1.0) / count).cwiseSqrt();
}

}  // namespace

SpectralEstimate estimate_spectrum(const std::vector<Shot>& shots, const Material& bars,
                                   const SpectralOptions& options) {
  const auto reductions = options.separation
                              ? reduce_all(shots, bars, options.bars, *options.separation)
                              : reduce_apart(shots, bars, options.bars);
  std::size_t samples = std::numeric_limits<std::size_t>::max();
  SpectralEstimate estimate;
  estimate.band_limit_Hz = options.band_limit_Hz;
  estimate.separation = reductions.front().separation;
  for (const Reduction& reduction : reductions) {
    samples = std::min(samples, reduction.time_s.size());
    estimate.band_limit_Hz = std::min(estimate.band_limit_Hz, reduction.band_limit_Hz);
  }
  const double period_s = shots.front().rate.period_s();
  estimate.window_s = static_cast<double>(samples) * period_s;
  DampedTransform transform(samples, period_s, kDamping);
  const auto bins = static_cast<std::size_t>(estimate.band_limit_Hz / transform.bin_width_Hz());
  if (bins < 4) {
    throw InputError("samples", "hold too short a history for a spectrum within the band",
                     "give longer records");
  }
  std::vector<Complex> s;
  for (std::size_t k = 1; k <= bins; ++k) {
    s.push_back(transform.s(k));
  }
  std::vector<ShotSpectra> spectra;
  std::vector<Complex> work(transform.bins());
  for (const Reduction& reduction : reductions) {
    ShotSpectra of_shot;
    transform.forward(std::span<const double>(reduction.strain).first(samples), work);
    of_shot.strain.assign(work.begin() + 1, work.begin() + 1 + static_cast<std::ptrdiff_t>(bins));
    transform.forward(std::span<const double>(reduction.stress_Pa).first(samples), work);
    of_shot.stress.assign(work.begin() + 1, work.begin() + 1 + static_cast<std::ptrdiff_t>(bins));
    spectra.push_back(std::move(of_shot));
  }

  const Points points = mean_over(spectra, s, spectra.size());
  const SolidFit fit = fit_solid(points);
  const Eigen::VectorXd sd = spectra.size() >= kEnoughShots
                                 ? jackknife_sd(spectra, s)
                                 : fit.covariance.diagonal().cwiseSqrt().eval();
  const auto& family = parameters_of(SolidKind::three_element);
  for (std::size_t i = 0; i < family.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const double value = std::exp(fit.x[at]);
    estimate.parameters.push_back({family[i].name, value, value * sd[at]});
  }
  const ThreeElementSolid solid(std::exp(fit.x[0]), std::exp(fit.x[1]), std::exp(fit.x[2]));
  const auto count = static_cast<double>(spectra.size());
  for (std::size_t k = 0; k < bins; ++k) {
    CompliancePoint point;
    point.frequency_Hz = s[k].imag() / (2.0 * std::numbers::pi);
    const Complex to_axis = solid.at({0.0, s[k].imag()}) / solid.at(s[k]);
    const Complex mean = points.J[k] * to_axis;
    point.J1_per_Pa = mean.real();
    point.J2_per_Pa = -mean.imag();
    if (spectra.size() < 2) {
      constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
      point.J1_sd = point.J2_sd = point.J1_sd_of_mean = point.J2_sd_of_mean = kUnknown;
    } else {
      for (const ShotSpectra& of_shot : spectra) {
        const Complex off = of_shot.strain[k] / of_shot.stress[k] * to_axis - mean;
        point.J1_sd += off.real() * off.real() / (count - 1.0);
        point.J2_sd += off.imag() * off.imag() / (count - 1.0);
      }
      point.J1_sd = std::sqrt(point.J1_sd);
      point.J2_sd = std::sqrt(point.J2_sd);
      point.J1_sd_of_mean = point.J1_sd / std::sqrt(count);
      point.J2_sd_of_mean = point.J2_sd / std::sqrt(count);
    }
    estimate.spectrum.push_back(point);
  }
  estimate.warnings = warnings_of(estimate.parameters);
  for (std::string& warning : warnings_of(estimate.spectrum)) {
    estimate.warnings.push_back(std::move(warning));
  }
  if (overlap(reductions)) {
    estimate.warnings.emplace_back(
        "waves overlap in these histories (kolsky reduce names the shots): the fit to the records "
        "is not touched by that");
  }
  return estimate;
}

}  // namespace kolsky
