#include "processing/criticism/comparing/comparison.hpp"

#include <algorithm>
#include <cmath>

#include "processing/criticism/fitting/statistics.hpp"

namespace kolsky {

namespace {

constexpr std::size_t kFewestBins = 4;
constexpr std::size_t kMostBands = 6;

Eigen::Map<const Eigen::VectorXd> as_vector(const std::vector<double>& values) {
  return {values.data(), static_cast<Eigen::Index>(values.size())};
}

/// Weights of the mean before the pulse.
std::vector<double> mean_before(const std::vector<ArrivalWindow>& windows) {
  if (windows.empty() || windows.front().name != kBeforePulse) {
    return {};
  }
  std::vector<double> weights = windows.front().weight;
  double sum = 0.0;
  for (double& weight : weights) {
    weight *= weight;
    sum += weight;
  }
  for (double& weight : weights) {
    weight /= sum;
  }
  return weights;
}

bool alike(const std::vector<ArrivalWindow>& a, const std::vector<ArrivalWindow>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& one, const auto& other) { return one.weight == other.weight; });
}

/// What noise leaves in the one tells of the other.
bool nearly_alike(const std::vector<ArrivalWindow>& a, const std::vector<ArrivalWindow>& b) {
  constexpr double kApart = 0.03;
  const auto near = [](const ArrivalWindow& one, const ArrivalWindow& other) {
    const auto square = as_vector(one.weight).array().square();
    const auto others = as_vector(other.weight).array().square();
    return one.name == other.name && (square - others).abs().sum() < kApart * square.sum();
  };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), near);
}

/// A place that holds less of its shot's misfit than this is not where the model fails, however far
/// it stands out of the noise: a wave that is missing pulls at sources and moduli, and they at the
/// rest of the record.
constexpr double kPartOfMisfit = 1e-3;

double over(const Tile& tile) {
  return std::max(0.0, tile.energy - tile.noise.mean);
}

void unmark_traces(std::vector<Tile>& tiles) {
  std::map<std::size_t, double> by_shot;
  for (const Tile& tile : tiles) {
    by_shot[tile.shot] += over(tile);
  }
  for (Tile& tile : tiles) {
    tile.significant = tile.significant && over(tile) > kPartOfMisfit * by_shot[tile.shot];
  }
}

}  // namespace

double Region::sigma() const {
  return noise.mean > 0.0 ? std::sqrt(energy / noise.mean) : 0.0;
}

Comparer::Comparer(WhiteResiduals& residuals, const Composition& composition,
                   const std::vector<double>& theta)
    : residuals_(residuals),
      transform_(residuals.band().judged, residuals.judged_period_s(), 1.0),
      deviations_(residuals, composition, theta) {
  choose_bands();
  const Campaign& campaign = residuals.campaign();
  if (campaign.shots.size() > 1) {
    deviations_.draw_where_waves_ring();
  }
  for (std::size_t n = 0; n < campaign.shots.size(); ++n) {
    windows_.push_back(arrival_windows(residuals, composition, theta, n));
    std::vector<double> peaks;
    for (std::size_t j = 0; j < campaign.gauges(); ++j) {
      peaks.push_back(as_vector(residuals.judged_record(n, j)).lpNorm<Eigen::Infinity>());
    }
    peaks_.push_back(std::move(peaks));
    quiet_.emplace_back();
    noise_.emplace_back();
    for (const auto& of_gauge : windows_.back()) {
      quiet_.back().push_back(mean_before(of_gauge));
      if (deviations_.draws()) {
        continue;
      }
      // Gauges of one station have the same windows.
      auto& noise = noise_.back();
      const auto end = windows_.back().begin() + static_cast<std::ptrdiff_t>(noise.size());
      const auto same = std::find_if(windows_.back().begin(), end,
                                     [&](const auto& other) { return alike(other, of_gauge); });
      noise.push_back(same == end
                          ? noise_in(of_gauge, quiet_.back().back())
                          : noise[static_cast<std::size_t>(same - windows_.back().begin())]);
    }
  }
}

void Comparer::choose_bands() {
  const std::size_t last = residuals_.band().bins_judged + 1;
  std::vector<std::size_t> edges{last};
  while (edges.size() < kMostBands && edges.back() / 2 >= kFewestBins) {
    edges.push_back((edges.back() + 1) / 2);
  }
  edges.push_back(1);
  std::reverse(edges.begin(), edges.end());
  if (edges.size() > 2 && edges[1] - edges[0] < kFewestBins) {
    edges.erase(edges.begin() + 1);
  }
  const double width = transform_.bin_width_Hz();
  for (std::size_t b = 0; b + 1 < edges.size(); ++b) {
    ComparedBand band{width * static_cast<double>(edges[b]),
                      width * static_cast<double>(edges[b + 1]),
                      {edges[b], edges[b + 1]}};
    band.bins.first = b == 0 ? 0 : band.bins.first;
    bands_.push_back(band);
  }
}

std::vector<std::vector<PlaceNoise>> Comparer::noise_in(const std::vector<ArrivalWindow>& windows,
                                                        const std::vector<double>& quiet) {
  std::vector<BinRange> ranges;
  for (const ComparedBand& band : bands_) {
    ranges.push_back(band.bins);
  }
  const std::size_t held = deviations_.bins_held();
  const QuietMean mean = quiet.empty() ? QuietMean() : QuietMean(transform_, quiet, held);
  std::vector<std::vector<PlaceNoise>> list;
  for (const ArrivalWindow& window : windows) {
    std::vector<PlaceNoise>& by_band = list.emplace_back();
    for (const TileNoise& own : tile_noise(transform_, window.weight, mean, held, ranges)) {
      by_band.push_back({own, {}});
    }
  }
  return list;
}

/// Deviations hold no bin 0: here they are zero on average before the pulse.
void Comparer::level(std::vector<double>& record, std::size_t shot, std::size_t gauge) const {
  const std::vector<double>& quiet = quiet_[shot][gauge];
  if (!quiet.empty()) {
    const double mean = as_vector(record).dot(as_vector(quiet));
    for (double& value : record) {
      value -= mean;
    }
  }
}

std::vector<Comparer::Windowed> Comparer::windowed(const GaugeDeviation& reading,
                                                   std::size_t shot) {
  const std::vector<std::vector<PlaceNoise>>& noise = noise_of(reading, shot);
  std::vector<double> record = reading.records[shot];
  level(record, shot, reading.gauge);
  std::vector<Windowed> list;
  std::vector<double> part(record.size());
  for (std::size_t w = 0; w < noise.size(); ++w) {
    const ArrivalWindow& window = windows_[shot][reading.gauge][w];
    std::transform(record.begin(), record.end(), window.weight.begin(), part.begin(),
                   std::multiplies<>());
    Windowed own{&window, &noise[w], Spectrum(transform_.bins())};
    transform_.forward(part, own.spectrum);
    list.push_back(std::move(own));
  }
  return list;
}

const std::vector<std::vector<PlaceNoise>>& Comparer::noise_of(const GaugeDeviation& reading,
                                                               std::size_t shot) {
  const std::size_t gauge = reading.gauge;
  if (reading.drawn == nullptr) {
    return noise_[shot][gauge];
  }
  const std::pair key(gauge, shot);
  const auto known = drawn_.find(key);
  if (known != drawn_.end()) {
    return known->second;
  }
  // What rounding leaves is each shot's own.
  for (std::size_t n = 0; reading.rounded == nullptr && n < windows_.size(); ++n) {
    const auto other = drawn_.find({gauge, n});
    if (other != drawn_.end() && nearly_alike(windows_[n][gauge], windows_[shot][gauge])) {
      return drawn_.emplace(key, other->second).first->second;
    }
  }
  std::vector<std::vector<PlaceNoise>> list;
  for (const ArrivalWindow& window : windows_[shot][gauge]) {
    list.push_back(drawn_noise(reading, shot, window));
  }
  return drawn_.emplace(key, std::move(list)).first->second;
}

/// By band.
std::vector<PlaceNoise> Comparer::drawn_noise(const GaugeDeviation& reading, std::size_t shot,
                                              const ArrivalWindow& window) {
  const auto bins = static_cast<Eigen::Index>(transform_.bins());
  Eigen::MatrixXd real(bins, static_cast<Eigen::Index>(reading.drawn->size()));
  Eigen::MatrixXd imaginary(bins, real.cols());
  Spectrum spectrum(transform_.bins());
  for (Eigen::Index d = 0; d < real.cols(); ++d) {
    put_windowed((*reading.drawn)[static_cast<std::size_t>(d)], shot, reading.gauge, window,
                 spectrum);
    const Eigen::Map<const Eigen::VectorXcd> values(spectrum.data(), bins);
    real.col(d) = values.real();
    imaginary.col(d) = values.imag();
  }
  std::vector<PlaceNoise> list;
  for (const ComparedBand& band : bands_) {
    const auto first = static_cast<Eigen::Index>(band.bins.first);
    const auto size = static_cast<Eigen::Index>(band.bins.end) - first;
    Eigen::MatrixXd parts(2 * size, real.cols());
    parts << real.middleRows(first, size), imaginary.middleRows(first, size);
    list.push_back({tile_noise_of(parts), {}});
  }
  if (reading.rounded != nullptr) {
    add_rounded(reading, shot, window, list);
  }
  return list;
}

/// The transform of what a window passes, by which its squares add up to its energy.
void Comparer::put_windowed(std::vector<double> record, std::size_t shot, std::size_t gauge,
                            const ArrivalWindow& window, Spectrum& out) {
  level(record, shot, gauge);
  std::transform(record.begin(), record.end(), window.weight.begin(), record.begin(),
                 std::multiplies<>());
  transform_.forward(record, out);
  out.front() *= std::sqrt(0.5);
  out.back() *= std::sqrt(0.5);
}

void Comparer::add_rounded(const GaugeDeviation& reading, std::size_t shot,
                           const ArrivalWindow& window, std::vector<PlaceNoise>& by_band) {
  Spectrum spectrum(transform_.bins());
  for (const std::vector<double>& draw : (*reading.rounded)[shot]) {
    put_windowed(draw, shot, reading.gauge, window, spectrum);
    for (std::size_t b = 0; b < bands_.size(); ++b) {
      double energy = 0.0;
      for (std::size_t f = bands_[b].bins.first; f < bands_[b].bins.end; ++f) {
        energy += std::norm(spectrum[f]);
      }
      by_band[b].rounded.push_back(energy);
    }
  }
}

void Comparer::add_tiles(const GaugeDeviation& reading, const std::vector<Windowed>& windows,
                         std::size_t shot, std::vector<Tile>& tiles) {
  const std::size_t bins = residuals_.band().bins_judged;
  const double peak = peaks_[shot][reading.gauge];
  for (const Windowed& own : windows) {
    const auto& weight = own.window->weight;
    const double length = as_vector(weight).squaredNorm();
    for (std::size_t b = 0; b < bands_.size(); ++b) {
      Tile tile;
      tile.gauge = reading.gauge;
      tile.window = own.window->name;
      tile.band = b;
      tile.shot = shot;
      double squares = 0.0;
      for (std::size_t f = bands_[b].bins.first; f < bands_[b].bins.end; ++f) {
        const bool half = f == 0 || f + 1 == transform_.bins();
        const double power = (half ? 0.5 : 1.0) * std::norm(own.spectrum[f]);
        const double scale = reading.scale[std::clamp<std::size_t>(f, 1, bins) - 1];
        tile.energy += power;
        squares += power * scale * scale;
      }
      tile.leaves = (*own.noise)[b];
      tile.noise = tile.leaves.whole();
      tile.sigma = std::sqrt(tile.energy / tile.noise.mean);
      // Parseval: a mean square is 2/N times the one-sided sum over the window's length.
      const double mean_square = 2.0 * squares / static_cast<double>(weight.size()) / length;
      tile.percent_of_peak = peak > 0.0 ? 100.0 * std::sqrt(mean_square) / peak : 0.0;
      tile.log_p = tile.noise.log_tail(tile.energy);
      tiles.push_back(std::move(tile));
    }
  }
}

Comparison Comparer::compare(const Eigen::VectorXd& white, const Misfit& misfit) {
  Comparison comparison = compared(white, misfit);
  const bool fails = std::ranges::any_of(comparison.tiles, &Tile::significant);
  if (fails && !deviations_.draws() && deviations_.draw_where_waves_ring()) {
    comparison = compared(white, misfit);
  }
  return comparison;
}

Comparison Comparer::compared(const Eigen::VectorXd& white, const Misfit& misfit) {
  Comparison comparison;
  comparison.misfit = misfit;
  comparison.bands = bands_;
  const std::map<Key, std::vector<Following>> following = add_all_tiles(white, comparison.tiles);
  mark_significant(comparison.tiles);
  std::map<Key, Region> regions = regions_of(comparison.tiles);
  const std::size_t shots = residuals_.campaign().shots.size();
  if (shots > 1) {
    for (auto& [key, region] : regions) {
      region.log_p = region.noise.log_tail(region.energy);
      const auto own = following.find(key);
      region.repeat_log_p = own != following.end() ? repeat_log_p(region, own->second, shots) : 0.0;
    }
  }
  mark_regions(regions);
  comparison.excess = share_out(comparison.tiles, regions);
  for (auto& [key, region] : regions) {
    comparison.regions.push_back(std::move(region));
  }
  const auto larger = [](const auto& a, const auto& b) { return a.share > b.share; };
  std::stable_sort(comparison.tiles.begin(), comparison.tiles.end(), larger);
  std::stable_sort(comparison.regions.begin(), comparison.regions.end(), larger);
  return comparison;
}

std::map<Comparer::Key, Region> Comparer::regions_of(const std::vector<Tile>& tiles) {
  std::map<Key, Region> regions;
  for (const Tile& tile : tiles) {
    Region& region = regions[{tile.gauge, tile.window, tile.band}];
    region.gauge = tile.gauge;
    region.window = tile.window;
    region.band = tile.band;
    region.energy += tile.energy;
    region.leaves += tile.leaves;
    region.log_p = tile.log_p;
  }
  for (auto& [key, region] : regions) {
    region.noise = region.leaves.whole();
  }
  return regions;
}

/// ln of the chance that so much of a place follows the sources, by Fisher's F.
double Comparer::repeat_log_p(const Region& region, const std::vector<Following>& bins,
                              std::size_t shots) {
  double followed = 0.0;
  double total = 0.0;
  for (const Following& bin : bins) {
    followed += bin.followed();
    total += bin.all();
  }
  if (total <= followed) {
    return 0.0;
  }
  const double free = region.noise.freedom() / static_cast<double>(shots);
  const double rest = free * static_cast<double>(shots - 1);
  return log_f_tail((followed / free) / ((total - followed) / rest), free, rest);
}

void Comparer::mark_regions(std::map<Key, Region>& regions) {
  std::vector<double> log_ps;
  std::vector<double> repeat_log_ps;
  for (const auto& [key, region] : regions) {
    log_ps.push_back(region.log_p);
    repeat_log_ps.push_back(region.repeat_log_p);
  }
  const double limit = discovery_limit(std::move(log_ps));
  const double repeat_limit = discovery_limit(std::move(repeat_log_ps));
  for (auto& [key, region] : regions) {
    region.significant = region.log_p <= limit;
    region.repeats = region.significant && region.repeat_log_p <= repeat_limit;
  }
}

/// @return chi-square over what noise leaves, over all tiles
double Comparer::share_out(std::vector<Tile>& tiles, std::map<Key, Region>& regions) {
  double excess = 0.0;
  for (const Tile& tile : tiles) {
    excess += over(tile);
  }
  for (Tile& tile : tiles) {
    Region& region = regions[{tile.gauge, tile.window, tile.band}];
    tile.share = excess > 0.0 ? over(tile) / excess : 0.0;
    // A place that fails over all shots does so in every shot that shows it at all.
    tile.significant =
        tile.significant || (region.significant && tile.log_p < std::log(kFalseDiscovery));
    region.share += tile.share;
  }
  unmark_traces(tiles);
  for (auto& [key, region] : regions) {
    region.significant = region.significant && region.share > kPartOfMisfit;
    region.repeats = region.repeats && region.significant;
  }
  for (Tile& tile : tiles) {
    tile.repeats = tile.significant && regions[{tile.gauge, tile.window, tile.band}].repeats;
  }
  return excess;
}

/// @return of the places of all shots together, what of each bin follows the sources: one shot
///   shows nothing of it, and then this is empty
std::map<Comparer::Key, std::vector<Comparer::Following>> Comparer::add_all_tiles(
    const Eigen::VectorXd& white, std::vector<Tile>& tiles) {
  const std::size_t shots = residuals_.campaign().shots.size();
  std::vector<Spectrum> sources;
  for (std::size_t n = 0; shots > 1 && n < shots; ++n) {
    sources.push_back(residuals_.source_spectrum(n, white));
  }
  std::map<Key, std::vector<Following>> following;
  for (const GaugeDeviation& reading : deviations_.by_gauge()) {
    for (std::size_t n = 0; n < shots; ++n) {
      const auto windows = windowed(reading, n);
      add_tiles(reading, windows, n, tiles);
      for (std::size_t w = 0; !sources.empty() && w < windows.size(); ++w) {
        follow(windows[w], sources[n], reading.gauge, following);
      }
    }
  }
  return following;
}

void Comparer::follow(const Windowed& own, const Spectrum& source, std::size_t gauge,
                      std::map<Key, std::vector<Following>>& following) const {
  const std::size_t bins = residuals_.band().bins_judged;
  for (std::size_t b = 0; b < bands_.size(); ++b) {
    auto& bin = following[{gauge, own.window->name, b}];
    bin.resize(bins);
    for (std::size_t f = std::max<std::size_t>(1, bands_[b].bins.first);
         f < std::min(bands_[b].bins.end, bins + 1); ++f) {
      bin[f - 1].add(own.spectrum[f], source[f - 1]);
    }
  }
}

ComparedRecord Comparer::record(std::span<const double> white, std::size_t shot,
                                std::size_t gauge) {
  ComparedRecord record{residuals_.judged_record(shot, gauge), residuals_.deviations(white)[gauge],
                        peaks_[shot][gauge]};
  level(record.deviation, shot, gauge);
  return record;
}

Comparison compare(Study& study, const Studied& studied) {
  return Comparer(study.residuals(), studied.composition, studied.fit.theta)
      .compare(studied.fit.residual, studied.misfit);
}

}  // namespace kolsky
