#include "processing/identification/bar_likelihood.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace kolsky {

namespace {

/// With a record that holds many returns, those beyond this many are taken alike.
constexpr std::size_t kMostReturns = 12;
/// Bins whose noise is taken together: to 15 kHz in records of 4 ms. Where losses show in them, an
/// average over returns states deviations that are 4 to 8 % small.
constexpr std::size_t kLowestBins = 60;
/// Places at which noise enters, per bin: what moves faster is not in them.
constexpr std::size_t kPlacesPerBin = 12;

/// What first-order noise does, by independent causes: `shown` is by strides of so many samples,
/// over which the noise is taken by its mean.
Eigen::MatrixXd driven(const Eigen::MatrixXd& shown, const NoiseSpectrum::SlowPart& part,
                       double samples) {
  const double keep = std::pow(part.keep, samples);
  const double sd = std::sqrt(part.variance_of_mean(samples));
  Eigen::MatrixXd by_cause = shown;
  for (Eigen::Index e = by_cause.cols() - 2; e >= 0; --e) {
    by_cause.col(e) += keep * by_cause.col(e + 1);
  }
  by_cause.rightCols(by_cause.cols() - 1) *= sd * std::sqrt(1.0 - keep * keep);
  by_cause.col(0) *= sd;
  return by_cause;
}

/// Slow noise jumps from the end of what is judged to its beginning, which every bin sees alike: a
/// ramp's spectrum. That of gauge 0 shows at the others.
std::vector<BarData::Spectrum> jumps(const BarData& data) {
  constexpr double kSlow = 0.8;  // correlation of neighbouring samples
  const auto variance_of = [&](std::size_t gauge) {
    double variance = 0.0;
    for (const auto& part : data.slow_noise(gauge)) {
      variance += part.keep > kSlow ? 2.0 * part.variance : 0.0;
    }
    return variance;
  };
  const auto judged = static_cast<double>(data.places().judged_end - data.places().judged_begin);
  std::vector<BarData::Spectrum> list;
  for (std::size_t j = 1; j < data.gauges(); ++j) {
    const double sd = std::sqrt(variance_of(0) + variance_of(j));
    BarData::Spectrum& jump = list.emplace_back();
    for (std::size_t k = 0; k < data.judged_path().size(); ++k) {
      const double angle = -2.0 * std::numbers::pi * static_cast<double>(k + 1) / judged;
      jump.push_back(sd / (std::polar(1.0, angle) - 1.0));
    }
  }
  return list;
}

double travel_there_and_back_s(const BarData& data, const MovedBench& moved,
                               const Compliance& compliance) {
  const double distance_m = 2.0 * (moved.bar.length_m - moved.position_m[0]);
  return std::max(distance_m / front_speed_m_per_s(moved.bar, compliance),
                  data.judged_s() / static_cast<double>(kMostReturns));
}

}  // namespace

BarLikelihood::BarLikelihood(BarData& data, BarModel model)
    : data_(data), model_(std::move(model)), product_(data.path().size()) {}

std::size_t BarLikelihood::residuals() const {
  return 2 * data_.judged_path().size() * (data_.gauges() - 1) * data_.shots();
}

/// g after n returns is its first passage times
///   sum_{i <= n} (-R q_0)^i + R q_j sum_{i < n} (-R q_0)^i.
std::vector<BarLikelihood::Whitening> BarLikelihood::whitening(std::span<const double> at) {
  const auto passages = model_.first_passages(at, data_.judged_path(), false);
  const auto others = static_cast<Eigen::Index>(passages.size());
  const double R = model_.reflection(at);
  const auto returns =
      R != 0.0 ? model_.returns(at, data_.judged_path()) : std::vector<BarModel::Spectrum>{};
  const double turn_s = travel_there_and_back_s(data_, model_.moved(at), *model_.solid(at));
  const double turns = data_.judged_s() / turn_s;
  std::vector<Whitening> list;
  list.reserve(data_.judged_path().size());
  Eigen::MatrixXcd covariance(others, others);
  Eigen::VectorXcd g(others);
  Eigen::VectorXcd mean_g(others);
  for (std::size_t k = 0; k < data_.judged_path().size(); ++k) {
    covariance.setZero();
    mean_g.setZero();
    Complex series = 1.0;
    Complex series_before = 0.0;
    Complex power = 1.0;
    for (double passed = 0.0; passed < turns; passed += 1.0) {
      const double share = std::min(1.0, turns - passed) / turns;
      for (Eigen::Index j = 0; j < others; ++j) {
        const auto i = static_cast<std::size_t>(j);
        const Complex echo =
            R != 0.0 ? series + R * returns[i + 1][k] * series_before : Complex(1.0);
        g[j] = passages[i].g[k] * echo;
      }
      covariance += share * data_.noise_power(0)[k] * g * g.adjoint();
      mean_g += share * g;
      if (R == 0.0) {
        continue;
      }
      power *= -R * returns[0][k];
      series_before = series;
      series += power;
    }
    for (Eigen::Index j = 0; j < others; ++j) {
      covariance(j, j) += data_.noise_power(static_cast<std::size_t>(j) + 1)[k];
    }
    const Eigen::LLT<Eigen::MatrixXcd> factor(covariance);
    Whitening whitening;
    whitening.lower_inverse = factor.matrixL().solve(Eigen::MatrixXcd::Identity(others, others));
    whitening.noise_of_first = data_.noise_power(0)[k] * factor.solve(mean_g).adjoint();
    list.push_back(std::move(whitening));
  }
  return list;
}

/// What a unit of gauge 0's reading over one stride shows at the others in the lowest bins. Rows as
/// in `white`, columns by the stride. The response from its place to the end of what is judged:
/// differences of sums over one response. The mean of the quiet strides is taken off, as it is from
/// the records.
Eigen::MatrixXd BarLikelihood::shown_by_first(std::span<const double> at,
                                              std::size_t stride) const {
  const BarData::Places& places = data_.places();
  const auto others = static_cast<Eigen::Index>(data_.gauges() - 1);
  const auto begin = static_cast<std::size_t>(places.records_begin);
  const std::size_t entries = (places.judged_end - begin) / stride;
  const std::size_t judged = places.judged_end - places.judged_begin;
  const auto transfers = model_.transfers(at, data_.path(), false);
  Eigen::MatrixXd shown(2 * others * static_cast<Eigen::Index>(lowest_bins_),
                        static_cast<Eigen::Index>(entries));
  std::vector<Complex> sums(places.judged_end + 1);
  Spectrum product(data_.path().size());
  for (Eigen::Index j = 0; j < others; ++j) {
    for (std::size_t k = 0; k < product.size(); ++k) {
      product[k] = transfers[static_cast<std::size_t>(j)].g[k] * data_.unit_impulse()[k];
    }
    const std::span<const double> response = data_.in_time(product);
    for (std::size_t bin = 0; bin < lowest_bins_; ++bin) {
      const double angle =
          -2.0 * std::numbers::pi * static_cast<double>(bin + 1) / static_cast<double>(judged);
      const Complex turn = std::polar(1.0, angle);
      Complex phase = 1.0;
      for (std::size_t n = 0; n < response.size(); ++n) {
        sums[n + 1] = sums[n] + response[n] * phase;
        phase *= turn;
      }
      const double samples = static_cast<double>(stride) * places.samples_per_place;
      Complex shift = samples * data_.undo_filter(bin) *
                      std::polar(1.0, -angle * static_cast<double>(places.judged_begin));
      const Complex shift_per_entry = std::polar(1.0, angle * static_cast<double>(stride));
      const Eigen::Index row = 2 * others * static_cast<Eigen::Index>(bin) + j;
      for (std::size_t e = 0; e < entries; ++e) {
        const std::size_t late = e * stride;
        const std::size_t first = places.judged_begin > late ? places.judged_begin - late : 0;
        const Complex seen = shift * (sums[places.judged_end - late] - sums[first]);
        shown(row, static_cast<Eigen::Index>(e)) = seen.real();
        shown(row + others, static_cast<Eigen::Index>(e)) = seen.imag();
        shift *= shift_per_entry;
      }
    }
  }
  const auto quiet = std::max<Eigen::Index>(
      1, static_cast<Eigen::Index>((places.quiet_end - places.records_begin) /
                                   static_cast<double>(stride)));
  const Eigen::VectorXd of_constant = shown.rowwise().sum() / static_cast<double>(quiet);
  shown.leftCols(quiet).colwise() -= of_constant;
  return shown;
}

/// The same of a gauge's own reading in its own rows, from where the judging begins.
Eigen::MatrixXd BarLikelihood::shown_by_own(std::size_t stride) const {
  const BarData::Places& places = data_.places();
  const std::size_t judged = places.judged_end - places.judged_begin;
  Eigen::MatrixXd shown(static_cast<Eigen::Index>(2 * lowest_bins_),
                        static_cast<Eigen::Index>(judged / stride));
  for (Eigen::Index bin = 0; bin < static_cast<Eigen::Index>(lowest_bins_); ++bin) {
    const double angle =
        -2.0 * std::numbers::pi * static_cast<double>(bin + 1) / static_cast<double>(judged);
    for (Eigen::Index e = 0; e < shown.cols(); ++e) {
      const Complex seen = std::polar(static_cast<double>(stride),
                                      angle * static_cast<double>(stride) * static_cast<double>(e));
      shown(2 * bin, e) = seen.real();
      shown(2 * bin + 1, e) = seen.imag();
    }
  }
  return shown;
}

void BarLikelihood::couple_lowest_bins(std::span<const double> at) {
  const BarData::Places& places = data_.places();
  const auto others = static_cast<Eigen::Index>(data_.gauges() - 1);
  const auto bins = static_cast<Eigen::Index>(lowest_bins_);
  const auto judged = static_cast<double>(places.judged_end - places.judged_begin);
  const auto stride = std::max<std::size_t>(
      1, (places.judged_end - places.judged_begin) / (kPlacesPerBin * lowest_bins_));
  const double samples = static_cast<double>(stride) * places.samples_per_place;
  // Power per sample of what is not in the slow parts, which are treated each by itself.
  const auto steady = [&](std::size_t gauge, std::size_t bin) {
    double power = data_.noise_power(gauge)[bin] * places.samples_per_place / judged;
    const double cycles = data_.judged_path()[bin].imag() / (2.0 * std::numbers::pi) *
                          data_.records().front().period_s;
    for (const auto& part : data_.slow_noise(gauge)) {
      power -= part.power(cycles);
    }
    return std::max(power, 0.0);
  };
  const Eigen::MatrixXd by_first = shown_by_first(at, stride);
  Eigen::MatrixXd scaled = by_first;
  for (Eigen::Index bin = 0; bin < bins; ++bin) {
    scaled.middleRows(2 * others * bin, 2 * others) *=
        std::sqrt(steady(0, static_cast<std::size_t>(bin)) / samples);
  }
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(by_first.rows(), by_first.rows());
  add_square(scaled, covariance);
  for (const auto& part : data_.slow_noise(0)) {
    add_square(driven(by_first, part, samples), covariance);
  }
  for (Eigen::Index j = 0; j < others; ++j) {
    const auto gauge = static_cast<std::size_t>(j) + 1;
    Eigen::MatrixXd own = Eigen::MatrixXd::Zero(2 * bins, 2 * bins);
    if (!data_.slow_noise(gauge).empty()) {
      const Eigen::MatrixXd by_own = shown_by_own(stride);
      for (const auto& part : data_.slow_noise(gauge)) {
        add_square(driven(by_own, part, samples), own);
      }
    }
    for (Eigen::Index bin = 0; bin < bins; ++bin) {
      const double half =
          0.5 * steady(gauge, static_cast<std::size_t>(bin)) * judged / places.samples_per_place;
      own(2 * bin, 2 * bin) += half;
      own(2 * bin + 1, 2 * bin + 1) += half;
    }
    const auto place = [&](Eigen::Index i) { return 2 * others * (i / 2) + j + others * (i % 2); };
    for (Eigen::Index a = 0; a < 2 * bins; ++a) {
      for (Eigen::Index b = 0; b <= a; ++b) {
        covariance(place(a), place(b)) += own(a, b);
      }
    }
  }
  const Eigen::LLT<Eigen::MatrixXd, Eigen::Lower> factor(covariance);
  lowest_factor_ = LowerTriangle(factor.matrixLLT());
}

void BarLikelihood::weigh(std::span<const double> at, bool exact) {
  whitening_ = whitening(at);
  lowest_bins_ = exact ? std::min(kLowestBins, data_.judged_path().size()) : 0;
  if (exact) {
    couple_lowest_bins(at);
  }
}

BarLikelihood::Spectrum BarLikelihood::judged_product(const Spectrum& filter,
                                                      const Spectrum& spectrum) {
  for (std::size_t k = 0; k < product_.size(); ++k) {
    product_[k] = filter[k] * spectrum[k];
  }
  Spectrum judged(data_.judged_path().size());
  data_.judge(product_, judged);
  return judged;
}

std::vector<BarLikelihood::Spectrum> BarLikelihood::residuals_of(
    std::size_t shot, const std::vector<BarModel::Transfer>& transfers) {
  std::vector<Spectrum> list;
  for (std::size_t j = 0; j < transfers.size(); ++j) {
    Spectrum r = judged_product(transfers[j].g, data_.spectrum(shot, 0));
    const Spectrum& own = data_.judged(shot, j + 1);
    for (std::size_t k = 0; k < r.size(); ++k) {
      r[k] = own[k] - r[k];
    }
    list.push_back(std::move(r));
  }
  return list;
}

/// What is common to the shots at one place in the parameters.
struct BarLikelihood::Columns {
  std::vector<BarModel::Transfer> transfers;  ///< on the damped path
  std::vector<BarModel::Transfer> passages;   ///< on the imaginary axis
  std::vector<Spectrum> offset;               ///< what the baseline's error makes of each r_j
  std::vector<Spectrum> jump;                 ///< and noise that ends elsewhere than it began
};

/// By bin, gauges by columns: one per parameter, the residual, the baseline, the gauges' jumps.
std::vector<Eigen::MatrixXcd> BarLikelihood::bins_of(std::size_t shot, const Columns& columns) {
  const std::size_t bins = data_.judged_path().size();
  const auto others = static_cast<Eigen::Index>(columns.transfers.size());
  const auto parameters = static_cast<Eigen::Index>(model_.parameters());
  const std::vector<Spectrum> residual = residuals_of(shot, columns.transfers);
  const Eigen::Index wide = parameters + 2 + others;
  std::vector<Eigen::MatrixXcd> bin(bins, Eigen::MatrixXcd::Zero(others, wide));
  for (Eigen::Index j = 0; j < others; ++j) {
    const auto i = static_cast<std::size_t>(j);
    for (std::size_t k = 0; k < bins; ++k) {
      bin[k](j, parameters) = residual[i][k];
      if (k >= lowest_bins_) {
        bin[k](j, parameters + 1) = columns.offset[i][k];
        bin[k](j, parameters + 2 + j) = columns.jump[i][k];
      }
    }
  }
  for (Eigen::Index j = 0; j < others; ++j) {
    const auto i = static_cast<std::size_t>(j);
    const auto& derivatives = columns.transfers[i].derivatives;
    for (std::size_t d = 0; d < derivatives.size(); ++d) {
      const auto& derivative = derivatives[d];
      const auto& passage = columns.passages[i].derivatives[d];
      const auto m = static_cast<Eigen::Index>(derivative.parameter);
      Spectrum moved;
      if (derivative.proportion) {
        moved.resize(bins);
        for (std::size_t k = 0; k < bins; ++k) {
          moved[k] = *derivative.proportion * (data_.judged(shot, i + 1)[k] - residual[i][k]);
        }
      } else {
        moved = judged_product(derivative.of_g, data_.spectrum(shot, 0));
      }
      for (std::size_t k = 0; k < bins; ++k) {
        Complex noise_of_first = 0.0;
        for (Eigen::Index l = 0; l < others; ++l) {
          noise_of_first +=
              whitening_[k].noise_of_first[l] * residual[static_cast<std::size_t>(l)][k];
        }
        const Complex slope =
            passage.proportion ? *passage.proportion * columns.passages[i].g[k] : passage.of_g[k];
        bin[k](j, m) = -moved[k] - slope * noise_of_first;
      }
    }
  }
  return bin;
}

/// Rows of unit variance each. Real and imaginary part of a bin carry half of its power each.
Eigen::MatrixXd BarLikelihood::white(const std::vector<Eigen::MatrixXcd>& bins) const {
  const Eigen::Index others = bins.front().rows();
  const Eigen::Index wide = bins.front().cols();
  Eigen::MatrixXd rows(2 * others * static_cast<Eigen::Index>(bins.size()), wide);
  for (std::size_t k = 0; k < bins.size(); ++k) {
    const Eigen::Index at = 2 * others * static_cast<Eigen::Index>(k);
    if (k < lowest_bins_) {
      rows.middleRows(at, others) = bins[k].real();
      rows.middleRows(at + others, others) = bins[k].imag();
      continue;
    }
    const Eigen::MatrixXcd whitened = std::numbers::sqrt2 * (whitening_[k].lower_inverse * bins[k]);
    rows.middleRows(at, others) = whitened.real();
    rows.middleRows(at + others, others) = whitened.imag();
  }
  if (lowest_bins_ > 0) {
    const Eigen::Index coupled = 2 * others * static_cast<Eigen::Index>(lowest_bins_);
    // What else is eliminated lies in that covariance: its columns are empty there.
    const auto judged = static_cast<Eigen::Index>(model_.parameters()) + 1;
    lowest_factor_.solve_in_place(rows.topLeftCorner(coupled, judged));
  }
  return rows;
}

ShotTerms BarLikelihood::terms_of(std::size_t shot, const Columns& columns) {
  const auto parameters = static_cast<Eigen::Index>(model_.parameters());
  const Eigen::MatrixXd rows = white(bins_of(shot, columns));
  const auto residuals = rows.col(parameters);
  const auto slopes = rows.leftCols(parameters);
  const auto nuisances = rows.rightCols(rows.cols() - parameters - 1);
  const Eigen::LLT<Eigen::MatrixXd> known(
      Eigen::MatrixXd::Identity(nuisances.cols(), nuisances.cols()) +
      nuisances.transpose() * nuisances);
  const Eigen::VectorXd in_residuals = nuisances.transpose() * residuals;
  const Eigen::MatrixXd in_slopes = nuisances.transpose() * slopes;
  const Eigen::VectorXd explained = known.solve(in_residuals);
  ShotTerms terms;
  terms.chi2 = residuals.squaredNorm() - in_residuals.dot(explained);
  terms.gradient = slopes.transpose() * residuals - in_slopes.transpose() * explained;
  terms.information = slopes.transpose() * slopes;
  terms.information -= in_slopes.transpose() * known.solve(in_slopes);
  return terms;
}

std::vector<ShotTerms> BarLikelihood::evaluate(std::span<const double> at, std::size_t shots) {
  Columns columns;
  columns.transfers = model_.transfers(at, data_.path(), true);
  columns.passages = model_.first_passages(at, data_.judged_path(), true);
  columns.jump = jumps(data_);
  for (const auto& transfer : columns.transfers) {
    columns.offset.push_back(judged_product(transfer.g, data_.unit_offset()));
    for (Complex& value : columns.offset.back()) {
      value *= data_.baseline_sd(0, 0);
    }
  }
  std::vector<ShotTerms> terms;
  for (std::size_t shot = 0; shot < std::min(shots, data_.shots()); ++shot) {
    terms.push_back(terms_of(shot, columns));
  }
  return terms;
}

}  // namespace kolsky
