// A measured pulse that runs to and fro in a bar with free ends: what its first passage foretells
// of the later ones, with and without dispersion.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "processing/waves/bar_modes.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {
namespace {

constexpr double kStep_s = 80e-9;  // ten samples of the scope taken together
constexpr std::size_t kTogether = 10;
constexpr int kPasses = 7;

/// Voltage over time in the fourth and fifth column of a scope's export.
std::vector<double> trace(const std::filesystem::path& path) {
  std::vector<double> volts;
  std::ifstream file(path);
  std::size_t samples = 0;
  for (std::string line; std::getline(file, line);) {
    std::istringstream cells(line);
    std::string cell;
    for (int i = 0; i < 5; ++i) {
      std::getline(cells, cell, ',');
    }
    const double volt = std::strtod(cell.c_str(), nullptr);
    if (samples++ % kTogether == 0) {
      volts.push_back(0.0);
    }
    volts.back() += volt / static_cast<double>(kTogether);
  }
  volts.pop_back();
  const auto quiet = static_cast<std::size_t>(50e-6 / kStep_s);
  double baseline = 0.0;
  for (std::size_t n = 0; n < quiet; ++n) {
    baseline += volts[n] / static_cast<double>(quiet);
  }
  for (double& volt : volts) {
    volt -= baseline;
  }
  return volts;
}

/// The two numbers that times of travel leave open: half the round trip and by how much the gauge
/// is nearer to the far end than to the specimen, both in metres at the filed rod speed.
struct Travel {
  double length_m = 0.0;
  double nearer_m = 0.0;
  double loss_per_m = 0.0;  ///< of amplitude, whatever takes it; 0 unless asked for

  /// From the first passage to the n-th, n = 1 the second.
  [[nodiscard]] double way_m(int n) const { return n * length_m - (n % 2 == 1 ? nearer_m : 0.0); }
};

class Passes {
 public:
  /// @param from_s, to_s  where the peak of the first passage is
  /// @param band_Hz       of the low-pass
  Passes(std::vector<double> record, const Bar& bar, WaveTheory theory, double from_s, double to_s,
         double band_Hz)
      : band_Hz_(band_Hz),
        record_(std::move(record)),
        transform_(2 * record_.size(), kStep_s, kLeftAtEnd),
        spectrum_(transform_.bins()) {
    const ElasticSolid solid(*bar.youngs_modulus_Pa);
    std::vector<Complex> path;
    const auto bins = static_cast<std::size_t>(2.0 * band_Hz_ / transform_.bin_width_Hz());
    for (std::size_t k = 0; k < bins; ++k) {
      path.push_back(transform_.s(k));
    }
    modes_ = bar_modes(theory, bar, solid, path);
    transform_.forward(record_, spectrum_);
    taper(spectrum_);
    transform_.inverse(spectrum_, record_);
    const auto at = [&](double time_s) {
      return record_.begin() + static_cast<std::ptrdiff_t>(time_s / kStep_s);
    };
    const auto peak =
        std::max_element(at(from_s), at(to_s), [](double a, double b) { return a * a < b * b; });
    peak_ = static_cast<std::size_t>(peak - record_.begin());
    std::vector<double> first(record_.size(), 0.0);
    const std::size_t begin = begin_of(0);
    std::copy_n(record_.begin() + static_cast<std::ptrdiff_t>(begin), window(),
                first.begin() + static_cast<std::ptrdiff_t>(begin));
    transform_.forward(first, spectrum_);
  }

  /// Rms of what a passage is off, over that of the passages themselves.
  [[nodiscard]] double off(int n, const Travel& travel) {
    std::vector<Complex> there(transform_.bins(), 0.0);
    for (std::size_t k = 0; k < modes_.size(); ++k) {
      const double sign = n % 2 == 1 ? -1.0 : 1.0;
      there[k] =
          sign * spectrum_[k] * std::exp(-(modes_[k].gamma + travel.loss_per_m) * travel.way_m(n));
    }
    std::vector<double> foretold(record_.size());
    transform_.inverse(there, foretold);
    double difference = 0.0;
    double size = 0.0;
    for (std::size_t m = begin_of(n); m < begin_of(n) + window(); ++m) {
      difference += std::pow(foretold[m] - record_[m], 2);
      size += std::pow(record_[m], 2);
    }
    return std::sqrt(difference / size);
  }

  [[nodiscard]] double off_all(const Travel& travel) {
    double sum = 0.0;
    for (int n = 1; n < kPasses; ++n) {
      sum += std::pow(off(n, travel), 2) / (kPasses - 1);
    }
    return std::sqrt(sum);
  }

  /// By halving steps in all numbers.
  [[nodiscard]] Travel best(bool with_loss) {
    Travel travel{0.2034, 0.0, 0.0};
    double least = off_all(travel);
    const auto attempt = [&](const Travel& other) {
      const double its = off_all(other);
      if (its < least) {
        least = its;
        travel = other;
        return true;
      }
      return false;
    };
    for (double step_m = 2e-3; step_m > 1e-5; step_m /= 2.0) {
      const double loss = with_loss ? 50.0 * step_m : 0.0;
      for (bool better = true; better;) {
        better = false;
        for (const double way : {1.0, -1.0}) {
          const auto [length_m, nearer_m, loss_per_m] = travel;
          better = attempt({length_m + way * step_m, nearer_m, loss_per_m}) || better;
          better = attempt({travel.length_m, travel.nearer_m + way * step_m, travel.loss_per_m}) ||
                   better;
          better = (loss > 0.0 &&
                    attempt({travel.length_m, travel.nearer_m, travel.loss_per_m + way * loss})) ||
                   better;
        }
      }
    }
    return travel;
  }

 private:
  /// Next to no damping: none of what is cut at the band's end must grow.
  static constexpr double kLeftAtEnd = 0.5;

  void taper(std::vector<Complex>& spectrum) const {
    for (std::size_t k = 0; k < spectrum.size(); ++k) {
      const double over = static_cast<double>(k) * transform_.bin_width_Hz() / band_Hz_;
      spectrum[k] *= std::exp(-std::pow(over, 4));
    }
  }
  static std::size_t window() { return static_cast<std::size_t>(34e-6 / kStep_s); }
  /// A passage comes each 40.27 us; it begins 12 us before the first one's peak.
  [[nodiscard]] std::size_t begin_of(int n) const {
    return peak_ - static_cast<std::size_t>(12e-6 / kStep_s) +
           static_cast<std::size_t>(40.27e-6 * n / kStep_s);
  }

  double band_Hz_;
  std::vector<double> record_;
  DampedTransform transform_;
  std::vector<Complex> spectrum_;
  std::vector<BarMode> modes_;
  std::size_t peak_ = 0;
};

/// What both theories leave of all passages, each with its own best travel numbers.
struct Left {
  double elementary = 0.0, exact = 0.0;

  /// The share of the misfit that exact waves take away.
  [[nodiscard]] double fall() const { return 1.0 - exact / elementary; }
};

struct Rod {
  const char* name;
  std::array<const char*, 2> channels;
  double from_s, to_s;  ///< where the peak of the first passage is
  bool lossy;           ///< with a loss for both theories
};

/// Both gauges of a place taken together: bending goes.
std::vector<double> axial(const std::filesystem::path& folder, const Rod& rod) {
  const auto file = [&](std::size_t i) {
    return folder / ("180303_171828_" + std::string(rod.channels[i]) + ".csv");
  };
  std::vector<double> record = trace(file(0));
  const std::vector<double> other = trace(file(1));
  for (std::size_t n = 0; n < record.size(); ++n) {
    record[n] = 0.5 * (record[n] + other[n]);
  }
  return record;
}

Left left_of(const std::vector<double>& record, const Bar& bar, const Rod& rod, double band_Hz) {
  Passes elementary(record, bar, WaveTheory::elementary, rod.from_s, rod.to_s, band_Hz);
  Passes exact(record, bar, WaveTheory::exact, rod.from_s, rod.to_s, band_Hz);
  const Travel slow = elementary.best(rod.lossy);
  const Travel fast = exact.best(rod.lossy);
  const Left left{elementary.off_all(slow), exact.off_all(fast)};
  std::printf(
      "%s bar to %.1f MHz: elementary %.2f %% (L %.2f mm, loss %.2f /m), exact %.2f %% "
      "(L %.2f mm, loss %.2f /m), falls by %.1f %%\n",
      rod.name, 1e-6 * band_Hz, 100.0 * left.elementary, 1e3 * slow.length_m, slow.loss_per_m,
      100.0 * left.exact, 1e3 * fast.length_m, fast.loss_per_m, 100.0 * left.fall());
  for (const int n : {1, kPasses - 1}) {
    std::printf("  after %.3f m: elementary off by %.1f %%, exact by %.1f %%\n", fast.way_m(n),
                100.0 * elementary.off(n, slow), 100.0 * exact.off(n, fast));
  }
  return left;
}

// Exact waves lag behind the elementary speed by (nu k a)^2 / 4, so that what they explain grows
// with the band: at 500 kHz dispersion is smallest.
TEST(MeasuredPasses, ExactWavesForetellThemBetterTheMoreTheHigherTheBand) {
  const auto folder = std::filesystem::path(KOLSKY_SHARED_DATA) / "real/lanl-mini-kolsky-pmma";
  if (!std::filesystem::exists(folder)) {
    GTEST_SKIP() << "no " << folder;
  }
  Bar bar;
  bar.length_m = {0.2034};
  bar.section = Section::square;
  bar.side_m = Measured{2.11e-3};
  bar.diameter_m = {2.381e-3};
  bar.density_kg_m3 = {2810.0};
  bar.poisson_ratio = {0.332714};
  bar.youngs_modulus_Pa = Measured{71.7e9};
  for (const Rod& rod : {Rod{"input", {"Ch1", "Ch2"}, 112e-6, 130e-6, false},
                         Rod{"lossy input", {"Ch1", "Ch2"}, 112e-6, 130e-6, true},
                         Rod{"output", {"Ch3", "Ch4"}, 110e-6, 150e-6, false}}) {
    SCOPED_TRACE(rod.name);
    const std::vector<double> record = axial(folder, rod);
    double fall = 0.0;
    for (const double band_Hz : {0.5e6, 1e6, 2e6}) {
      const Left left = left_of(record, bar, rod, band_Hz);
      EXPECT_GT(left.fall(), fall) << band_Hz;
      fall = left.fall();
    }
  }
}

}  // namespace
}  // namespace kolsky
