#include "processing/criticism/comparing/drawn_noise.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace kolsky {

namespace {

/// Share of a response's energy in the later half of the record.
constexpr double kRings = 1e-3;
/// Nothing is drawn where the filter passes less.
constexpr double kFilterPasses = 1e-4;

}  // namespace

bool rings_on(const PlainResiduals& plain, std::size_t judged) {
  return std::ranges::any_of(plain.responses, [&](const std::vector<double>& response) {
    const Eigen::Map<const Eigen::VectorXd> all(response.data(),
                                                static_cast<Eigen::Index>(response.size()));
    const auto late = static_cast<Eigen::Index>(plain.before + judged / 2);
    return all.tail(all.size() - late).squaredNorm() > kRings * all.squaredNorm();
  });
}

DrawnNoise::DrawnNoise(const WhiteResiduals& residuals, const PlainResiduals& plain)
    : residuals_(residuals),
      before_(plain.before),
      quiet_(residuals.campaign().shots.front().quiet_samples / residuals.band().decimation),
      samples_(residuals.band().judged + 2 * plain.before),
      transform_(DampedTransform::of_window(quick_transform_length(2 * samples_),
                                            residuals.judged_period_s())) {
  const JudgedBand& band = residuals.band();
  while (filter_.size() < transform_.bins()) {
    const double ratio =
        static_cast<double>(filter_.size()) * transform_.bin_width_Hz() / band.filter_Hz;
    const double passes = std::exp(-std::numbers::ln2 * std::pow(ratio, 4));
    if (passes < kFilterPasses) {
      break;
    }
    filter_.push_back(passes);
  }
  for (const std::vector<double>& response : plain.responses) {
    transform_.forward(response, responses_.emplace_back(filter_.size()));
  }
  // Its power is that of the judged window's transform.
  const double longer = static_cast<double>(transform_.length()) / static_cast<double>(band.judged);
  Eigen::MatrixXd covariance;
  for (std::size_t k = 0; k < band.bins_judged; ++k) {
    residuals.noise().put_covariance_but_steps(k, covariance);
    factor_.emplace_back((longer * covariance).llt().matrixL());
  }
}

Complex DrawnNoise::sign() {
  const auto bits = random_();
  const double half = std::sqrt(0.5);
  return {(bits & 1U) != 0 ? half : -half, (bits & 2U) != 0 ? half : -half};
}

/// Each gauge's, at any time. What is slower or quicker than what is judged is as what is next to
/// it.
std::vector<DrawnNoise::Spectrum> DrawnNoise::spectra() {
  const auto gauges = static_cast<std::size_t>(factor_.front().rows());
  const double per_bin = transform_.bin_width_Hz() / residuals_.band().bin_width_Hz;
  std::vector<Spectrum> out(gauges, Spectrum(filter_.size()));
  Spectrum signs(gauges);
  for (std::size_t f = 0; f < filter_.size(); ++f) {
    const auto bin = static_cast<std::size_t>(std::lround(static_cast<double>(f) * per_bin));
    const Eigen::MatrixXd& factor = factor_[std::clamp<std::size_t>(bin, 1, factor_.size()) - 1];
    for (std::size_t j = 0; j < gauges; ++j) {
      signs[j] = sign();
      for (std::size_t i = 0; i <= j; ++i) {
        out[j][f] += factor(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(i)) * signs[i];
      }
    }
  }
  return out;
}

/// Zero on average before the pulse, as records are.
std::vector<double> DrawnNoise::record_of(const Spectrum& spectrum) {
  std::vector<double> record(samples_);
  transform_.inverse(spectrum, record);
  Eigen::Map<Eigen::VectorXd> values(record.data(), static_cast<Eigen::Index>(record.size()));
  values.array() -= values.head(static_cast<Eigen::Index>(quiet_)).mean();
  return record;
}

/// What a response makes of a record, over the judged window.
void DrawnNoise::put_carried(const std::vector<double>& record, const Spectrum& response,
                             std::vector<double>& out) {
  Spectrum spectrum(filter_.size());
  transform_.forward(record, spectrum);
  std::transform(spectrum.begin(), spectrum.end(), response.begin(), spectrum.begin(),
                 std::multiplies<>());
  // Responses begin before lag 0 by as much as the record does before the window.
  transform_.inverse(spectrum, out, 2 * before_);
}

std::vector<std::vector<double>> DrawnNoise::next() {
  std::vector<Spectrum> drawn = spectra();
  const std::vector<std::size_t>& others = residuals_.others();
  const std::size_t judged = residuals_.band().judged;
  const std::vector<double> reference = record_of(drawn[residuals_.campaign().reference]);
  std::vector<std::vector<double>> list;
  std::vector<double> carried(judged);
  for (std::size_t i = 0; i < others.size(); ++i) {
    Spectrum& own = drawn[others[i]];
    std::vector<double>& residual = list.emplace_back(judged);
    if (responses_.size() > others.size()) {
      put_carried(record_of(own), responses_[others.size()], residual);
    } else {
      std::transform(own.begin(), own.end(), filter_.begin(), own.begin(), std::multiplies<>());
      const std::vector<double> record = record_of(own);
      std::copy_n(record.begin() + static_cast<std::ptrdiff_t>(before_), judged, residual.begin());
    }
    put_carried(reference, responses_[i], carried);
    std::transform(residual.begin(), residual.end(), carried.begin(), residual.begin(),
                   std::minus<>());
  }
  return list;
}

}  // namespace kolsky
