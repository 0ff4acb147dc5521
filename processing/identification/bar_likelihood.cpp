#include "processing/identification/bar_likelihood.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace kolsky {

namespace {

/// With a record that holds many returns, those beyond this many are taken alike.
constexpr std::size_t kMostReturns = 12;
/// Bins whose noise is taken together.
constexpr std::size_t kLowestBins = 20;
/// Places at which noise enters, per bin: what moves faster is not in them.
constexpr std::size_t kPlacesPerBin = 12;

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

/// Noise of gauge 0 that enters at a place of its record shows at the others as the response from
/// there to the end of what is judged: sums over the response, one per bin, give the covariance.
void BarLikelihood::couple_lowest_bins(std::span<const double> at) {
  const BarData::Places& places = data_.places();
  const auto others = static_cast<Eigen::Index>(data_.gauges() - 1);
  const auto bins = static_cast<Eigen::Index>(lowest_bins_);
  const auto stride = std::max<std::size_t>(
      1, (places.judged_end - places.judged_begin) / (kPlacesPerBin * lowest_bins_));
  const auto begin = static_cast<std::size_t>(places.records_begin);
  const std::size_t entries = (places.judged_end - begin) / stride;
  const std::size_t judged = places.judged_end - places.judged_begin;
  const auto transfers = model_.transfers(at, data_.path(), false);
  // Rows as in `white`, columns by the place at which the noise enters.
  Eigen::MatrixXd shown(2 * others * bins, static_cast<Eigen::Index>(entries));
  std::vector<Complex> sums(places.judged_end + 1);
  for (Eigen::Index j = 0; j < others; ++j) {
    for (std::size_t k = 0; k < product_.size(); ++k) {
      product_[k] = transfers[static_cast<std::size_t>(j)].g[k] * data_.unit_impulse()[k];
    }
    const std::span<const double> response = data_.in_time(product_);
    for (Eigen::Index bin = 0; bin < bins; ++bin) {
      const auto b = static_cast<std::size_t>(bin);
      const Complex turn = std::polar(
          1.0, -2.0 * std::numbers::pi * static_cast<double>(b + 1) / static_cast<double>(judged));
      Complex phase = 1.0;
      for (std::size_t n = 0; n < response.size(); ++n) {
        sums[n + 1] = sums[n] + response[n] * phase;
        phase *= turn;
      }
      const double noise = std::sqrt(data_.noise_power(0)[b] / static_cast<double>(judged) *
                                     places.samples_per_place * places.samples_per_place *
                                     static_cast<double>(stride));
      Complex shift =
          noise * data_.undo_filter(b) * std::pow(turn, -static_cast<double>(places.judged_begin));
      const Complex shift_per_entry = std::pow(turn, static_cast<double>(stride));
      const Eigen::Index row = 2 * others * bin + j;
      for (std::size_t e = 0; e < entries; ++e) {
        // Entering e strides later, the same response is that much later.
        const std::size_t late = e * stride;
        const std::size_t first = places.judged_begin > late ? places.judged_begin - late : 0;
        const Complex seen = shift * (sums[places.judged_end - late] - sums[first]);
        shown(row, static_cast<Eigen::Index>(e)) = seen.real();
        shown(row + others, static_cast<Eigen::Index>(e)) = seen.imag();
        shift *= shift_per_entry;
      }
    }
  }
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(shown.rows(), shown.rows());
  covariance.selfadjointView<Eigen::Lower>().rankUpdate(shown);
  for (Eigen::Index bin = 0; bin < bins; ++bin) {
    for (Eigen::Index j = 0; j < others; ++j) {
      const double half =
          0.5 * data_.noise_power(static_cast<std::size_t>(j) + 1)[static_cast<std::size_t>(bin)];
      const Eigen::Index row = 2 * others * bin + j;
      covariance(row, row) += half;
      covariance(row + others, row + others) += half;
    }
  }
  const Eigen::LLT<Eigen::MatrixXd, Eigen::Lower> factor(covariance);
  lowest_lower_inverse_ =
      factor.matrixL().solve(Eigen::MatrixXd::Identity(shown.rows(), shown.rows()));
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
  std::vector<Spectrum> offset;               ///< of a unit baseline of gauge 0, by gauge, judged
};

/// By bin, gauges by columns: one per parameter, the baseline of gauge 0, the residual itself.
std::vector<Eigen::MatrixXcd> BarLikelihood::bins_of(std::size_t shot, const Columns& columns) {
  const std::size_t bins = data_.judged_path().size();
  const auto others = static_cast<Eigen::Index>(columns.transfers.size());
  const auto parameters = static_cast<Eigen::Index>(model_.parameters());
  const std::vector<Spectrum> residual = residuals_of(shot, columns.transfers);
  const Eigen::Index wide = parameters + 2;
  std::vector<Eigen::MatrixXcd> bin(bins, Eigen::MatrixXcd::Zero(others, wide));
  const double baseline_sd = data_.baseline_sd(shot, 0);
  for (Eigen::Index j = 0; j < others; ++j) {
    const auto i = static_cast<std::size_t>(j);
    for (std::size_t k = 0; k < bins; ++k) {
      bin[k](j, parameters) = baseline_sd * columns.offset[i][k];
      bin[k](j, parameters + 1) = residual[i][k];
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
    rows.topRows(coupled) =
        (lowest_lower_inverse_.triangularView<Eigen::Lower>() * rows.topRows(coupled)).eval();
  }
  return rows;
}

ShotTerms BarLikelihood::terms_of(std::size_t shot, const Columns& columns) {
  const auto parameters = static_cast<Eigen::Index>(model_.parameters());
  const Eigen::MatrixXd rows = white(bins_of(shot, columns));
  const auto residuals = rows.col(parameters + 1);
  const auto offset = rows.col(parameters);
  const double offset_information = 1.0 + offset.squaredNorm();
  const double offset_gradient = offset.dot(residuals);
  ShotTerms terms;
  terms.chi2 = residuals.squaredNorm() - offset_gradient * offset_gradient / offset_information;
  const auto J = rows.leftCols(parameters);
  const Eigen::VectorXd coupling = J.transpose() * offset;
  terms.gradient = J.transpose() * residuals - coupling * (offset_gradient / offset_information);
  terms.information = J.transpose() * J;
  terms.information -= coupling * coupling.transpose() / offset_information;
  return terms;
}

std::vector<ShotTerms> BarLikelihood::evaluate(std::span<const double> at, std::size_t shots) {
  Columns columns;
  columns.transfers = model_.transfers(at, data_.path(), true);
  columns.passages = model_.first_passages(at, data_.judged_path(), true);
  for (const auto& transfer : columns.transfers) {
    columns.offset.push_back(judged_product(transfer.g, data_.unit_offset()));
  }
  std::vector<ShotTerms> terms;
  for (std::size_t shot = 0; shot < std::min(shots, data_.shots()); ++shot) {
    terms.push_back(terms_of(shot, columns));
  }
  return terms;
}

}  // namespace kolsky
