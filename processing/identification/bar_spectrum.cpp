#include "processing/identification/bar_spectrum.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "processing/identification/bar_likelihood.hpp"

namespace kolsky {

namespace {

/// What is left of a wave at the end of a damped record.
constexpr double kLeftAtEnd = 3e-5;

/// Records of all shots from shortly before the pulse on, damped, at the frequencies of a band.
struct DampedBand {
  double eta_per_s = 0.0;
  double period_s = 0.0;
  double seconds = 0.0;
  std::vector<Complex> path;
  std::vector<double> frequency_Hz;
  std::vector<std::vector<std::vector<Complex>>> spectra;  ///< by shot, gauge, frequency

  /// Noise power of a sum over damped samples, by that over as many undamped ones.
  [[nodiscard]] double samples_seen() const {
    return -std::expm1(-2.0 * eta_per_s * seconds) / (2.0 * eta_per_s * period_s);
  }
};

std::size_t begin_of(const BarRecords& records) {
  return records.quiet_samples;
}

/// @param end  of what is used of a gauge's record, from `begin_of`, by shot and gauge
template <typename End>
DampedBand damped_band(const BarData& data, std::size_t samples, double left_at_end,
                       double bin_width_over, const End& end) {
  const double period_s = data.records().front().period_s;
  DampedBand band;
  band.period_s = period_s;
  const auto length = static_cast<std::size_t>(static_cast<double>(samples) * bin_width_over);
  DampedTransform transform(length, period_s, std::pow(left_at_end, bin_width_over));
  band.eta_per_s = transform.s(0).real();
  band.seconds = static_cast<double>(samples) * period_s;
  const auto bins = static_cast<std::size_t>(data.band_limit_Hz() / transform.bin_width_Hz());
  for (std::size_t k = 1; k <= bins && k < transform.bins(); ++k) {
    band.path.push_back(transform.s(k));
    band.frequency_Hz.push_back(static_cast<double>(k) * transform.bin_width_Hz());
  }
  std::vector<Complex> whole(transform.bins());
  for (std::size_t shot = 0; shot < data.shots(); ++shot) {
    const BarRecords& records = data.records()[shot];
    auto& of_shot = band.spectra.emplace_back();
    for (std::size_t j = 0; j < data.gauges(); ++j) {
      const std::size_t begin = begin_of(records);
      const std::size_t count =
          std::min({end(shot, j), records.strain[j].size() - begin, transform.length()});
      transform.forward(std::span<const double>(records.strain[j]).subspan(begin, count), whole);
      of_shot.emplace_back(whole.begin() + 1,
                           whole.begin() + 1 + static_cast<std::ptrdiff_t>(band.path.size()));
    }
  }
  return band;
}

std::vector<Complex> on_axis(const std::vector<Complex>& path) {
  std::vector<Complex> axis;
  for (const Complex s : path) {
    axis.emplace_back(0.0, s.imag());
  }
  return axis;
}

/// One estimate of log J at a frequency, and its variance in each of real and imaginary part.
struct LogEstimate {
  Complex log_J;  ///< over the fitted one
  double variance = 0.0;
};

/// Gathers estimates of log (J / J fitted) over shots, and what the bench leaves open of them.
class Gathering {
 public:
  Gathering(const BarData& data, const BarFit& fit, const BarModel& model, const DampedBand& band)
      : frequency_Hz_(band.frequency_Hz), axis_(on_axis(band.path)) {
    const auto compliance = model.solid(fit.at);
    fitted_ = bar_modes(fit.theory, model.moved(fit.at).bar, *compliance, axis_);
    for (std::size_t k = 0; k < axis_.size(); ++k) {
      J_axis_.push_back(compliance->at(axis_[k]));
      J_path_.push_back(compliance->at(band.path[k]));
    }
    shots_.resize(data.shots());
    bench_.assign(axis_.size(), {});
  }

  void add(std::size_t shot, LogEstimate estimate) { shots_[shot].push_back(estimate); }
  /// Standard deviations that the bench gives log J, one complex number per independent cause.
  void add_bench(std::size_t k, std::vector<Complex> causes) { bench_[k] = std::move(causes); }
  /// What the estimates are relative to, off the axis.
  [[nodiscard]] Complex fitted_off_axis(std::size_t k) const { return J_path_[k]; }

  [[nodiscard]] BarSpectrum spectrum(double widened) const {
    BarSpectrum spectrum;
    spectrum.frequency_Hz = frequency_Hz_;
    for (std::size_t k = 0; k < axis_.size(); ++k) {
      const auto J = [&](Complex log_J) {
        return J_axis_[k] + J_path_[k] * (std::exp(log_J) - 1.0);
      };
      const auto gamma = [&](Complex log_J) {
        return fitted_[k].gamma * std::exp(fitted_[k].slope * std::log(J(log_J) / J_axis_[k]));
      };
      append(
          k, widened, [&](Complex x) { return gamma(x).real(); }, spectrum.alpha_per_m);
      append(
          k, widened, [&](Complex x) { return gamma(x).imag(); }, spectrum.wavenumber_per_m);
      append(
          k, widened, [&](Complex x) { return J(x).real(); }, spectrum.J1_per_Pa);
      append(
          k, widened, [&](Complex x) { return -J(x).imag(); }, spectrum.J2_per_Pa);
    }
    return spectrum;
  }

 private:
  template <typename Function>
  void append(std::size_t k, double widened, const Function& of, SpectrumLine& line) const {
    constexpr double kStep = 1e-4;
    const double here = of(0.0);
    const Complex slope((of(kStep) - here) / kStep, (of(Complex(0.0, kStep)) - here) / kStep);
    double weights = 0.0;
    double sum = 0.0;
    for (const auto& shot : shots_) {
      weights += 1.0 / shot[k].variance;
      sum += of(shot[k].log_J) / shot[k].variance;
    }
    const double mean = sum / weights;
    double squares = 0.0;
    for (const auto& shot : shots_) {
      squares += std::pow(of(shot[k].log_J) - mean, 2);
    }
    const auto count = static_cast<double>(shots_.size());
    double bench = 0.0;
    for (const Complex cause : bench_[k]) {
      bench += std::pow(slope.real() * cause.real() + slope.imag() * cause.imag(), 2);
    }
    const double noise_of_mean = widened * std::norm(slope) / weights;
    const double of_one =
        shots_.size() > 1 ? std::max(squares / (count - 1.0), noise_of_mean) : noise_of_mean;
    line.mean.push_back(mean);
    line.sd.push_back(std::sqrt(of_one + bench));
    line.sd_of_mean.push_back(std::sqrt(noise_of_mean + bench));
  }

  std::vector<double> frequency_Hz_;
  std::vector<Complex> axis_;
  std::vector<BarMode> fitted_;
  std::vector<Complex> J_axis_;
  std::vector<Complex> J_path_;
  std::vector<std::vector<LogEstimate>> shots_;
  std::vector<std::vector<Complex>> bench_;
};

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
std::vector<Complex> bench_causes(const std::vector<BarModel::Transfer>& transfers, std::size_t k,
                                  const Eigen::RowVectorXcd& estimator, const BarModel& model,
                                  const Eigen::MatrixXd& root) {
  Eigen::RowVectorXcd by_unknown = Eigen::RowVectorXcd::Zero(root.rows());
  for (std::size_t j = 0; j < transfers.size(); ++j) {
    for (const auto& derivative : transfers[j].derivatives) {
      if (derivative.parameter < model.first_unknown()) {
        continue;
      }
      const Complex of_g =
          derivative.proportion ? *derivative.proportion * transfers[j].g[k] : derivative.of_g[k];
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
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
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
    return changed.transfers(fit.at, path, false);
  };
  const auto above = at(std::exp(kStep));
  const auto below = at(std::exp(-kStep));
  std::vector<std::vector<Complex>> slopes(above.size());
  for (std::size_t j = 0; j < above.size(); ++j) {
    for (std::size_t k = 0; k < path.size(); ++k) {
      slopes[j].push_back((above[j].g[k] - below[j].g[k]) / (2.0 * kStep));
    }
  }
  return slopes;
}

/// Power by gauge of noise in damped sums, the error of the baseline with it, over all shots.
std::vector<double> powers_at(const BarData& data, const DampedBand& band, std::size_t k) {
  const auto& path = data.judged_path();
  const double width = path.front().imag() / (2.0 * std::numbers::pi);
  const auto bin = std::min(
      static_cast<std::size_t>(std::max(0.0, band.frequency_Hz[k] / width - 0.5)), path.size() - 1);
  const auto& places = data.places();
  const double judged_samples =
      static_cast<double>(places.judged_end - places.judged_begin) / places.samples_per_place;
  const double of_constant = 1.0 / std::norm(band.path[k] * band.period_s);
  std::vector<double> powers;
  for (std::size_t j = 0; j < data.gauges(); ++j) {
    const double baseline = data.baseline_sd(0, j);
    powers.push_back(data.noise_power(j)[bin] / judged_samples * band.samples_seen() +
                     baseline * baseline * of_constant);
  }
  return powers;
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
  Gathering gathering(data, fit, model, band);
  const auto transfers = model.transfers(fit.at, band.path, true);
  const auto slopes = slopes_by_log_J(model, fit, band.path);
  const Eigen::MatrixXd root = root_of_bench_covariance(fit, model);
  const auto others = static_cast<Eigen::Index>(transfers.size());
  Eigen::VectorXcd g(others);
  Eigen::VectorXcd slope(others);
  Eigen::VectorXcd r(others);
  for (std::size_t k = 0; k < band.path.size(); ++k) {
    const auto power = powers_at(data, band, k);
    for (Eigen::Index j = 0; j < others; ++j) {
      g[j] = transfers[static_cast<std::size_t>(j)].g[k];
      slope[j] = slopes[static_cast<std::size_t>(j)][k];
    }
    const Eigen::MatrixXcd weight = inverse_covariance(g, power);
    const double information = (slope.adjoint() * weight * slope)(0, 0).real();
    const Eigen::RowVectorXcd estimator = slope.adjoint() * weight / information;
    gathering.add_bench(k, bench_causes(transfers, k, estimator, model, root));
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

BarSpectrum straight_line_spectrum(const BarData& data, const BarFit& fit) {
  constexpr double kGone = 0.05;  // of the peak, on average over the end of what is used
  const BarRecords& first = data.records().front();
  const double length_m = data.bench().input.length_m;
  const double speed = (first.position_m.back() - first.position_m.front()) /
                       (first.rise_s.back() - first.rise_s.front());
  const double rate_Hz = 1.0 / first.period_s;
  // Up to the return at each gauge, all as long as the shortest, each from its own front.
  double shortest_s = 1e300;
  for (std::size_t j = 0; j < data.gauges(); ++j) {
    const double to_return_s = 2.0 * (length_m - first.position_m[j]) / speed;
    shortest_s = std::min(shortest_s, to_return_s * 0.98);
    for (const BarRecords& records : data.records()) {
      const double left = static_cast<double>(records.strain[j].size()) * records.period_s -
                          records.foot_s - (records.rise_s[j] - records.rise_s[0]);
      shortest_s = std::min(shortest_s, left);
    }
  }
  const auto window = static_cast<std::size_t>(std::max(0.0, shortest_s * rate_Hz));
  const auto delay = [&](std::size_t shot, std::size_t j) {
    const BarRecords& records = data.records()[shot];
    return static_cast<std::size_t>((records.rise_s[j] - records.rise_s[0]) * rate_Hz);
  };
  for (std::size_t shot = 0; shot < data.shots(); ++shot) {
    const BarRecords& records = data.records()[shot];
    for (std::size_t j = 0; j < data.gauges(); ++j) {
      const std::size_t end =
          std::min(begin_of(records) + delay(shot, j) + window, records.strain[j].size());
      const std::size_t tail = std::max<std::size_t>(1, window / 10);
      double mean = 0.0;
      for (std::size_t n = end - std::min(end, tail); n < end; ++n) {
        mean += records.strain[j][n] / static_cast<double>(tail);
      }
      if (std::abs(mean) > kGone * records.peak[j]) {
        return {};
      }
    }
  }
  const std::size_t longest = window + delay(0, data.gauges() - 1);
  const DampedBand band =
      damped_band(data, longest, 0.1, 2.0,
                  [&](std::size_t shot, std::size_t j) { return window + delay(shot, j); });
  BarFit elementary = fit;
  elementary.theory = WaveTheory::elementary;
  const BarModel model(data.bench(), data.records().front(),
                       {WaveTheory::elementary, fit.solid, fit.far_end});
  Gathering gathering(data, elementary, model, band);
  const auto gauges = static_cast<double>(data.gauges());
  double sum_x = 0.0;
  double sum_xx = 0.0;
  for (const double x : first.position_m) {
    sum_x += x;
    sum_xx += x * x;
  }
  const double spread = gauges * sum_xx - sum_x * sum_x;
  for (std::size_t shot = 0; shot < data.shots(); ++shot) {
    const BarRecords& records = data.records()[shot];
    std::vector<double> phase_before(data.gauges(), 0.0);
    for (std::size_t k = 0; k < band.path.size(); ++k) {
      const Complex s = band.path[k];
      const auto power = powers_at(data, band, k);
      Complex sum = 0.0;
      Complex sum_with_x = 0.0;
      double variance = 0.0;
      for (std::size_t j = 0; j < data.gauges(); ++j) {
        const double delay_s = records.rise_s[j] - records.rise_s[0];
        const Complex y = band.spectra[shot][j][k];
        // Less the delay, the phase against gauge 0 is small at low frequencies and moves slowly.
        const Complex turned = y / band.spectra[shot][0][k] * std::exp(s * delay_s);
        double phase = std::arg(turned);
        phase -= 2.0 * std::numbers::pi *
                 std::round((phase - phase_before[j]) / (2.0 * std::numbers::pi));
        phase_before[j] = phase;
        const Complex log_y = Complex(std::log(std::abs(turned)), phase) - s * delay_s;
        const double x = records.position_m[j];
        sum += log_y;
        sum_with_x += x * log_y;
        const double share = (sum_x - gauges * x) / spread;
        variance += 0.5 * share * share * power[j] / std::norm(y);
      }
      const Complex gamma = (sum_x * sum - gauges * sum_with_x) / spread;
      const Complex J = gamma * gamma / (data.bench().input.density_kg_m3.value * s * s);
      gathering.add(
          shot, {std::log(J / gathering.fitted_off_axis(k)), variance * 4.0 / std::norm(gamma)});
    }
  }
  return gathering.spectrum(1.0);
}

std::vector<FittedNumber> three_elements_through(const BarSpectrum& spectrum, double up_to_Hz) {
  constexpr int kSteps = 60;
  if (spectrum.frequency_Hz.size() < 4) {
    return {};
  }
  // J1(0) - J1(infinity) = 1/E2, J2 has its peak where w eta2 = E2.
  std::size_t used = 0;
  std::size_t peak = 0;
  for (std::size_t k = 0; k < spectrum.frequency_Hz.size(); ++k) {
    if (spectrum.frequency_Hz[k] <= up_to_Hz) {
      used = k + 1;
      peak = spectrum.J2_per_Pa.mean[k] > spectrum.J2_per_Pa.mean[peak] ? k : peak;
    }
  }
  const double J2_peak = spectrum.J2_per_Pa.mean[peak];
  if (used < 4 || J2_peak <= 0.0) {
    return {};
  }
  const double two_pi = 2.0 * std::numbers::pi;
  Eigen::Vector3d p(std::log(1.0 / spectrum.J1_per_Pa.mean[used - 1]), std::log(0.5 / J2_peak),
                    0.0);
  p[2] = p[1] - std::log(two_pi * spectrum.frequency_Hz[peak]);
  const auto residuals = [&](const Eigen::Vector3d& at) {
    const ThreeElementSolid solid(std::exp(at[0]), std::exp(at[1]), std::exp(at[2]));
    Eigen::VectorXd r(static_cast<Eigen::Index>(2 * used));
    for (std::size_t k = 0; k < used; ++k) {
      const Complex J = solid.at({0.0, two_pi * spectrum.frequency_Hz[k]});
      const auto i = static_cast<Eigen::Index>(2 * k);
      r[i] = (J.real() - spectrum.J1_per_Pa.mean[k]) / J2_peak;
      r[i + 1] = (-J.imag() - spectrum.J2_per_Pa.mean[k]) / J2_peak;
    }
    return r;
  };
  Eigen::MatrixXd slope(static_cast<Eigen::Index>(2 * used), 3);
  double damping = 1e-3;
  Eigen::VectorXd here = residuals(p);
  for (int step = 0; step < kSteps; ++step) {
    for (Eigen::Index m = 0; m < 3; ++m) {
      Eigen::Vector3d beside = p;
      beside[m] += 1e-6;
      slope.col(m) = (residuals(beside) - here) / 1e-6;
    }
    Eigen::Matrix3d normal = slope.transpose() * slope;
    normal.diagonal() *= 1.0 + damping;
    const Eigen::Vector3d next = p - normal.ldlt().solve(slope.transpose() * here);
    const Eigen::VectorXd there = residuals(next);
    if (there.allFinite() && there.squaredNorm() <= here.squaredNorm()) {
      const bool done = (next - p).norm() < 1e-9;
      p = next;
      here = there;
      damping *= 0.1;
      if (done) {
        break;
      }
    } else {
      damping *= 10.0;
    }
  }
  const auto freedom = static_cast<double>(2 * used - 3);
  const Eigen::Matrix3d covariance =
      (slope.transpose() * slope).inverse() * here.squaredNorm() / freedom;
  std::vector<FittedNumber> numbers;
  const auto& family = parameters_of(SolidKind::three_element);
  for (Eigen::Index m = 0; m < 3; ++m) {
    const double value = std::exp(p[m]);
    numbers.push_back({family[static_cast<std::size_t>(m)].name, value,
                       value * std::sqrt(std::max(0.0, covariance(m, m)))});
  }
  return numbers;
}

}  // namespace kolsky
