#include "processing/criticism/carried_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "processing/base/wide.hpp"

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
constexpr std::size_t kTogether = 4;
// The compiler's own vectors, not a library's, so that the wide versions of the loops below are.
using Four [[gnu::vector_size(kTogether * sizeof(double))]] = double;

/// A complex number for each of four bins. Aligned as the widest version takes it to be.
struct alignas(sizeof(Four)) FourNumbers {
  Four re{};
  Four im{};

  [[nodiscard]] Complex at(std::size_t lane) const { return {re[lane], im[lane]}; }
  [[gnu::always_inline]] void add(double weight, const FourNumbers& other) {
    re += weight * other.re;
    im += weight * other.im;
  }
  [[gnu::always_inline]] void add_product(const FourNumbers& a, const FourNumbers& b) {
    re += a.re * b.re - a.im * b.im;
    im += a.re * b.im + a.im * b.re;
  }
  [[gnu::always_inline]] void add_product_with_conjugate(const FourNumbers& a,
                                                         const FourNumbers& b) {
    re += a.re * b.re + a.im * b.im;
    im += a.im * b.re - a.re * b.im;
  }
  [[gnu::always_inline]] void add_square(const FourNumbers& a) { re += a.re * a.re + a.im * a.im; }
};

namespace {

KOLSKY_WIDE void add_all(const FourNumbers* from, std::size_t size, FourNumbers& sum) {
  for (std::size_t v = 0; v < size; ++v) sum.add(1.0, from[v]);
}

KOLSKY_WIDE void add_squares(const FourNumbers* a, std::size_t size, FourNumbers& sum) {
  for (std::size_t v = 0; v < size; ++v) sum.add_square(a[v]);
}

KOLSKY_WIDE void add_products(const FourNumbers* a, const FourNumbers* b, std::size_t size,
                              FourNumbers& sum) {
  for (std::size_t v = 0; v < size; ++v) sum.add_product(a[v], b[v]);
}

KOLSKY_WIDE void add_products_with_conjugates(const FourNumbers* a, const FourNumbers* b,
                                              std::size_t size, FourNumbers& sum) {
  for (std::size_t v = 0; v < size; ++v) sum.add_product_with_conjugate(a[v], b[v]);
}

/// A response's partial sums, by what of a record's sample comes to stand in the window.
KOLSKY_WIDE void add_up(const double* response, const FourNumbers* turn, std::size_t whole,
                        std::size_t before_twice, FourNumbers* sums) {
  FourNumbers sum;
  for (std::size_t n = 0; n < whole; ++n) {
    sum.add(response[n], turn[n]);
    sums[whole - 1 - n] = sum;
  }
  // What arrives before the window begins never stands in it.
  FourNumbers early;
  for (std::size_t n = 0; n < before_twice; ++n) {
    early.add(response[n], turn[n]);
    sums[before_twice - 1 - n].add(-1.0, early);
  }
}

}  // namespace

struct CarriedNoise::FourBins {
  Four white{};                     ///< power per sample of the sums
  std::vector<FourNumbers> turn;    ///< exp(-i w t), t from the record's start on
  std::vector<FourNumbers> blocks;  ///< its sums over blocks
};

/// Four bins' partial sums of the filters' transforms, by what of a record's sample v comes to
/// stand in the window. From `same_from` to `same_to` all of every response does.
struct CarriedNoise::Sums {
  std::vector<std::vector<FourNumbers>> of;  ///< by filter and v
  std::size_t same_from = 0;
  std::size_t same_to = 0;

  /// Sum over v of filter i times the conjugate of filter j.
  [[nodiscard]] FourNumbers product(std::size_t i, std::size_t j) const {
    const auto part = [&](std::size_t from, std::size_t to, FourNumbers& sum) {
      if (i == j) {
        add_squares(of[i].data() + from, to - from, sum);
      } else {
        add_products_with_conjugates(of[i].data() + from, of[j].data() + from, to - from, sum);
      }
    };
    FourNumbers sum;
    FourNumbers after;
    part(0, same_from, sum);
    part(same_to, of[i].size(), after);
    sum.add(1.0, after);
    if (same_to > same_from) {
      FourNumbers one;
      part(same_from, same_from + 1, one);
      sum.add(static_cast<double>(same_to - same_from), one);
    }
    return sum;
  }

  /// Sums over blocks of what filter i carries, turned back to the sample's own time.
  [[nodiscard]] std::vector<FourNumbers> in_blocks(std::size_t i, std::size_t block,
                                                   const FourBins& four) const {
    std::vector<FourNumbers> blocks(four.blocks.size());
    for (std::size_t m = 0; m < blocks.size(); ++m) {
      const std::size_t first = m * block;
      const std::size_t last = std::min(first + block, of[i].size());
      if (first >= same_from && last <= same_to) {
        blocks[m].add_product(of[i][first], four.blocks[m]);
      } else {
        add_products(of[i].data() + first, four.turn.data() + first, last - first, blocks[m]);
      }
    }
    return blocks;
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
    const std::size_t lane = k % kTogether;
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
  sums.of.assign(filters, std::vector<FourNumbers>(whole_));
  sums.same_from = std::min(2 * before_, whole_);
  sums.same_to = std::max(sums.same_from, whole_ - std::min(end, whole_) + 1);
  std::vector<CarriedBin> bins(four_.size() * kTogether);
  for (std::size_t g = 0; g < four_.size(); ++g) {
    for (std::size_t i = 0; i < filters; ++i) {
      add_up(coarse[i].data(), four_[g].turn.data(), whole_, 2 * before_, sums.of[i].data());
    }
    take(sums, four_[g], std::span(bins).subspan(g * kTogether, kTogether));
  }
  bins.resize(bins_);
  return bins;
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
    FourNumbers whole;
    add_all(sums.of[i].data() + before_, judged_, whole);
    const std::vector<FourNumbers> own = sums.in_blocks(i, block_, four);
    for (std::size_t lane = 0; lane < kTogether; ++lane) {
      bins[lane].ratio[row] = whole.at(lane) / static_cast<double>(judged_);
      for (std::size_t m = 0; m < own.size(); ++m) {
        blocks[lane](row, static_cast<Eigen::Index>(m)) = own[m].at(lane);
      }
    }
    for (std::size_t j = 0; j <= i; ++j) {
      const FourNumbers product = sums.product(i, j);
      const auto column = static_cast<Eigen::Index>(j);
      for (std::size_t lane = 0; lane < kTogether; ++lane) {
        square[lane](row, column) = product.at(lane);
        square[lane](column, row) = std::conj(product.at(lane));
      }
    }
  }
  const auto scale = static_cast<double>(stride_);
  for (std::size_t lane = 0; lane < kTogether; ++lane) {
    bins[lane].power = scale * scale * power_of(square[lane], blocks[lane], four.white[lane]);
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
