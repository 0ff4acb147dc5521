#include "processing/identification/bar_likelihood.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "processing/identification/lowest_bins.hpp"

namespace kolsky {

namespace {

/// Bins of the lowest octave, over which residuals are averaged.
constexpr std::size_t kFirstOctave = 2;
/// In which the noise's powers come to within a few per cent of where they go.
constexpr int kRoundsOfNoise = 3;
/// In the logarithm of its power; deviations move by half of it.
constexpr double kNoiseThatMatters = 0.05;
/// Slow noise jumps from the end of what is judged to its beginning, which every bin sees alike: a
/// ramp's spectrum. That of gauge 0 shows at the others.
std::vector<BarData::Spectrum> jumps(const BarData& data, const BarNoise& noise) {
  const auto variance_of = [&](std::size_t gauge) {
    double variance = 0.0;
    for (const auto& part : noise.slow(gauge)) {
      variance += part.is_slow() ? 2.0 * part.variance : 0.0;
    }
    return variance;
  };
  const auto judged = static_cast<double>(data.places().judged());
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

/// What gauges' powers are to be expected to have been in a bin, gauge 0's first, where the others'
/// residuals scatter so.
/// @param echoes  mean square of what gauge 0's noise shows at the others
Eigen::VectorXd expected_powers(const Eigen::VectorXd& power, const Eigen::MatrixXcd& echoes,
                                const Eigen::MatrixXcd& scatter) {
  const Eigen::Index others = echoes.rows();
  Eigen::MatrixXcd covariance = power[0] * echoes;
  covariance.diagonal() += power.tail(others);
  const Eigen::LLT<Eigen::MatrixXcd> factor(covariance);
  const Eigen::MatrixXcd inverse = factor.solve(Eigen::MatrixXcd::Identity(others, others));
  const Eigen::MatrixXcd asked = inverse * scatter * inverse;
  const double first_given = (inverse * echoes).trace().real();
  const double first_asked = (asked * echoes).trace().real();
  Eigen::VectorXd expected(power.size());
  // The other end's answers make several of gauge 0's noise, and would have it overshoot.
  expected[0] = power[0] + power[0] * power[0] * (first_asked - first_given) /
                               std::max(1.0, power[0] * first_given);
  for (Eigen::Index j = 0; j < others; ++j) {
    const double own = power[j + 1];
    expected[j + 1] = own + own * own * (asked(j, j).real() - inverse(j, j).real());
  }
  return expected;
}

/// By so much that weights and deviations would follow.
bool moved(const BarNoise& before, const BarNoise& after) {
  for (std::size_t j = 0; j < before.power.size(); ++j) {
    for (std::size_t k = 0; k < before.power[j].size(); ++k) {
      if (std::abs(std::log(after.power[j][k] / before.power[j][k])) > kNoiseThatMatters) {
        return true;
      }
    }
  }
  return false;
}

NoiseArrivals::Times arrival_times(const BarData& data, const MovedBench& moved,
                                   const Compliance& compliance, bool comes_back) {
  const double speed_m_per_s = front_speed_m_per_s(moved.bar, compliance);
  const BarRecords& records = data.records().front();
  const BarData::Places& places = data.places();
  const auto way_back_s = [&](std::size_t gauge) {
    return 2.0 * (moved.bar.length_m - moved.position_m[gauge]) / speed_m_per_s;
  };
  NoiseArrivals::Times times{.turn_s = way_back_s(0), .judged_s = data.judged_s()};
  times.lead_s =
      (static_cast<double>(places.judged_begin) - places.records_begin) * places.period_s;
  for (std::size_t j = 1; j < data.gauges(); ++j) {
    times.first_s.push_back((moved.position_m[j] - moved.position_m[0]) / speed_m_per_s -
                            records.late_of_s(j));
    if (comes_back) {
      times.back_s.push_back(way_back_s(j));
    }
  }
  return times;
}

/// Normal numbers of variances v scatter in their squares' sum as (sum v)^2 / sum v^2 of one
/// variance do. Each v is known by what the shots do not have in common, n - 1 squares, so that
/// their own squares are too large by (n + 1) / (n - 1).
double count_as(const Eigen::Ref<const Eigen::MatrixXd>& own,
                const Eigen::Ref<const Eigen::VectorXd>& alike) {
  const auto numbers = static_cast<double>(own.rows());
  const auto apart = static_cast<double>(own.cols()) - 1.0;
  if (apart < 1.0) {
    return numbers;
  }
  const Eigen::VectorXd variances =
      (own.rowwise().squaredNorm() - alike.cwiseAbs2()).cwiseMax(0.0) / apart;
  const double squares = variances.squaredNorm() * apart / (apart + 2.0);
  return squares > 0.0 ? std::min(numbers, std::pow(variances.sum(), 2) / squares) : numbers;
}

}  // namespace

BarLikelihood::BarLikelihood(const BarData& data, BarModel model)
    : data_(data), judge_(data), model_(std::move(model)) {}

std::size_t BarLikelihood::residuals() const {
  return 2 * data_.judged_path().size() * (data_.gauges() - 1) * data_.shots();
}

std::size_t BarLikelihood::count_of(Shots which) const {
  switch (which) {
    case Shots::each:
      return data_.shots();
    case Shots::telling:
      return data_.telling();
    case Shots::noise_alone:
      return noise_alone_.size();
    case Shots::as_one:
      break;
  }
  return 1;
}

std::size_t BarLikelihood::first_of(Shots which) const {
  switch (which) {
    case Shots::each:
      return 0;
    case Shots::noise_alone:
      return data_.shots() + data_.telling();
    default:
      return data_.all_as_one();
  }
}

const BarLikelihood::Spectrum& BarLikelihood::damped_of_first(std::size_t shot) const {
  const std::size_t drawn = first_of(Shots::noise_alone);
  return shot < drawn ? data_.spectrum(shot, 0) : noise_alone_[shot - drawn].damped[0];
}

const BarLikelihood::Spectrum& BarLikelihood::judged_of(std::size_t shot, std::size_t gauge) const {
  const std::size_t drawn = first_of(Shots::noise_alone);
  return shot < drawn ? data_.judged(shot, gauge) : noise_alone_[shot - drawn].judged[gauge];
}

Eigen::VectorXd BarLikelihood::gradient_of_noise_alone(std::span<const double> at) {
  constexpr std::size_t kDraws = 16;
  noise_alone_ = data_.noise_alone(weights_->noise, kDraws);
  (void)chi2_at(at, Shots::noise_alone);
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model_.parameters()));
  for (const ShotTerms& shot : terms()) {
    mean += shot.gradient / static_cast<double>(kDraws);
  }
  return mean;
}

double BarLikelihood::left_of_a_return(std::span<const double> at) {
  const double R = model_.reflection(at);
  const std::vector<Complex> middle{data_.judged_path()[data_.judged_path().size() / 2]};
  return R != 0.0 ? std::abs(R * model_.returns(at, middle)[0][0]) : 0.0;
}

/// g is its first passage times (1 + R q_j) times the sum of (-R q_0)^i.
std::vector<NoiseArrivals::Shown> BarLikelihood::echoes(std::span<const double> at) {
  const auto passages = model_.first_passages(at, data_.judged_path(), false);
  const auto others = static_cast<std::size_t>(this->others());
  const double R = model_.reflection(at);
  const auto returns =
      R != 0.0 ? model_.returns(at, data_.judged_path()) : std::vector<BarModel::Spectrum>{};
  const NoiseArrivals arrivals(arrival_times(data_, model_.moved(at), *model_.solid(at), R != 0.0));
  std::vector<NoiseArrivals::Shown> list;
  std::vector<Complex> first(others);
  std::vector<Complex> back(others);
  for (std::size_t k = 0; k < data_.judged_path().size(); ++k) {
    for (std::size_t j = 0; j < others; ++j) {
      first[j] = passages.g[j][k];
      back[j] = R != 0.0 ? R * returns[j + 1][k] : Complex(0.0);
    }
    list.push_back(arrivals.shown(first, back, R != 0.0 ? -R * returns[0][k] : Complex(0.0)));
  }
  return list;
}

BarLikelihood::Whitening BarLikelihood::whitening(std::span<const double> at, BarNoise noise) {
  const Eigen::Index others = this->others();
  const std::vector<NoiseArrivals::Shown> echoes = this->echoes(at);
  Whitening whitening;
  for (std::size_t k = 0; k < echoes.size(); ++k) {
    const double power_of_first = noise.power[0][k];
    Eigen::MatrixXcd covariance = power_of_first * echoes[k].mean_square;
    for (Eigen::Index j = 0; j < others; ++j) {
      covariance(j, j) += noise.power[static_cast<std::size_t>(j) + 1][k];
    }
    const Eigen::LLT<Eigen::MatrixXcd> factor(covariance);
    // Real and imaginary part of a bin carry half of its power each.
    const Eigen::MatrixXcd inverse = factor.matrixL().solve(
        Eigen::MatrixXcd(Eigen::MatrixXcd::Identity(others, others) * std::numbers::sqrt2));
    const Eigen::RowVectorXcd of_first = power_of_first * factor.solve(echoes[k].mean).adjoint();
    for (Eigen::Index j = 0; j < others; ++j) {
      whitening.noise_of_first.push_back(of_first[j]);
      for (Eigen::Index l = 0; l <= j; ++l) {
        whitening.lower_inverse.push_back(inverse(j, l));
      }
    }
  }
  whitening.noise = std::move(noise);
  return whitening;
}

/// By expectation and maximisation: what the gauges' own noise is to be expected to have been, the
/// residuals given, is fitted beside the quiet samples.
std::optional<BarNoise> BarLikelihood::noise_by_residuals() {
  if (data_.shots() < 2) {
    return std::nullopt;
  }
  const std::vector<NoiseArrivals::Shown> echoes = this->echoes(place_.at);
  const std::vector<Eigen::MatrixXcd> scatter = scatter_of_residuals(echoes);
  BarNoise noise = data_.noise_with(expected_noise(weights_->noise, echoes, scatter));
  if (!moved(weights_->noise, noise)) {
    return std::nullopt;
  }
  for (int round = 1; round < kRoundsOfNoise; ++round) {
    noise = data_.noise_with(expected_noise(noise, echoes, scatter));
  }
  return noise;
}

/// By gauge.
std::vector<NoiseSpectrum::Seen> BarLikelihood::expected_noise(
    const BarNoise& noise, const std::vector<NoiseArrivals::Shown>& echoes,
    const std::vector<Eigen::MatrixXcd>& scatter) const {
  const auto gauges = static_cast<Eigen::Index>(data_.gauges());
  std::vector<NoiseSpectrum::Seen> seen(data_.gauges());
  for (NoiseSpectrum::Seen& own : seen) {
    own.samples = static_cast<double>(data_.places().judged()) * data_.places().samples_per_place;
    own.stretches = static_cast<double>(data_.shots()) - 1.0;
  }
  Eigen::VectorXd power(gauges);
  for (std::size_t k = 0; k < echoes.size(); ++k) {
    const double cycles = static_cast<double>(k + 1) / seen[0].samples;
    for (Eigen::Index j = 0; j < gauges; ++j) {
      const auto gauge = static_cast<std::size_t>(j);
      power[j] = std::max(noise.spectra[gauge].power_within(cycles, seen[0].samples),
                          data_.least_noise(gauge));
    }
    const Eigen::VectorXd expected =
        expected_powers(power, echoes[k].mean_square, scatter[k] / data_.power_of_unit());
    for (std::size_t j = 0; j < data_.gauges(); ++j) {
      seen[j].cycles.push_back(cycles);
      seen[j].power.push_back(expected[static_cast<Eigen::Index>(j)]);
    }
  }
  return seen;
}

/// What turns the shots' residuals in a bin into what a wrong model of the bar leaves of all of
/// them: it leaves its own share of each shot's wave, whatever that wave's shape. The waves are
/// those that all gauges together see, each by its noise: gauge 0's reading by itself has the noise
/// in it that every residual has, too, and where a pulse is hardly more than that, residuals of the
/// true model would lie along it. A model that is far off carries the others' readings to waves
/// that are none, and leaves more than any noise does: by gauge 0 alone, then.
/// @return by bin and shot, of squares that add up to 1
std::vector<std::vector<Complex>> BarLikelihood::along_waves(
    const std::vector<NoiseArrivals::Shown>& echoes) const {
  constexpr double kFarOff = 2.0;  // of reduced chi2
  const double chi2 = std::accumulate(place_.chi2.begin(), place_.chi2.end(), 0.0);
  const bool far = chi2 > kFarOff * static_cast<double>(residuals());
  const std::vector<std::vector<double>>& power = weights_->noise.power;
  std::vector<std::vector<Complex>> list;
  for (std::size_t k = 0; k < echoes.size(); ++k) {
    std::vector<Complex>& along = list.emplace_back();
    double squares = 0.0;
    for (std::size_t shot = 0; shot < data_.shots(); ++shot) {
      Complex wave = data_.judged(shot, 0)[k] / power[0][k];
      for (Eigen::Index j = 0; j < others() && !far; ++j) {
        const auto gauge = static_cast<std::size_t>(j) + 1;
        wave += std::conj(echoes[k].mean[j]) * data_.judged(shot, gauge)[k] / power[gauge][k];
      }
      along.push_back(std::conj(wave));
      squares += std::norm(wave);
    }
    for (Complex& share : along) {
      share /= std::sqrt(squares);
    }
  }
  return list;
}

/// Mean over what is not along the shots' waves: what a model lacks leaves next to nothing there.
std::vector<Eigen::MatrixXcd> BarLikelihood::scatter_of_residuals(
    const std::vector<NoiseArrivals::Shown>& echoes) const {
  const Eigen::Index others = this->others();
  const std::size_t shots = data_.shots();
  const std::vector<std::vector<Complex>> waves = along_waves(echoes);
  std::vector<Eigen::MatrixXcd> list;
  Eigen::MatrixXcd residuals(others, static_cast<Eigen::Index>(shots));
  for (std::size_t k = 0; k < data_.judged_path().size(); ++k) {
    for (std::size_t shot = 0; shot < shots; ++shot) {
      for (Eigen::Index j = 0; j < others; ++j) {
        residuals(j, static_cast<Eigen::Index>(shot)) =
            place_.residuals[shot][static_cast<std::size_t>(j)][k];
      }
    }
    Eigen::MatrixXcd& scatter = list.emplace_back(residuals * residuals.adjoint());
    const Eigen::VectorXcd common =
        residuals * Eigen::Map<const Eigen::VectorXcd>(waves[k].data(), residuals.cols());
    scatter -= common * common.adjoint();
    scatter /= static_cast<double>(shots) - 1.0;
  }
  return list;
}

/// Of each other gauge, in time, to what gauge 0 reads in the record's first sample.
std::vector<std::vector<double>> BarLikelihood::responses_to_first(std::span<const double> at) {
  const BarModel::Transfers transfers = model_.transfers(at, data_.path(), false);
  std::vector<std::vector<double>> responses;
  Spectrum product(data_.path().size());
  for (const Spectrum& g : transfers.g) {
    for (std::size_t k = 0; k < product.size(); ++k) {
      product[k] = g[k] * data_.unit_impulse()[k];
    }
    const std::span<const double> response = judge_.in_time(product);
    responses.emplace_back(response.begin(), response.end());
  }
  return responses;
}

BarLikelihood::Weights BarLikelihood::weights_at(std::span<const double> at, bool together,
                                                 const BarNoise& noise) {
  Whitening weights = whitening(at, noise);
  if (together) {
    weights.lowest_bins = bins_taken_together(data_, noise);
    weights.lowest_factor =
        factor_of_lowest_bins(data_, noise, responses_to_first(at), weights.lowest_bins);
  }
  return std::make_shared<const Whitening>(std::move(weights));
}

Eigen::Index BarLikelihood::rows() const {
  return 2 * others() * static_cast<Eigen::Index>(data_.judged_path().size());
}

void BarLikelihood::put(std::span<const Complex> spectrum, Eigen::Index gauge, Eigen::Index column,
                        std::size_t first_bin, EightColumns& columns) const {
  const Eigen::Index others = this->others();
  for (std::size_t k = first_bin; k < spectrum.size(); ++k) {
    const Eigen::Index row = 2 * others * static_cast<Eigen::Index>(k) + gauge;
    columns(row, column) = spectrum[k].real();
    columns(row + others, column) = spectrum[k].imag();
  }
}

/// To rows of unit variance each.
void BarLikelihood::whiten(EightColumns& columns) const {
  if (weights_->lowest_bins > 0) {
    weights_->lowest_factor.solve_in_place(columns);
  }
  whiten_above_lowest(columns);
}

void BarLikelihood::whiten_above_lowest(EightColumns& columns) const {
  const Eigen::Index others = this->others();
  const auto coupled = static_cast<Eigen::Index>(weights_->lowest_bins);
  const std::span<const Complex> triangles(weights_->lower_inverse);
  multiply_in_place(
      triangles.subspan(static_cast<std::size_t>(coupled * others * (others + 1) / 2)), others,
      2 * others * coupled, columns);
}

/// The baseline of gauge 0 and the gauges' jumps: in the lowest bins they lie in the covariance.
void BarLikelihood::look_at_nuisances() {
  place_.nuisances = EightColumns(rows(), 1 + others());
  const std::vector<Spectrum> jump = jumps(data_, weights_->noise);
  Spectrum offset(data_.judged_path().size());
  for (Eigen::Index j = 0; j < others(); ++j) {
    const auto i = static_cast<std::size_t>(j);
    judge_.judge_product(place_.transfers->g[i], data_.unit_offset(), offset);
    for (Complex& value : offset) {
      value *= weights_->noise.baseline_sd(0, 0);
    }
    put(offset, j, 0, weights_->lowest_bins, place_.nuisances);
    put(jump[i], j, 1 + j, weights_->lowest_bins, place_.nuisances);
  }
  whiten_above_lowest(place_.nuisances);
}

void BarLikelihood::look_at_residuals() {
  const std::size_t shots = place_.shots.size();
  place_.white_residuals = EightColumns(rows(), static_cast<Eigen::Index>(shots));
  place_.residuals.assign(shots, {});
  for (std::size_t index = 0; index < shots; ++index) {
    for (Eigen::Index j = 0; j < others(); ++j) {
      const auto i = static_cast<std::size_t>(j);
      Spectrum r(data_.judged_path().size());
      judge_.judge_product(place_.transfers->g[i], damped_of_first(place_.shots[index]), r);
      const Spectrum& own = judged_of(place_.shots[index], i + 1);
      for (std::size_t k = 0; k < r.size(); ++k) {
        r[k] = own[k] - r[k];
      }
      put(r, j, static_cast<Eigen::Index>(index), 0, place_.white_residuals);
      place_.residuals[index].push_back(std::move(r));
    }
  }
  whiten(place_.white_residuals);
}

double BarLikelihood::chi2_at(std::span<const double> at, Shots which) {
  place_.at.assign(at.begin(), at.end());
  place_.transfers = model_.transfers(at, data_.path(), true);
  place_.passages = model_.first_passages(at, data_.judged_path(), true);
  place_.shots.resize(count_of(which));
  std::iota(place_.shots.begin(), place_.shots.end(), first_of(which));
  look_at_nuisances();
  look_at_residuals();
  const Eigen::Index nuisances = 1 + others();
  const auto shots = static_cast<Eigen::Index>(place_.shots.size());
  const Eigen::MatrixXd among = square_of(place_.nuisances).topLeftCorner(nuisances, nuisances) +
                                Eigen::MatrixXd::Identity(nuisances, nuisances);
  const Eigen::LLT<Eigen::MatrixXd> known(among);
  double sum = 0.0;
  place_.chi2.clear();
  for (Eigen::Index shot = 0; shot < shots; ++shot) {
    double squares = 0.0;
    Eigen::VectorXd shared = Eigen::VectorXd::Zero(nuisances);
    for (Eigen::Index row = 0; row < rows(); ++row) {
      const double residual = place_.white_residuals(row, shot);
      squares += residual * residual;
      for (Eigen::Index n = 0; n < nuisances; ++n) {
        shared[n] += place_.nuisances(row, n) * residual;
      }
    }
    place_.chi2.push_back(squares - shared.dot(known.solve(shared)));
    sum += place_.chi2.back();
  }
  return sum;
}

/// What the parameters do to a shot's residuals.
void BarLikelihood::put_slopes(std::size_t index, const Slopes& slopes, EightColumns& columns) {
  const std::size_t bins = data_.judged_path().size();
  const std::size_t shot = place_.shots[index];
  const std::vector<Spectrum>& residual = place_.residuals[index];
  Spectrum noise_of_first(bins);
  for (std::size_t k = 0; k < bins; ++k) {
    for (std::size_t l = 0; l < residual.size(); ++l) {
      noise_of_first[k] += weights_->noise_of_first[k * residual.size() + l] * residual[l][k];
    }
  }
  columns.clear();
  Spectrum moved(bins);
  for (std::size_t i = 0; i < residual.size(); ++i) {
    const Spectrum& passages = place_.passages->g[i];
    for (std::size_t d = 0; d < slopes.transfers[i].size(); ++d) {
      const BarModel::Derivative& derivative = slopes.transfers[i][d];
      const BarModel::Derivative& passage = slopes.passages[i][d];
      if (derivative.proportion) {
        for (std::size_t k = 0; k < bins; ++k) {
          moved[k] = *derivative.proportion * (judged_of(shot, i + 1)[k] - residual[i][k]);
        }
      } else {
        judge_.judge_product(derivative.of_g, damped_of_first(shot), moved);
      }
      for (std::size_t k = 0; k < bins; ++k) {
        const Complex slope =
            passage.proportion ? *passage.proportion * passages[k] : passage.of_g[k];
        moved[k] = -moved[k] - slope * noise_of_first[k];
      }
      put(moved, static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(derivative.parameter), 0,
          columns);
    }
  }
}

ShotTerms BarLikelihood::terms_of(std::size_t index, const Slopes& slopes, EightColumns& columns) {
  const auto parameters = static_cast<Eigen::Index>(model_.parameters());
  const Eigen::Index nuisances = 1 + others();
  put_slopes(index, slopes, columns);
  whiten(columns);
  for (Eigen::Index row = 0; row < columns.rows(); ++row) {
    columns(row, parameters) = place_.white_residuals(row, static_cast<Eigen::Index>(index));
    for (Eigen::Index n = 0; n < nuisances; ++n) {
      columns(row, parameters + 1 + n) = place_.nuisances(row, n);
    }
  }
  const Eigen::MatrixXd square = square_of(columns);
  const auto of_nuisances = square.middleRows(parameters + 1, nuisances);
  const Eigen::LLT<Eigen::MatrixXd> known(Eigen::MatrixXd::Identity(nuisances, nuisances) +
                                          of_nuisances.middleCols(parameters + 1, nuisances));
  const Eigen::MatrixXd in_slopes = of_nuisances.leftCols(parameters);
  ShotTerms terms;
  terms.chi2 = place_.chi2[index];
  terms.gradient = square.col(parameters).head(parameters) -
                   in_slopes.transpose() * known.solve(of_nuisances.col(parameters));
  terms.information =
      square.topLeftCorner(parameters, parameters) - in_slopes.transpose() * known.solve(in_slopes);
  return terms;
}

BarLikelihood::Slopes BarLikelihood::slopes() const {
  return {model_.derivatives(place_.at, data_.path(), *place_.transfers),
          model_.derivatives(place_.at, data_.judged_path(), *place_.passages)};
}

/// The first columns less what the nuisances make of them.
Eigen::MatrixXd BarLikelihood::without_nuisances(const EightColumns& columns,
                                                 Eigen::Index count) const {
  const Eigen::Index nuisances = 1 + others();
  Eigen::MatrixXd own(rows(), count);
  Eigen::MatrixXd shared(rows(), nuisances);
  for (Eigen::Index row = 0; row < rows(); ++row) {
    for (Eigen::Index c = 0; c < count; ++c) {
      own(row, c) = columns(row, c);
    }
    for (Eigen::Index n = 0; n < nuisances; ++n) {
      shared(row, n) = place_.nuisances(row, n);
    }
  }
  const Eigen::MatrixXd among =
      shared.transpose() * shared + Eigen::MatrixXd::Identity(nuisances, nuisances);
  const Eigen::LLT<Eigen::MatrixXd> known(among);
  own -= shared * known.solve(shared.transpose() * own);
  return own;
}

std::vector<std::size_t> BarLikelihood::octaves() const {
  const std::size_t bins = data_.judged_path().size();
  std::vector<std::size_t> firsts{0};
  while (firsts.back() < bins) {
    firsts.push_back(std::min(bins, std::max(firsts.back() + kFirstOctave, 2 * firsts.back())));
  }
  return firsts;
}

std::vector<OctaveLeft> BarLikelihood::left_over() {
  const auto shots = static_cast<Eigen::Index>(data_.shots());
  const Eigen::MatrixXd own = without_nuisances(place_.white_residuals, shots);
  const std::vector<std::vector<Complex>> waves = along_waves(echoes(place_.at));
  Eigen::VectorXd alike(rows());
  for (Eigen::Index row = 0; row < rows(); row += 2 * others()) {
    const Eigen::Map<const Eigen::VectorXcd> shares(
        waves[static_cast<std::size_t>(row / (2 * others()))].data(), shots);
    const auto real = own.middleRows(row, others());
    const auto imaginary = own.middleRows(row + others(), others());
    alike.segment(row, others()) = real * shares.real() - imaginary * shares.imag();
    alike.segment(row + others(), others()) = real * shares.imag() + imaginary * shares.real();
  }
  const auto frequency_Hz = [&](std::size_t bin) {
    return data_.judged_path()[bin].imag() / (2.0 * std::numbers::pi);
  };
  const std::vector<std::size_t> firsts = octaves();
  std::vector<OctaveLeft> list;
  for (std::size_t i = 0; i + 1 < firsts.size(); ++i) {
    const Eigen::Index begin = first_row(firsts[i]);
    const Eigen::Index count = first_row(firsts[i + 1]) - begin;
    const auto numbers = static_cast<double>(count);
    list.push_back(
        {frequency_Hz(firsts[i]), frequency_Hz(firsts[i + 1] - 1), numbers,
         own.middleRows(begin, count).squaredNorm() / (numbers * static_cast<double>(shots)),
         alike.segment(begin, count).squaredNorm() / numbers,
         count_as(own.middleRows(begin, count), alike.segment(begin, count))});
  }
  return list;
}

NoiseInSums BarLikelihood::noise_in_sums() {
  const std::span<const double> own = judge_.in_time(data_.unit_impulse());
  const std::vector<double> own_response(own.begin(), own.end());
  return {data_, weights_->noise, responses_to_first(place_.at), own_response};
}

/// (sum of variances)^2 / sum of squared covariances, both by what noise makes of sums with signs
/// drawn at random: such a sum's mean square is the first, two sums' mean squared product the
/// other.
double BarLikelihood::independent_numbers(std::size_t octave) {
  constexpr Eigen::Index kDrawn = 32;  // 496 pairs
  const std::vector<std::size_t> firsts = octaves();
  Eigen::MatrixXd signs = Eigen::MatrixXd::Zero(rows(), kDrawn);
  std::mt19937 random(1);
  for (Eigen::Index n = 0; n < kDrawn; ++n) {
    for (Eigen::Index row = first_row(firsts[octave]); row < first_row(firsts[octave + 1]); ++row) {
      signs(row, n) = random() % 2 == 0 ? 1.0 : -1.0;
    }
  }
  const Eigen::MatrixXd covariance = noise_in_sums().covariance(unwhitened(std::move(signs)));
  const double variances = covariance.diagonal().mean();
  const double off_diagonal = covariance.squaredNorm() - covariance.diagonal().squaredNorm();
  return variances * variances * (kDrawn * (kDrawn - 1)) / off_diagonal;
}

BarLikelihood::Scatter BarLikelihood::scatter_of_gradient(std::size_t as_it_is,
                                                          const std::vector<double>& power) {
  const auto parameters = static_cast<Eigen::Index>(model_.parameters());
  const std::vector<std::size_t> firsts = octaves();
  Eigen::VectorXd by_row(rows());
  for (std::size_t i = 0; i < power.size(); ++i) {
    const Eigen::Index begin = first_row(firsts[i]);
    const Eigen::Index count = first_row(firsts[i + 1]) - begin;
    by_row.segment(begin, count).setConstant(power[i]);
  }
  NoiseInSums noise = noise_in_sums();
  const Slopes moving = slopes();
  EightColumns columns(rows(), parameters);
  const Eigen::MatrixXd nothing = Eigen::MatrixXd::Zero(parameters, parameters);
  Scatter scatter{nothing, nothing};
  for (std::size_t index = 0; index < place_.shots.size(); ++index) {
    put_slopes(index, moving, columns);
    whiten(columns);
    const Eigen::MatrixXd white = without_nuisances(columns, parameters);
    scatter.beyond += white.transpose() * by_row.asDiagonal() * white;
    scatter.by_noise += index < as_it_is ? noise.covariance(unwhitened(white))
                                         : Eigen::MatrixXd(white.transpose() * white);
  }
  return scatter;
}

/// What sums over white rows sum over the residuals' bins, by gauge.
std::vector<Eigen::MatrixXcd> BarLikelihood::unwhitened(Eigen::MatrixXd white) const {
  const Eigen::Index others = this->others();
  const auto bins = static_cast<Eigen::Index>(data_.judged_path().size());
  const auto lowest = static_cast<Eigen::Index>(weights_->lowest_bins);
  if (lowest > 0) {
    weights_->lowest_factor.solve_transposed_in_place(white);
  }
  std::vector<Eigen::MatrixXcd> weights(static_cast<std::size_t>(others),
                                        Eigen::MatrixXcd::Zero(bins, white.cols()));
  for (Eigen::Index k = 0; k < bins; ++k) {
    const Complex* const triangle = weights_->lower_inverse.data() + k * others * (others + 1) / 2;
    for (Eigen::Index j = 0; j < others; ++j) {
      for (Eigen::Index l = 0; l <= j; ++l) {
        const Complex share =
            k < lowest ? Complex(j == l ? 1.0 : 0.0) : std::conj(triangle[j * (j + 1) / 2 + l]);
        for (Eigen::Index c = 0; c < white.cols(); ++c) {
          const Eigen::Index row = 2 * others * k + j;
          weights[static_cast<std::size_t>(l)](k, c) +=
              share * Complex(white(row, c), white(row + others, c));
        }
      }
    }
  }
  return weights;
}

std::vector<ShotTerms> BarLikelihood::terms() {
  const Slopes slopes = this->slopes();
  EightColumns columns(rows(), static_cast<Eigen::Index>(model_.parameters()) + 2 + others());
  std::vector<ShotTerms> list;
  for (std::size_t index = 0; index < place_.shots.size(); ++index) {
    list.push_back(terms_of(index, slopes, columns));
  }
  return list;
}

}  // namespace kolsky
