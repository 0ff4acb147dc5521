#pragma once

#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "processing/criticism/comparing/arrival_windows.hpp"
#include "processing/criticism/comparing/gauge_deviations.hpp"
#include "processing/criticism/comparing/tile_noise.hpp"
#include "processing/criticism/fitting/study.hpp"

namespace kolsky {

/// Part of the judged band, about an octave.
struct ComparedBand {
  double low_Hz = 0.0;
  double high_Hz = 0.0;
  BinRange bins;  ///< of the judged window's transform
};

/// What a model leaves unexplained in one arrival window and band of one gauge's record.
struct Tile {
  std::size_t gauge = 0;
  std::string window;
  std::size_t band = 0;
  std::size_t shot = 0;
  double energy = 0.0;           ///< whitened
  PlaceNoise leaves;             ///< what of it noise alone would leave
  TileNoise noise;               ///< the same, whatever it is of
  double sigma = 0.0;            ///< rms in units of the noise's: 1 under the true model
  double percent_of_peak = 0.0;  ///< rms of the deviation, of the record's peak
  double share = 0.0;            ///< of the whole misfit's excess over noise
  double log_p = 0.0;            ///< ln of its probability under noise alone
  bool significant = false;
  bool repeats = false;  ///< over the shots, following their sources
};

/// The same place in all shots taken together.
struct Region {
  std::size_t gauge = 0;
  std::string window;
  std::size_t band = 0;
  double energy = 0.0;
  PlaceNoise leaves;
  TileNoise noise;
  double share = 0.0;
  double log_p = 0.0;
  bool significant = false;
  double repeat_log_p = 0.0;  ///< ln probability of so much following the sources by chance
  bool repeats = false;

  [[nodiscard]] double sigma() const;
};

/// One gauge of one shot, over its judged window.
struct ComparedRecord {
  std::vector<double> measured;   ///< strain
  std::vector<double> deviation;  ///< of the record from the wave common to all gauges; strain
  double peak = 0.0;
};

struct Comparison {
  Misfit misfit;
  std::vector<ComparedBand> bands;
  std::vector<Tile> tiles;
  std::vector<Region> regions;
  double excess = 0.0;  ///< chi-square over what noise leaves, over all tiles
};

/// Shares whitened residuals out among places: gauge x arrival window x frequency band x shot.
///
/// A residual is between gauges, so a fault of one is seen at all: see GaugeDeviations. With two
/// gauges nothing tells which is off: each has half of the misfit.
class Comparer {
 public:
  /// @param residuals  as frozen at theta; outlives this
  Comparer(WhiteResiduals& residuals, const Composition& composition,
           const std::vector<double>& theta);

  /// Of all shots together. False discovery is held at 0.5 % over the tiles and over the regions
  /// (Benjamini and Hochberg). What rings is judged by drawn noise, which takes ten times as long:
  /// of one shot, which is compared as it comes in, only where something fails without it.
  [[nodiscard]] Comparison compare(const Eigen::VectorXd& white, const Misfit& misfit);

  [[nodiscard]] ComparedRecord record(std::span<const double> white, std::size_t shot,
                                      std::size_t gauge);
  [[nodiscard]] const std::vector<ComparedBand>& bands() const { return bands_; }
  [[nodiscard]] const std::vector<ArrivalWindow>& windows(std::size_t shot,
                                                          std::size_t gauge) const {
    return windows_[shot][gauge];
  }

 private:
  using Spectrum = std::vector<Complex>;
  struct Windowed {
    const ArrivalWindow* window;
    const std::vector<PlaceNoise>* noise;  ///< by band
    Spectrum spectrum;
  };

  using Key = std::tuple<std::size_t, std::string, std::size_t>;  ///< gauge, window and band

  /// How much of a place's spectra follows the sources, shot by shot.
  class Following {
   public:
    void add(Complex value, Complex source) {
      all_ += std::norm(value);
      power_ += std::norm(source);
      sum_ += value * std::conj(source);
    }
    [[nodiscard]] double all() const { return all_; }
    [[nodiscard]] double followed() const { return power_ > 0.0 ? std::norm(sum_) / power_ : 0.0; }

   private:
    double all_ = 0.0;
    double power_ = 0.0;
    Complex sum_ = 0.0;
  };

  void choose_bands();
  [[nodiscard]] Comparison compared(const Eigen::VectorXd& white, const Misfit& misfit);
  [[nodiscard]] std::vector<Windowed> windowed(const GaugeDeviation& reading, std::size_t shot);
  [[nodiscard]] const std::vector<std::vector<PlaceNoise>>& noise_of(const GaugeDeviation& reading,
                                                                     std::size_t shot);
  [[nodiscard]] std::vector<PlaceNoise> drawn_noise(const GaugeDeviation& reading, std::size_t shot,
                                                    const ArrivalWindow& window);
  void put_windowed(std::vector<double> record, std::size_t shot, std::size_t gauge,
                    const ArrivalWindow& window, Spectrum& out);
  void add_rounded(const GaugeDeviation& reading, std::size_t shot, const ArrivalWindow& window,
                   std::vector<PlaceNoise>& by_band);
  void add_tiles(const GaugeDeviation& reading, const std::vector<Windowed>& windows,
                 std::size_t shot, std::vector<Tile>& tiles);
  [[nodiscard]] std::vector<std::vector<PlaceNoise>> noise_in(
      const std::vector<ArrivalWindow>& windows, const std::vector<double>& quiet);
  [[nodiscard]] std::map<Key, std::vector<Following>> add_all_tiles(const Eigen::VectorXd& white,
                                                                    std::vector<Tile>& tiles);
  void follow(const Windowed& own, const Spectrum& source, std::size_t gauge,
              std::map<Key, std::vector<Following>>& following) const;
  [[nodiscard]] static std::map<Key, Region> regions_of(const std::vector<Tile>& tiles);
  [[nodiscard]] static double repeat_log_p(const Region& region, const std::vector<Following>& bins,
                                           std::size_t shots);
  static void mark_regions(std::map<Key, Region>& regions);
  static double share_out(std::vector<Tile>& tiles, std::map<Key, Region>& regions);
  void level(std::vector<double>& record, std::size_t shot, std::size_t gauge) const;

  WhiteResiduals& residuals_;
  DampedTransform transform_;
  GaugeDeviations deviations_;
  std::vector<ComparedBand> bands_;
  std::vector<std::vector<std::vector<ArrivalWindow>>> windows_;  ///< by shot and gauge
  std::vector<std::vector<double>> peaks_;                        ///< by shot and gauge
  /// Weights of the mean before the pulse, by shot and gauge; empty where nothing is before it.
  std::vector<std::vector<std::vector<double>>> quiet_;
  /// By shot, gauge, window and band; of stationary noise.
  std::vector<std::vector<std::vector<std::vector<PlaceNoise>>>> noise_;
  /// By gauge and shot, then by window and band; of drawn noise.
  std::map<std::pair<std::size_t, std::size_t>, std::vector<std::vector<PlaceNoise>>> drawn_;
};

/// Compares a model where it stands. @param studied  of this study, the last one evaluated
[[nodiscard]] Comparison compare(Study& study, const Studied& studied);

}  // namespace kolsky
