#include "processing/criticism/carried_noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kolsky {

namespace {

/// A part that forgets within so many samples of the sums is white to them.
constexpr double kWhiteBelow = 6.0;
/// Blocks are shorter than what forgets fastest by this.
constexpr double kBlocksPerTime = 4.0;
constexpr std::size_t kLongestBlock = 16;
constexpr std::size_t kBlocksInQuiet = 8;
/// A response has ended where it stays below this share of its peak.
constexpr double kEnded = 1e-7;

double time_of(double keep) {
  return -1.0 / std::log(keep);
}

std::size_t end_of(const std::vector<double>& response, double peak) {
  std::size_t end = response.size();
  while (end > 0 && std::abs(response[end - 1]) <= kEnded * peak) {
    --end;
  }
  return end;
}

}  // namespace

/// A bin's partial sums of the filters' transforms, by what of a record's sample v comes to stand
/// in the window. From `same_from` to `same_to` all of every response does.
struct CarriedNoise::Sums {
  std::vector<Eigen::VectorXd> real, imaginary;
  std::size_t same_from = 0;
  std::size_t same_to = 0;

  /// Sum over v of filter i times the conjugate of filter j.
  [[nodiscard]] Complex product(std::size_t i, std::size_t j) const {
    const auto part = [&](std::size_t from, std::size_t to) {
      const auto at = static_cast<Eigen::Index>(from);
      const auto count = static_cast<Eigen::Index>(to - from);
      const auto ar = real[i].segment(at, count);
      const auto ai = imaginary[i].segment(at, count);
      const auto br = real[j].segment(at, count);
      const auto bi = imaginary[j].segment(at, count);
      return i == j ? Complex(ar.squaredNorm() + ai.squaredNorm())
                    : Complex(ar.dot(br) + ai.dot(bi), ai.dot(br) - ar.dot(bi));
    };
    const auto whole = static_cast<std::size_t>(real[i].size());
    Complex sum = part(0, same_from) + part(same_to, whole);
    if (same_to > same_from) {
      sum += static_cast<double>(same_to - same_from) * part(same_from, same_from + 1);
    }
    return sum;
  }
};

CarriedNoise::CarriedNoise(const NoiseSpectrum& spectrum, double least_power,
                           const WindowInRecord& window, std::size_t bins)
    : window_(window) {
  stride_ = std::max<std::size_t>(1, static_cast<std::size_t>(0.5 / window.filter_cycles));
  judged_ = window.judged / stride_;
  before_ = window.before / stride_;
  whole_ = judged_ + 2 * before_;
  const auto coarse = static_cast<double>(stride_ * window.decimation);
  std::vector<NoiseSpectrum::SlowPart> quick;
  std::vector<NoiseSpectrum::SlowPart> slow;
  block_ = kLongestBlock;
  for (const NoiseSpectrum::SlowPart& part : spectrum.slow_parts()) {
    const double time = time_of(part.keep) / coarse;
    if (time > kWhiteBelow) {
      slow.push_back(part);
      block_ = std::clamp<std::size_t>(static_cast<std::size_t>(time / kBlocksPerTime), 1, block_);
    } else {
      quick.push_back(part);
    }
  }
  const std::size_t quiet = std::max<std::size_t>(1, window.quiet / stride_);
  block_ = std::clamp<std::size_t>(quiet / kBlocksInQuiet, 1, block_);
  quiet_blocks_ = std::clamp<std::size_t>((quiet + block_ / 2) / block_, 1, whole_ / block_);
  const auto block = static_cast<double>(block_);
  for (const NoiseSpectrum::SlowPart& part : slow) {
    const double keep = std::pow(part.keep, coarse);
    double within = block;
    double ahead = 0.0;
    double behind = 0.0;
    for (std::size_t n = 0; n < block_; ++n) {
      const auto apart = static_cast<double>(n);
      within += n > 0 ? 2.0 * (block - apart) * std::pow(keep, apart) : 0.0;
      ahead += std::pow(keep, apart);
      behind += std::pow(keep, -apart);
    }
    slow_.push_back({part.variance, within / (block * block), ahead * behind / (block * block),
                     std::pow(keep, block)});
  }
  for (std::size_t k = 0; k < bins; ++k) {
    const double per_judged = static_cast<double>(k + 1) / static_cast<double>(window.judged);
    const double cycles = per_judged / static_cast<double>(window.decimation);
    double power = spectrum.power(cycles);
    for (const NoiseSpectrum::SlowPart& part : slow) {
      power -= part.power(cycles);
    }
    Turn turn;
    turn.white = std::max(power, least_power) / coarse;
    const auto samples = static_cast<Eigen::Index>(whole_);
    const double step = -2.0 * std::numbers::pi * per_judged * static_cast<double>(stride_);
    turn.cosine.resize(samples);
    turn.sine.resize(samples);
    turn.blocks.setZero(static_cast<Eigen::Index>((whole_ + block_ - 1) / block_));
    for (Eigen::Index n = 0; n < samples; ++n) {
      const double phase = step * (static_cast<double>(n) - static_cast<double>(before_));
      turn.cosine[n] = std::cos(phase);
      turn.sine[n] = std::sin(phase);
      turn.blocks[n / static_cast<Eigen::Index>(block_)] += Complex(turn.cosine[n], turn.sine[n]);
    }
    turns_.push_back(std::move(turn));
  }
}

std::vector<CarriedBin> CarriedNoise::through(
    std::span<const std::vector<double>> responses) const {
  const std::size_t filters = responses.size();
  const auto scale = static_cast<double>(stride_);
  // From a coarse lag -before_ to the finer index.
  const std::size_t shift = window_.before - before_ * stride_;
  std::vector<std::vector<double>> coarse(filters);
  std::size_t end = 0;
  for (std::size_t i = 0; i < filters; ++i) {
    double peak = 0.0;
    for (std::size_t n = 0; n < whole_; ++n) {
      coarse[i].push_back(scale * responses[i][shift + n * stride_]);
      peak = std::max(peak, std::abs(coarse[i].back()));
    }
    end = std::max(end, end_of(coarse[i], peak));
  }
  Sums sums;
  sums.real.assign(filters, Eigen::VectorXd(static_cast<Eigen::Index>(whole_)));
  sums.imaginary = sums.real;
  sums.same_from = std::min(2 * before_, whole_);
  sums.same_to = std::max(sums.same_from, whole_ - std::min(end, whole_) + 1);
  std::vector<CarriedBin> bins(turns_.size());
  for (std::size_t k = 0; k < bins.size(); ++k) {
    const Turn& turn = turns_[k];
    CarriedBin& bin = bins[k];
    bin.ratio.resize(static_cast<Eigen::Index>(filters));
    for (std::size_t i = 0; i < filters; ++i) {
      double* real = sums.real[i].data();
      double* imaginary = sums.imaginary[i].data();
      double re = 0.0;
      double im = 0.0;
      for (std::size_t n = 0; n < whole_; ++n) {
        re += coarse[i][n] * turn.cosine[static_cast<Eigen::Index>(n)];
        im += coarse[i][n] * turn.sine[static_cast<Eigen::Index>(n)];
        real[whole_ - 1 - n] = re;
        imaginary[whole_ - 1 - n] = im;
      }
      // What arrives before the window begins never stands in it.
      double early_re = 0.0;
      double early_im = 0.0;
      for (std::size_t n = 0; n < 2 * before_; ++n) {
        early_re += coarse[i][n] * turn.cosine[static_cast<Eigen::Index>(n)];
        early_im += coarse[i][n] * turn.sine[static_cast<Eigen::Index>(n)];
        real[2 * before_ - 1 - n] -= early_re;
        imaginary[2 * before_ - 1 - n] -= early_im;
      }
      const auto from = static_cast<Eigen::Index>(before_);
      const auto count = static_cast<Eigen::Index>(judged_);
      bin.ratio[static_cast<Eigen::Index>(i)] = {sums.real[i].segment(from, count).mean(),
                                                 sums.imaginary[i].segment(from, count).mean()};
    }
    add_to(bin, turn, sums);
    bin.power *= scale * scale;
  }
  return bins;
}

void CarriedNoise::add_to(CarriedBin& bin, const Turn& turn, const Sums& sums) const {
  const auto filters = static_cast<Eigen::Index>(sums.real.size());
  Eigen::MatrixXcd square(filters, filters);
  for (Eigen::Index i = 0; i < filters; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      square(i, j) = sums.product(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
      square(j, i) = std::conj(square(i, j));
    }
  }
  // Sums over blocks of what is carried, turned back to the sample's own time.
  Eigen::MatrixXcd blocks(filters, turn.blocks.size());
  for (Eigen::Index i = 0; i < filters; ++i) {
    const Eigen::VectorXd& re = sums.real[static_cast<std::size_t>(i)];
    const Eigen::VectorXd& im = sums.imaginary[static_cast<std::size_t>(i)];
    for (Eigen::Index m = 0; m < blocks.cols(); ++m) {
      const auto first = static_cast<std::size_t>(m) * block_;
      const std::size_t last = std::min(first + block_, whole_);
      if (first >= sums.same_from && last <= sums.same_to) {
        const auto at = static_cast<Eigen::Index>(first);
        blocks(i, m) = Complex(re[at], im[at]) * turn.blocks[m];
        continue;
      }
      double sum_re = 0.0;
      double sum_im = 0.0;
      for (auto v = static_cast<Eigen::Index>(first); v < static_cast<Eigen::Index>(last); ++v) {
        sum_re += re[v] * turn.cosine[v] - im[v] * turn.sine[v];
        sum_im += re[v] * turn.sine[v] + im[v] * turn.cosine[v];
      }
      blocks(i, m) = {sum_re, sum_im};
    }
  }
  const auto quiet = static_cast<Eigen::Index>(quiet_blocks_);
  const auto quiet_samples = static_cast<double>(quiet_blocks_ * block_);
  const Eigen::VectorXcd offset = blocks.rowwise().sum() / quiet_samples;
  const Eigen::VectorXcd of_quiet = blocks.leftCols(quiet).rowwise().sum();
  bin.power = turn.white * (square - of_quiet * offset.adjoint() - offset * of_quiet.adjoint() +
                            quiet_samples * offset * offset.adjoint());
  if (slow_.empty()) {
    return;
  }
  blocks.leftCols(quiet).colwise() -= static_cast<double>(block_) * offset;
  const Eigen::MatrixXcd itself = blocks * blocks.adjoint();
  Eigen::MatrixXcd earlier(filters, blocks.cols());
  for (const Part& part : slow_) {
    for (Eigen::Index i = 0; i < filters; ++i) {
      Complex sum = 0.0;
      for (Eigen::Index m = 0; m < blocks.cols(); ++m) {
        earlier(i, m) = part.keep * sum;
        sum = earlier(i, m) + blocks(i, m);
      }
    }
    const Eigen::MatrixXcd cross = blocks * earlier.adjoint();
    bin.power += part.variance * (part.within * itself + part.between * (cross + cross.adjoint()));
  }
}

}  // namespace kolsky
