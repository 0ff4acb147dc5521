#include "processing/criticism/carried_noise.hpp"

#include <algorithm>
#include <array>
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

/// Bins go through the sums four at a time.
using Four = Eigen::Array4d;
constexpr std::size_t kTogether = 4;

/// A complex number for each of four bins.
struct CarriedNoise::Turned {
  Four re = Four::Zero();
  Four im = Four::Zero();

  [[nodiscard]] Complex at(std::size_t lane) const {
    const auto i = static_cast<Eigen::Index>(lane);
    return {re[i], im[i]};
  }
  void add(double weight, const Turned& turn) {
    re += weight * turn.re;
    im += weight * turn.im;
  }
  void add_product(const Turned& a, const Turned& b) {
    re += a.re * b.re - a.im * b.im;
    im += a.re * b.im + a.im * b.re;
  }
  void add_product_with_conjugate(const Turned& a, const Turned& b) {
    re += a.re * b.re + a.im * b.im;
    im += a.im * b.re - a.re * b.im;
  }
  void add_square(const Turned& a) { re += a.re * a.re + a.im * a.im; }
};

struct CarriedNoise::FourBins {
  Four white = Four::Zero();   ///< power per sample of the sums
  std::vector<Turned> turn;    ///< exp(-i w t), t from the record's start on
  std::vector<Turned> blocks;  ///< its sums over blocks
};

/// Four bins' partial sums of the filters' transforms, by what of a record's sample v comes to
/// stand in the window. From `same_from` to `same_to` all of every response does.
struct CarriedNoise::Sums {
  std::vector<std::vector<Turned>> of;  ///< by filter and v
  std::size_t same_from = 0;
  std::size_t same_to = 0;

  /// Sum over v of filter i times the conjugate of filter j.
  [[nodiscard]] Turned product(std::size_t i, std::size_t j) const {
    const auto part = [&](std::size_t from, std::size_t to) {
      Turned sum;
      for (std::size_t v = from; v < to; ++v) {
        if (i == j) {
          sum.add_square(of[i][v]);
        } else {
          sum.add_product_with_conjugate(of[i][v], of[j][v]);
        }
      }
      return sum;
    };
    Turned sum = part(0, same_from);
    sum.add(1.0, part(same_to, of[i].size()));
    if (same_to > same_from) {
      sum.add(static_cast<double>(same_to - same_from), part(same_from, same_from + 1));
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
  bins_ = bins;
  four_.resize((bins + kTogether - 1) / kTogether);
  for (FourBins& four : four_) {
    four.turn.resize(whole_);
    four.blocks.resize((whole_ + block_ - 1) / block_);
  }
  std::vector<Complex> circle(window.judged);
  for (std::size_t n = 0; n < window.judged; ++n) {
    circle[n] = std::polar(
        1.0, -2.0 * std::numbers::pi * static_cast<double>(n) / static_cast<double>(window.judged));
  }
  for (std::size_t k = 0; k < bins; ++k) {
    FourBins& four = four_[k / kTogether];
    const auto lane = static_cast<Eigen::Index>(k % kTogether);
    const double per_judged = static_cast<double>(k + 1) / static_cast<double>(window.judged);
    const double cycles = per_judged / static_cast<double>(window.decimation);
    double power = spectrum.power(cycles);
    for (const NoiseSpectrum::SlowPart& part : slow) {
      power -= part.power(cycles);
    }
    four.white[lane] = std::max(power, least_power) / coarse;
    // Whole steps of the judged window's own circle.
    const std::size_t step = (k + 1) * stride_ % window.judged;
    std::size_t place = (window.judged - step * before_ % window.judged) % window.judged;
    for (std::size_t n = 0; n < whole_; ++n) {
      four.turn[n].re[lane] = circle[place].real();
      four.turn[n].im[lane] = circle[place].imag();
      place += step;
      place -= place >= window.judged ? window.judged : 0;
    }
  }
  for (FourBins& four : four_) {
    for (std::size_t n = 0; n < whole_; ++n) {
      four.blocks[n / block_].add(1.0, four.turn[n]);
    }
  }
}

CarriedNoise::~CarriedNoise() = default;

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
  sums.of.assign(filters, std::vector<Turned>(whole_));
  sums.same_from = std::min(2 * before_, whole_);
  sums.same_to = std::max(sums.same_from, whole_ - std::min(end, whole_) + 1);
  std::vector<CarriedBin> bins(four_.size() * kTogether);
  for (std::size_t g = 0; g < four_.size(); ++g) {
    for (std::size_t i = 0; i < filters; ++i) {
      add_up(coarse[i], four_[g], sums.of[i]);
    }
    take(sums, four_[g], std::span(bins).subspan(g * kTogether, kTogether));
  }
  bins.resize(bins_);
  return bins;
}

void CarriedNoise::add_up(const std::vector<double>& response, const FourBins& four,
                          std::vector<Turned>& sums) const {
  Turned sum;
  for (std::size_t n = 0; n < whole_; ++n) {
    sum.add(response[n], four.turn[n]);
    sums[whole_ - 1 - n] = sum;
  }
  // What arrives before the window begins never stands in it.
  Turned early;
  for (std::size_t n = 0; n < 2 * before_; ++n) {
    early.add(response[n], four.turn[n]);
    sums[2 * before_ - 1 - n].add(-1.0, early);
  }
}

/// Sums over blocks of what is carried, turned back to the sample's own time.
std::vector<CarriedNoise::Turned> CarriedNoise::in_blocks(const std::vector<Turned>& sums,
                                                          std::size_t same_from,
                                                          std::size_t same_to,
                                                          const FourBins& four) const {
  std::vector<Turned> blocks(four.blocks.size());
  for (std::size_t m = 0; m < blocks.size(); ++m) {
    const std::size_t first = m * block_;
    const std::size_t last = std::min(first + block_, whole_);
    if (first >= same_from && last <= same_to) {
      blocks[m].add_product(sums[first], four.blocks[m]);
      continue;
    }
    for (std::size_t v = first; v < last; ++v) {
      blocks[m].add_product(sums[v], four.turn[v]);
    }
  }
  return blocks;
}

void CarriedNoise::take(const Sums& sums, const FourBins& four, std::span<CarriedBin> bins) const {
  const std::size_t filters = sums.of.size();
  const auto rows = static_cast<Eigen::Index>(filters);
  std::array<Eigen::MatrixXcd, kTogether> square;
  std::array<Eigen::MatrixXcd, kTogether> blocks;
  square.fill(Eigen::MatrixXcd(rows, rows));
  blocks.fill(Eigen::MatrixXcd(rows, static_cast<Eigen::Index>(four.blocks.size())));
  for (CarriedBin& bin : bins) {
    bin.ratio.resize(rows);
  }
  for (std::size_t i = 0; i < filters; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    Turned whole;
    for (std::size_t v = before_; v < before_ + judged_; ++v) {
      whole.add(1.0, sums.of[i][v]);
    }
    const std::vector<Turned> own = in_blocks(sums.of[i], sums.same_from, sums.same_to, four);
    for (std::size_t lane = 0; lane < kTogether; ++lane) {
      bins[lane].ratio[row] = whole.at(lane) / static_cast<double>(judged_);
      for (std::size_t m = 0; m < own.size(); ++m) {
        blocks[lane](row, static_cast<Eigen::Index>(m)) = own[m].at(lane);
      }
    }
    for (std::size_t j = 0; j <= i; ++j) {
      const Turned product = sums.product(i, j);
      const auto column = static_cast<Eigen::Index>(j);
      for (std::size_t lane = 0; lane < kTogether; ++lane) {
        square[lane](row, column) = product.at(lane);
        square[lane](column, row) = std::conj(product.at(lane));
      }
    }
  }
  const auto scale = static_cast<double>(stride_);
  for (std::size_t lane = 0; lane < kTogether; ++lane) {
    bins[lane].power =
        scale * scale *
        power_of(square[lane], blocks[lane], four.white[static_cast<Eigen::Index>(lane)]);
  }
}

/// @param square  sum over samples of what is carried times its conjugate
/// @param blocks  its sums over blocks, filters x blocks
Eigen::MatrixXcd CarriedNoise::power_of(const Eigen::MatrixXcd& square, Eigen::MatrixXcd& blocks,
                                        double white) const {
  const auto quiet = static_cast<Eigen::Index>(quiet_blocks_);
  const auto quiet_samples = static_cast<double>(quiet_blocks_ * block_);
  const Eigen::VectorXcd offset = blocks.rowwise().sum() / quiet_samples;
  const Eigen::VectorXcd of_quiet = blocks.leftCols(quiet).rowwise().sum();
  Eigen::MatrixXcd power =
      white * (square - of_quiet * offset.adjoint() - offset * of_quiet.adjoint() +
               quiet_samples * offset * offset.adjoint());
  if (slow_.empty()) {
    return power;
  }
  blocks.leftCols(quiet).colwise() -= static_cast<double>(block_) * offset;
  const Eigen::MatrixXcd itself = blocks * blocks.adjoint();
  Eigen::MatrixXcd earlier(blocks.rows(), blocks.cols());
  for (const Part& part : slow_) {
    for (Eigen::Index i = 0; i < blocks.rows(); ++i) {
      Complex sum = 0.0;
      for (Eigen::Index m = 0; m < blocks.cols(); ++m) {
        earlier(i, m) = part.keep * sum;
        sum = earlier(i, m) + blocks(i, m);
      }
    }
    const Eigen::MatrixXcd cross = blocks * earlier.adjoint();
    power += part.variance * (part.within * itself + part.between * (cross + cross.adjoint()));
  }
  return power;
}

}  // namespace kolsky
