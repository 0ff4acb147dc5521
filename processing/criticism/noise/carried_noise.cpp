#include "processing/criticism/noise/carried_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "processing/base/wide.hpp"
#include "processing/waves/each_exp.hpp"

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

/// At least one sample, of a response that is nothing too.
std::size_t end_of(const std::vector<double>& response, double peak) {
  std::size_t end = response.size();
  while (end > 1 && std::abs(response[end - 1]) <= kEnded * peak) {
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
  [[gnu::always_inline]] void add_conjugate(const FourNumbers& other) {
    re += other.re;
    im -= other.im;
  }
  [[nodiscard, gnu::always_inline]] FourNumbers times(const Four& factor) const {
    return {re * factor, im * factor};
  }
};

namespace {

KOLSKY_WIDE void add_all(const FourNumbers* from, std::size_t size, FourNumbers& sum) {
  for (std::size_t v = 0; v < size; ++v) sum.add(1.0, from[v]);
}

KOLSKY_WIDE void add_squares(const FourNumbers* a, std::size_t size, FourNumbers& sum) {
  for (std::size_t v = 0; v < size; ++v) sum.add_square(a[v]);
}

KOLSKY_WIDE void put_products(const FourNumbers& a, const FourNumbers* b, std::size_t size,
                              FourNumbers* out) {
  for (std::size_t v = 0; v < size; ++v) {
    FourNumbers product;
    product.add_product(a, b[v]);
    out[v] = product;
  }
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
/// @param end  of the response
KOLSKY_WIDE void add_up(const double* response, const FourNumbers* turn, std::size_t end,
                        std::size_t whole, std::size_t before_twice, FourNumbers* sums) {
  // Each sum waits for the one before it, unless four are made beside it.
  FourNumbers sum;
  std::size_t done = 0;
  for (; done + 4 <= end; done += 4) {
    FourNumbers further;
    for (std::size_t n = done; n < done + 4; ++n) {
      further.add(response[n], turn[n]);
      FourNumbers& own = sums[whole - 1 - n];
      own = sum;
      own.add(1.0, further);
    }
    sum.add(1.0, further);
  }
  for (std::size_t n = done; n < end; ++n) {
    sum.add(response[n], turn[n]);
    sums[whole - 1 - n] = sum;
  }
  for (std::size_t n = end; n < whole; ++n) {
    sums[whole - 1 - n] = sum;
  }
  // What arrives before the window begins never stands in it.
  FourNumbers early;
  for (std::size_t n = 0; n < before_twice; ++n) {
    early.add(response[n], turn[n]);
    sums[before_twice - 1 - n].add(-1.0, early);
  }
}

/// What noise that forgets leaves from the blocks before each.
KOLSKY_WIDE void put_earlier(const FourNumbers* blocks, std::size_t size, double keep,
                             FourNumbers* earlier) {
  FourNumbers sum;
  for (std::size_t m = 0; m < size; ++m) {
    earlier[m] = FourNumbers{};
    earlier[m].add(keep, sum);
    sum = earlier[m];
    sum.add(1.0, blocks[m]);
  }
}

}  // namespace

struct CarriedNoise::FourBins {
  Four white{};                     ///< power per sample of the sums
  std::vector<FourNumbers> turn;    ///< exp(-i w t), t from the record's start on
  std::vector<FourNumbers> blocks;  ///< its sums over blocks
};

/// Responses at the sums' strides, and what they carry.
struct CarriedNoise::Carried {
  std::vector<std::vector<double>> responses;
  std::vector<std::size_t> ends;
  std::vector<bool> as_known;  ///< responses that are those of what this was made from
  std::size_t block_count = 0;
  std::vector<FourNumbers> sums;  ///< by four bins; below

  [[nodiscard]] std::size_t filters() const { return responses.size(); }
  /// Summed over samples: filter i times the conjugate of j, j up to i.
  [[nodiscard]] std::size_t product(std::size_t four, std::size_t i, std::size_t j) const {
    return four * per_four() + i * (i + 1) / 2 + j;
  }
  /// Summed over the judged window.
  [[nodiscard]] std::size_t window(std::size_t four, std::size_t i) const {
    return four * per_four() + pairs() + i;
  }
  /// Summed over blocks of samples, the first of them.
  [[nodiscard]] std::size_t blocks(std::size_t four, std::size_t i) const {
    return four * per_four() + pairs() + filters() + i * block_count;
  }
  [[nodiscard]] std::size_t per_four() const { return pairs() + filters() * (1 + block_count); }

  [[nodiscard]] std::vector<bool> alike(const Carried& other) const {
    std::vector<bool> alike(filters());
    for (std::size_t i = 0; i < filters() && filters() == other.filters(); ++i) {
      alike[i] = responses[i] == other.responses[i];
    }
    return alike;
  }

 private:
  [[nodiscard]] std::size_t pairs() const { return filters() * (filters() + 1) / 2; }
};

/// Four bins' partial sums of the filters' transforms, by what of a record's sample v comes to
/// stand in the window. From `same_from` on all of a response does, until it has no time to end.
struct CarriedNoise::PartialSums {
  std::vector<std::vector<FourNumbers>> of;  ///< by filter and v
  std::vector<std::size_t> same_to;          ///< by filter
  std::size_t same_from = 0;

  void make_room(const Carried& carried, std::size_t whole, std::size_t before) {
    of.resize(carried.filters());
    same_from = std::min(2 * before, whole);
    same_to.clear();
    for (std::size_t i = 0; i < of.size(); ++i) {
      of[i].resize(whole);
      same_to.push_back(std::max(same_from, whole - std::min(carried.ends[i], whole) + 1));
    }
  }

  /// Sum over v of filter i times the conjugate of filter j.
  [[nodiscard]] FourNumbers product(std::size_t i, std::size_t j) const {
    const auto part = [&](std::size_t from, std::size_t to, FourNumbers& sum) {
      if (i == j) {
        add_squares(of[i].data() + from, to - from, sum);
      } else {
        add_products_with_conjugates(of[i].data() + from, of[j].data() + from, to - from, sum);
      }
    };
    const std::size_t until = std::min(same_to[i], same_to[j]);
    FourNumbers sum;
    FourNumbers after;
    part(0, same_from, sum);
    part(until, of[i].size(), after);
    sum.add(1.0, after);
    if (until > same_from) {
      FourNumbers one;
      part(same_from, same_from + 1, one);
      sum.add(static_cast<double>(until - same_from), one);
    }
    return sum;
  }

  /// Sums over blocks of what filter i carries, turned back to the sample's own time.
  void put_blocks(std::size_t i, std::size_t block, const FourBins& four, FourNumbers* out) const {
    for (std::size_t m = 0; m < four.blocks.size(); ++m) {
      const std::size_t first = m * block;
      const std::size_t last = std::min(first + block, of[i].size());
      out[m] = FourNumbers{};
      if (first >= same_from && last <= same_to[i]) {
        out[m].add_product(of[i][first], four.blocks[m]);
      } else {
        add_products(of[i].data() + first, four.turn.data() + first, last - first, out[m]);
      }
    }
  }
};

/// Four bins' blocks, sums of them and power, filters x filters.
struct CarriedNoise::Room {
  std::vector<std::vector<FourNumbers>> blocks;   ///< by filter, less the baseline's share
  std::vector<std::vector<FourNumbers>> earlier;  ///< by filter, what slow noise keeps of them
  std::vector<FourNumbers> offset;
  std::vector<FourNumbers> of_quiet;
  std::vector<FourNumbers> power;  ///< i with j up to i
};

struct CarriedNoise::Memory::State {
  std::vector<Carried> kept;  ///< what served last at the end
  Carried spare;
  PartialSums sums;
  Room room;

  /// Of what is kept, the one with most responses alike; null where none is.
  [[nodiscard]] const Carried* nearest(Carried& to) {
    std::ptrdiff_t most = 0;
    auto best = kept.end();
    to.as_known.assign(to.filters(), false);
    for (auto it = kept.begin(); it != kept.end(); ++it) {
      std::vector<bool> alike = to.alike(*it);
      const auto count = std::count(alike.begin(), alike.end(), true);
      if (count > most) {
        most = count;
        best = it;
        to.as_known = std::move(alike);
      }
    }
    if (best == kept.end()) {
      return nullptr;
    }
    std::rotate(best, best + 1, kept.end());
    return &kept.back();
  }

  void keep_spare() {
    constexpr std::size_t kMost = 6;
    kept.push_back(std::move(spare));
    spare = Carried{};
    if (kept.size() > kMost) {
      spare = std::move(kept.front());
      kept.erase(kept.begin());
    }
  }
};

CarriedNoise::Memory::Memory() : state_(std::make_unique<State>()) {}
CarriedNoise::Memory::~Memory() = default;

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
  for (std::size_t k = 0; k < bins; ++k) {
    const double per_judged = static_cast<double>(k + 1) / static_cast<double>(window.judged);
    const double cycles = per_judged / static_cast<double>(window.decimation);
    double power = spectrum.power(cycles);
    for (const NoiseSpectrum::SlowPart& part : slow) {
      power -= part.power(cycles);
    }
    four_[k / kTogether].white[k % kTogether] = std::max(power, least_power) / coarse;
  }
  put_turns();
}

void CarriedNoise::put_turns() {
  // Whole steps of the judged window's own circle.
  std::vector<Complex> circle(window_.judged);
  for (std::size_t n = 0; n < circle.size(); ++n) {
    const double share = static_cast<double>(n) / static_cast<double>(circle.size());
    circle[n] = {0.0, -2.0 * std::numbers::pi * share};
  }
  each_exp(circle);
  /// Four bins' turns, the next always so many strides after the one before.
  const auto each_turn = [&](std::size_t g, std::size_t from, std::size_t apart) {
    std::array<std::size_t, kTogether> place{};
    std::array<std::size_t, kTogether> step{};
    for (std::size_t lane = 0; lane < kTogether; ++lane) {
      const std::size_t stride = (g * kTogether + lane + 1) * stride_;
      place[lane] = stride * from % circle.size();
      step[lane] = stride * apart % circle.size();
    }
    return [place, step, &circle]() mutable {
      FourNumbers turn;
      for (std::size_t lane = 0; lane < kTogether; ++lane) {
        turn.re[lane] = circle[place[lane]].real();
        turn.im[lane] = circle[place[lane]].imag();
        place[lane] += step[lane];
        place[lane] -= place[lane] >= circle.size() ? circle.size() : 0;
      }
      return turn;
    };
  };
  constexpr std::size_t kAtOnce = 32;
  std::array<FourNumbers, kAtOnce> turns;
  for (std::size_t g = 0; g < four_.size(); ++g) {
    FourBins& four = four_[g];
    std::generate(turns.begin(), turns.end(), each_turn(g, 0, 1));
    auto begun = each_turn(g, circle.size() - before_ % circle.size(), kAtOnce);
    four.turn.resize(whole_);
    for (std::size_t first = 0; first < whole_; first += kAtOnce) {
      put_products(begun(), turns.data(), std::min(kAtOnce, whole_ - first), &four.turn[first]);
    }
    four.blocks.resize((whole_ + block_ - 1) / block_);
    for (std::size_t m = 0; m < four.blocks.size(); ++m) {
      const std::size_t first = m * block_;
      add_all(&four.turn[first], std::min(block_, whole_ - first), four.blocks[m]);
    }
  }
}

CarriedNoise::~CarriedNoise() = default;

void CarriedNoise::put_at_strides(std::span<const std::vector<double>> responses,
                                  Carried& out) const {
  const auto scale = static_cast<double>(stride_);
  // From a coarse lag -before_ to the finer index.
  const std::size_t shift = window_.before - before_ * stride_;
  out.responses.resize(responses.size());
  out.ends.resize(responses.size());
  for (std::size_t i = 0; i < responses.size(); ++i) {
    out.responses[i].resize(whole_);
    double peak = 0.0;
    for (std::size_t n = 0; n < whole_; ++n) {
      const double value = scale * responses[i][shift + n * stride_];
      out.responses[i][n] = value;
      peak = std::max(peak, std::abs(value));
    }
    out.ends[i] = end_of(out.responses[i], peak);
  }
  out.block_count = four_.front().blocks.size();
  out.sums.resize(four_.size() * out.per_four());
}

void CarriedNoise::through(std::span<const std::vector<double>> responses, Memory& memory,
                           std::vector<CarriedBin>& bins) const {
  Memory::State& state = *memory.state_;
  Carried& now = state.spare;
  put_at_strides(responses, now);
  const Carried* known = state.nearest(now);
  const bool all_known =
      std::find(now.as_known.begin(), now.as_known.end(), false) == now.as_known.end();
  if (!all_known) {
    state.sums.make_room(now, whole_, before_);
    for (std::size_t g = 0; g < four_.size(); ++g) {
      for (std::size_t i = 0; i < now.filters(); ++i) {
        add_up(now.responses[i].data(), four_[g].turn.data(), now.ends[i], whole_, 2 * before_,
               state.sums.of[i].data());
      }
      carry(state.sums, g, known, now);
    }
    state.keep_spare();
    known = &state.kept.back();
  }
  bins.resize(bins_);
  const auto rows = static_cast<Eigen::Index>(responses.size());
  for (std::size_t g = 0; g < four_.size(); ++g) {
    put_noise_in(*known, g, state.room);
    for (std::size_t k = g * kTogether; k < std::min(bins_, (g + 1) * kTogether); ++k) {
      const std::size_t lane = k % kTogether;
      bins[k].ratio.resize(rows);
      bins[k].power.resize(rows, rows);
      auto power = state.room.power.begin();
      for (Eigen::Index i = 0; i < rows; ++i) {
        const FourNumbers& sum = known->sums[known->window(g, static_cast<std::size_t>(i))];
        bins[k].ratio[i] = sum.at(lane) / static_cast<double>(judged_);
        for (Eigen::Index j = 0; j <= i; ++j) {
          const Complex own = (power++)->at(lane);
          bins[k].power(i, j) = own;
          bins[k].power(j, i) = std::conj(own);
        }
      }
    }
  }
}

/// @param known  what holds the responses that are as known; null: none is
void CarriedNoise::carry(const PartialSums& sums, std::size_t four, const Carried* known,
                         Carried& out) const {
  for (std::size_t i = 0; i < out.filters(); ++i) {
    const auto blocks = out.sums.begin() + static_cast<std::ptrdiff_t>(out.blocks(four, i));
    if (out.as_known[i]) {
      out.sums[out.window(four, i)] = known->sums[known->window(four, i)];
      std::copy_n(known->sums.begin() + static_cast<std::ptrdiff_t>(known->blocks(four, i)),
                  out.block_count, blocks);
    } else {
      FourNumbers window;
      add_all(sums.of[i].data() + before_, judged_, window);
      out.sums[out.window(four, i)] = window;
      sums.put_blocks(i, block_, four_[four], &*blocks);
    }
    for (std::size_t j = 0; j <= i; ++j) {
      out.sums[out.product(four, i, j)] = out.as_known[i] && out.as_known[j]
                                              ? known->sums[known->product(four, i, j)]
                                              : sums.product(i, j);
    }
  }
}

/// Four bins' power of what is carried, from its sums: of white noise less its quiet mean, and of
/// slow noise likewise.
void CarriedNoise::put_noise_in(const Carried& carried, std::size_t four, Room& room) const {
  const std::size_t filters = carried.filters();
  const auto quiet_samples = static_cast<double>(quiet_blocks_ * block_);
  const Four scale = Four{} + static_cast<double>(stride_ * stride_);
  const Four white = scale * four_[four].white;
  room.offset.assign(filters, FourNumbers{});
  room.of_quiet.assign(filters, FourNumbers{});
  room.power.clear();
  for (std::size_t i = 0; i < filters; ++i) {
    const FourNumbers* blocks = carried.sums.data() + carried.blocks(four, i);
    FourNumbers all;
    add_all(blocks, carried.block_count, all);
    room.offset[i].add(1.0 / quiet_samples, all);
    add_all(blocks, quiet_blocks_, room.of_quiet[i]);
    for (std::size_t j = 0; j <= i; ++j) {
      FourNumbers taken_off;
      taken_off.add_product_with_conjugate(room.of_quiet[i], room.offset[j]);
      taken_off.add_product_with_conjugate(room.offset[i], room.of_quiet[j]);
      FourNumbers offsets;
      offsets.add_product_with_conjugate(room.offset[i], room.offset[j]);
      FourNumbers sum = carried.sums[carried.product(four, i, j)];
      sum.add(-1.0, taken_off);
      sum.add(quiet_samples, offsets);
      room.power.push_back(sum.times(white));
    }
  }
  if (slow_.empty()) {
    return;
  }
  room.blocks.resize(filters);
  for (std::size_t i = 0; i < filters; ++i) {
    const FourNumbers* blocks = carried.sums.data() + carried.blocks(four, i);
    room.blocks[i].assign(blocks, blocks + carried.block_count);
    for (std::size_t m = 0; m < quiet_blocks_; ++m) {
      room.blocks[i][m].add(-static_cast<double>(block_), room.offset[i]);
    }
  }
  add_slow_noise(filters, room);
}

void CarriedNoise::add_slow_noise(std::size_t filters, Room& room) const {
  const auto scale = static_cast<double>(stride_ * stride_);
  room.earlier.resize(filters);
  for (const Part& part : slow_) {
    for (std::size_t i = 0; i < filters; ++i) {
      room.earlier[i].resize(room.blocks[i].size());
      put_earlier(room.blocks[i].data(), room.blocks[i].size(), part.keep, room.earlier[i].data());
    }
    auto power = room.power.begin();
    for (std::size_t i = 0; i < filters; ++i) {
      const std::size_t count = room.blocks[i].size();
      for (std::size_t j = 0; j <= i; ++j, ++power) {
        FourNumbers itself;
        FourNumbers ahead;
        FourNumbers behind;
        add_products_with_conjugates(room.blocks[i].data(), room.blocks[j].data(), count, itself);
        add_products_with_conjugates(room.blocks[i].data(), room.earlier[j].data(), count, ahead);
        add_products_with_conjugates(room.blocks[j].data(), room.earlier[i].data(), count, behind);
        ahead.add_conjugate(behind);
        power->add(scale * part.variance * part.within, itself);
        power->add(scale * part.variance * part.between, ahead);
      }
    }
  }
}

}  // namespace kolsky
