#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "processing/identification/bar_waves.hpp"

namespace kolsky {

/// What comes back from a bar's far end: the wave inverted (free), nothing (a momentum trap, or the
/// record ends before), or a share of it that is fitted.
enum class FarEndReturn { free, none, partial };

[[nodiscard]] std::string name_of(FarEndReturn far_end);

/// What is assumed of a bar: waves, solid, far end.
struct BarTheory {
  WaveTheory waves = WaveTheory::exact;
  SolidKind solid = SolidKind::three_element;
  FarEndReturn far_end = FarEndReturn::free;
  bool lossless = false;  ///< three elements of which E2 is too stiff to be seen: elastic
  friend bool operator==(const BarTheory&, const BarTheory&) = default;
};

/// How a bar's gauges follow its first one. With a_j a gauge's gain, l_j its length and R what the
/// far end returns of a stress (-1: free),
///   h_j = a_j sinhc(gamma l_j / 2) (exp(-gamma x_j) + R exp(-gamma (2 L - x_j))),
///   g_j = h_j / h_0, j = 1 .. gauges - 1: causal.
/// Of one gauge that stands for two (see split_passes), b later:
///   g_1 = -R exp(b s - gamma (x_1 - x_0)).
///
/// Parameters, in order: logarithms of the solid's, R where it is fitted, the bench's known
/// unknowns in their standard deviations.
class BarModel {
 public:
  using Spectrum = std::vector<Complex>;

  /// @throws InputError where one gauge stands for two and the far end is to return nothing
  BarModel(const Bench& bench, const BarRecords& records, const BarTheory& theory);

  [[nodiscard]] const BarTheory& theory() const { return theory_; }
  [[nodiscard]] std::size_t parameters() const;
  [[nodiscard]] std::size_t solid_parameters() const { return parameters_of(theory_.solid).size(); }
  [[nodiscard]] std::optional<std::size_t> reflection_at() const;
  [[nodiscard]] std::size_t first_unknown() const;
  [[nodiscard]] const std::vector<KnownUnknown>& unknowns() const { return unknowns_; }

  [[nodiscard]] std::unique_ptr<const Compliance> solid(std::span<const double> at) const;
  [[nodiscard]] MovedBench moved(std::span<const double> at) const;
  /// What comes back to the gauges; nothing where the return is a gauge of its own.
  [[nodiscard]] double reflection(std::span<const double> at) const;
  /// A bar of another density: to waves the same as another J by that factor at every frequency.
  void scale_density(double factor) { bar_.density_kg_m3.value *= factor; }

  /// How g_j follows one parameter. Gains change g_j in proportion.
  struct Derivative {
    std::size_t parameter = 0;
    std::optional<double> proportion;  ///< dg_j = proportion g_j, else
    Spectrum of_g;
  };
  /// How the gauges follow along a path as `bar_modes` takes it.
  struct Transfers {
    std::vector<Spectrum> g;  ///< one per gauge but the first
    MovedBench bench;         ///< what they are made from
    BarWaves waves;
  };
  /// @param to_differentiate  with what derivatives need beside
  [[nodiscard]] Transfers transfers(std::span<const double> at, const std::vector<Complex>& path,
                                    bool to_differentiate) const;

  /// First passages alone (R = 0): what noise of the first gauge becomes at once.
  [[nodiscard]] Transfers first_passages(std::span<const double> at,
                                         const std::vector<Complex>& path,
                                         bool to_differentiate) const;

  /// By gauge, only of parameters that move its g_j. @pre the transfers are of this place and path
  [[nodiscard]] std::vector<std::vector<Derivative>> derivatives(std::span<const double> at,
                                                                 const std::vector<Complex>& path,
                                                                 const Transfers& transfers) const;

  /// exp(-2 gamma (L - x)) of each gauge: what a wave that has passed it meets before it is back.
  [[nodiscard]] std::vector<Spectrum> returns(std::span<const double> at,
                                              const std::vector<Complex>& path) const;

 private:
  /// factor x ratio x gamma, of which null ones are 1.
  struct LogSlope {
    double factor = 0.0;
    const Spectrum* ratio = nullptr;
    const Spectrum* gamma = nullptr;
  };
  [[nodiscard]] double returned_by_end(std::span<const double> at) const;
  void make_returned(std::span<const double> at, const std::vector<Complex>& path,
                     Spectrum& g) const;
  [[nodiscard]] bool varies(KnownUnknown::Of number) const;
  [[nodiscard]] std::optional<LogSlope> slope_by(const KnownUnknown& unknown, std::size_t gauge,
                                                 const MovedBench& bench, const RatioSlopes& ratio,
                                                 const GammaSlopes& gamma) const;
  [[nodiscard]] Transfers transfers_with(std::span<const double> at, double reflection,
                                         const std::vector<Complex>& path,
                                         bool to_differentiate) const;
  [[nodiscard]] std::vector<Derivative> derivatives_of(std::span<const double> at,
                                                       std::size_t gauge,
                                                       const Transfers& transfers,
                                                       const GammaSlopes& gamma,
                                                       const std::vector<Complex>& path) const;

  Bar bar_;
  const BarRecords* records_;
  BarTheory theory_;
  std::vector<KnownUnknown> unknowns_;
  std::vector<double> gauge_length_m_;
};

}  // namespace kolsky
