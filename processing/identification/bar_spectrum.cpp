#include "processing/identification/bar_spectrum.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "processing/algebra/algebra.hpp"
#include "processing/identification/bar_likelihood.hpp"
#include "processing/identification/spectrum_gathering.hpp"

namespace kolsky {

namespace {

/// What is left of a wave at the end of a damped record.
constexpr double kLeftAtEnd = 3e-5;

/// Covariance at one frequency of y_j - g_j y_0.
Eigen::MatrixXcd inverse_covariance(const Eigen::VectorXcd& g, const std::vector<double>& power) {
  Eigen::MatrixXcd covariance = power[0] * g * g.adjoint();
  for (Eigen::Index j = 0; j < g.size(); ++j) {
    covariance(j, j) += power[static_cast<std::size_t>(j) + 1];
  }
  return covariance.inverse();
}

/// What moves of the bench do to log J: square root of the known unknowns' covariance, column by
/// column, through the estimator.
std::vector<Complex> bench_causes(const std::vector<std::vector<Complex>>& g,
                                  const std::vector<std::vector<BarModel::Derivative>>& derivatives,
                                  std::size_t k, const Eigen::RowVectorXcd& estimator,
                                  const BarModel& model, const Eigen::MatrixXd& root) {
  Eigen::RowVectorXcd by_unknown = Eigen::RowVectorXcd::Zero(root.rows());
  for (std::size_t j = 0; j < g.size(); ++j) {
    for (const auto& derivative : derivatives[j]) {
      if (derivative.parameter < model.first_unknown()) {
        continue;
      }
      const Complex of_g =
          derivative.proportion ? *derivative.proportion * g[j][k] : derivative.of_g[k];
      by_unknown[static_cast<Eigen::Index>(derivative.parameter - model.first_unknown())] -=
          estimator[static_cast<Eigen::Index>(j)] * of_g;
    }
  }
  const Eigen::RowVectorXcd causes = by_unknown * root.cast<Complex>();
  return {causes.data(), causes.data() + causes.size()};
}

Eigen::MatrixXd root_of_bench_covariance(const BarFit& fit, const BarModel& model) {
  const std::size_t first = model.first_unknown();
  const auto size = static_cast<Eigen::Index>(model.unknowns().size());
  Eigen::MatrixXd covariance(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j < size; ++j) {
      covariance(i, j) =
          fit.posterior[first + static_cast<std::size_t>(i)][first + static_cast<std::size_t>(j)];
    }
  }
  if (size == 0) {
    return covariance;
  }
  const SymmetricEigen solver(covariance);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

/// d g_j / d log J, from that by the logarithm of the density: they are the same but for moves.
std::vector<std::vector<Complex>> slopes_by_log_J(const BarModel& model, const BarFit& fit,
                                                  const std::vector<Complex>& path) {
  constexpr double kStep = 1e-5;
  // All moduli of a solid in proportion change J alone, by the same factor at every frequency where
  // times stay as they are; the density does just that.
  const auto at = [&](double factor) {
    BarModel changed = model;
    changed.scale_density(factor);
    return changed.transfers(fit.at, path, false).g;
  };
  const auto above = at(std::exp(kStep));
  const auto below = at(std::exp(-kStep));
  std::vector<std::vector<Complex>> slopes(above.size());
  for (std::size_t j = 0; j < above.size(); ++j) {
    for (std::size_t k = 0; k < path.size(); ++k) {
      slopes[j].push_back((above[j][k] - below[j][k]) / (2.0 * kStep));
    }
  }
  return slopes;
}

}  // namespace

BarSpectrum likely_spectrum(const BarData& data, const BarFit& fit) {
  const BarModel model(data.bench(), data.records().front(), {fit.theory, fit.solid, fit.far_end});
  std::size_t samples = 0;
  for (const BarRecords& records : data.records()) {
    samples = std::max(samples, records.strain.front().size() - begin_of(records));
  }
  const DampedBand band =
      damped_band(data, samples, kLeftAtEnd, 1.0, [&](auto, auto) { return samples; });
  SpectrumGathering gathering(data, fit, model, band);
  const auto transfers = model.transfers(fit.at, band.path, true);
  const auto derivatives = model.derivatives(fit.at, band.path, transfers);
  const auto slopes = slopes_by_log_J(model, fit, band.path);
  const Eigen::MatrixXd root = root_of_bench_covariance(fit, model);
  const auto others = static_cast<Eigen::Index>(transfers.g.size());
  Eigen::VectorXcd g(others);
  Eigen::VectorXcd slope(others);
  Eigen::VectorXcd r(others);
  for (std::size_t k = 0; k < band.path.size(); ++k) {
    const auto power = powers_at(data, band, k);
    for (Eigen::Index j = 0; j < others; ++j) {
      g[j] = transfers.g[static_cast<std::size_t>(j)][k];
      slope[j] = slopes[static_cast<std::size_t>(j)][k];
    }
    const Eigen::MatrixXcd weight = inverse_covariance(g, power);
    const double information = (slope.adjoint() * weight * slope)(0, 0).real();
    const Eigen::RowVectorXcd estimator = slope.adjoint() * weight / information;
    gathering.add_bench(k, bench_causes(transfers.g, derivatives, k, estimator, model, root));
    for (std::size_t shot = 0; shot < data.shots(); ++shot) {
      const auto& spectra = band.spectra[shot];
      const Complex first = spectra[0][k];
      for (Eigen::Index j = 0; j < others; ++j) {
        r[j] = spectra[static_cast<std::size_t>(j) + 1][k] - g[j] * first;
      }
      const Complex clean = first + power[0] * (g.adjoint() * weight * r)(0, 0);
      const double size = std::norm(clean);
      const Complex log_J = (estimator * r)(0, 0) / clean;
      gathering.add(shot, {log_J, 0.5 / (information * size)});
    }
  }
  return gathering.spectrum(std::max(1.0, fit.chi2_reduced));
}

}  // namespace kolsky
