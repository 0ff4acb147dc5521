#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "processing/algebra/algebra.hpp"
#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/impact/impact_study.hpp"

namespace kolsky {

namespace {

double rms(const Eigen::VectorXd& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

/// Cosines over part of a record: orthonormal, one column per half cycle.
Eigen::MatrixXd cosines(std::size_t first, std::size_t count, std::size_t from, std::size_t end,
                        Eigen::Index size) {
  Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(size, static_cast<Eigen::Index>(end - from));
  for (std::size_t c = from; c < end; ++c) {
    for (std::size_t k = 0; k < count; ++k) {
      basis(static_cast<Eigen::Index>(first + k), static_cast<Eigen::Index>(c - from)) =
          std::sqrt((c == 0 ? 1.0 : 2.0) / static_cast<double>(count)) *
          std::cos(std::numbers::pi * static_cast<double>(c) * (static_cast<double>(k) + 0.5) /
                   static_cast<double>(count));
    }
  }
  return basis;
}

struct Window {
  std::string name;
  std::size_t first = 0;
  std::size_t count = 0;
};

/// By the course of what is foretold at a gauge.
std::vector<Window> windows_of(const Eigen::VectorXd& reading) {
  Eigen::Index top = 0;
  const double peak = reading.maxCoeff(&top);
  Eigen::Index begin = 0;
  while (begin < top && reading[begin] < 0.01 * peak) {
    ++begin;
  }
  Eigen::Index end = top;
  while (end < reading.size() && reading[end] > 0.01 * peak) {
    ++end;
  }
  std::vector<Window> windows;
  const auto add = [&](const char* name, Eigen::Index from, Eigen::Index to) {
    if (to - from >= 2) {
      windows.push_back(
          {name, static_cast<std::size_t>(from), static_cast<std::size_t>(to - from)});
    }
  };
  add("before", 0, begin);
  add("loading", begin, top);
  add("unloading", top, end);
  add("after", end, reading.size());
  return windows;
}

/// Shares what a model leaves of impacts out among speeds and places.
class ImpactComparer {
 public:
  ImpactComparer(const Campaign& campaign, ImpactResiduals& residuals, const Studied& studied,
                 std::size_t worker)
      : campaign_(campaign),
        residuals_(residuals),
        records_(residuals.records()),
        studied_(studied),
        foretold_(residuals.foretell(studied.composition, studied.fit.theta, worker)),
        samples_(static_cast<Eigen::Index>(records_.window.samples)),
        size_(static_cast<Eigen::Index>(residuals.per_shot())),
        gauges_(static_cast<Eigen::Index>(residuals.of_gauges())) {}

  ImpactComparison run() {
    for (std::size_t g = 0; g < records_.groups.size(); ++g) {
      const Eigen::MatrixXd covariance = residuals_.covariance(g);
      peak_ = add_speed(records_.groups[g]);
      for (const std::size_t n : records_.groups[g].shots) {
        if (records_.rebound[n]) {
          add_rebound(n, covariance);
        }
        for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
          add_gauge(n, j, covariance);
        }
      }
    }
    rank_tiles();
    out_.misfit = studied_.misfit;
    return std::move(out_);
  }

 private:
  /// Means over a group's shots of what is left and what is foretold, in the residuals' order.
  struct Means {
    Eigen::VectorXd left;
    Eigen::VectorXd reading;
  };

  [[nodiscard]] Means means_of(const SpeedGroup& group) const {
    const auto count = static_cast<double>(group.shots.size());
    Means means{Eigen::VectorXd::Zero(size_), Eigen::VectorXd::Zero(size_)};
    for (const std::size_t n : group.shots) {
      means.left += foretold_.residual[n] / count;
      means.reading += foretold_.reading[n] / count;
    }
    // What every shot may offset by itself is no misfit.
    for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
      auto own = means.left.segment(static_cast<Eigen::Index>(j) * samples_, samples_);
      own.array() -= own.mean();
    }
    return means;
  }

  /// @return the largest reading foretold
  double add_speed(const SpeedGroup& group) {
    const auto count = static_cast<double>(group.shots.size());
    const Means means = means_of(group);
    const double peak = means.reading.head(gauges_).cwiseAbs().maxCoeff();
    SpeedSummary summary;
    summary.speed_m_per_s = group.speed_m_per_s;
    summary.shots = group.shots.size();
    summary.rms_percent = 100.0 * rms(means.left.head(gauges_)) / peak;
    summary.noise_percent = 100.0 * std::sqrt(records_.noise[0][0] / count) / peak;
    put_restitution(group, summary);
    put_forces(means, summary);
    Eigen::VectorXd white = Eigen::VectorXd::Zero(size_);
    for (const std::size_t n : group.shots) {
      white += studied_.fit.residual.segment(static_cast<Eigen::Index>(n) * size_, size_);
    }
    summary.chi2_reduced =
        white.squaredNorm() / count / (static_cast<double>(size_) - residuals_.eliminated());
    out_.speeds.push_back(std::move(summary));
    return peak;
  }

  void put_restitution(const SpeedGroup& group, SpeedSummary& summary) const {
    const auto count = static_cast<double>(group.shots.size());
    double rebounds = 0.0;
    for (const std::size_t n : group.shots) {
      const ShotFacts& facts = campaign_.shots[n].facts;
      summary.restitution_foretold +=
          foretold_.rebound_m_per_s[n] / *facts.incident_speed_m_per_s / count;
      if (facts.rebound_speed_m_per_s) {
        summary.restitution_measured +=
            std::abs(*facts.rebound_speed_m_per_s) / *facts.incident_speed_m_per_s;
        rebounds += 1.0;
      }
    }
    summary.restitution_measured /= std::max(1.0, rebounds);
  }

  void put_forces(const Means& means, SpeedSummary& summary) const {
    const double force_per_strain = residuals_.force_per_strain_N();
    for (Eigen::Index k = 0; k < samples_; ++k) {
      const auto i = static_cast<Eigen::Index>(campaign_.reference) * samples_ + k;
      summary.foretold_N.push_back(means.reading[i] * force_per_strain);
      summary.measured_N.push_back((means.reading[i] + means.left[i]) * force_per_strain);
    }
    summary.peak_foretold_N = *std::ranges::max_element(summary.foretold_N);
    summary.peak_measured_N = *std::ranges::max_element(summary.measured_N);
  }

  void add_rebound(std::size_t shot, const Eigen::MatrixXd& covariance) {
    const double left = foretold_.residual[shot][gauges_];
    ImpactTile tile;
    tile.shot = shot;
    tile.window = kRebound;
    tile.freedom = 1.0;
    tile.chi2 = std::pow(left, 2) / covariance(gauges_, gauges_);
    tile.percent_of_peak = 100.0 * std::abs(left / foretold_.reading[shot][gauges_]);
    add(std::move(tile));
  }

  /// Each window's slow third and the rest.
  void add_gauge(std::size_t shot, std::size_t gauge, const Eigen::MatrixXd& covariance) {
    const auto first = static_cast<Eigen::Index>(gauge) * samples_;
    const Eigen::VectorXd own = foretold_.reading[shot].segment(first, samples_);
    for (Window& window : windows_of(own)) {
      window.first += static_cast<std::size_t>(first);
      const std::size_t half = std::max<std::size_t>(1, window.count / 3);
      for (const auto& [from, end] : {std::pair{std::size_t{0}, half}, {half, window.count}}) {
        if (from < end) {
          add_band(shot, gauge, window, from, end, covariance);
        }
      }
    }
  }

  /// @param from, end  half cycles in the window
  void add_band(std::size_t shot, std::size_t gauge, const Window& window, std::size_t from,
                std::size_t end, const Eigen::MatrixXd& covariance) {
    const Eigen::MatrixXd basis = cosines(window.first, window.count, from, end, size_);
    const Eigen::VectorXd part = basis.transpose() * foretold_.residual[shot];
    const Eigen::MatrixXd spread = basis.transpose() * covariance * basis;
    const auto count = static_cast<double>(window.count);
    const double cycle_s = 2.0 * count * records_.window.period_s;
    ImpactTile tile;
    tile.gauge = gauge;
    tile.shot = shot;
    tile.window = window.name;
    tile.low_Hz = static_cast<double>(from) / cycle_s;
    tile.high_Hz = static_cast<double>(end) / cycle_s;
    tile.chi2 = part.dot(solve_symmetric(spread, part));
    tile.freedom = static_cast<double>(end - from);
    tile.percent_of_peak = 100.0 * part.norm() / std::sqrt(count) / peak_;
    add(std::move(tile));
  }

  void add(ImpactTile tile) {
    tile.sigma = std::sqrt(tile.chi2 / tile.freedom);
    tile.log_p = log_chi2_tail(tile.chi2, tile.freedom);
    out_.tiles.push_back(std::move(tile));
  }

  void rank_tiles() {
    double excess = 0.0;
    for (const ImpactTile& tile : out_.tiles) {
      excess += std::max(0.0, tile.chi2 - tile.freedom);
    }
    for (ImpactTile& tile : out_.tiles) {
      tile.share = excess > 0.0 ? std::max(0.0, tile.chi2 - tile.freedom) / excess : 0.0;
    }
    mark_significant(out_.tiles);
    std::sort(out_.tiles.begin(), out_.tiles.end(),
              [](const ImpactTile& a, const ImpactTile& b) { return a.share > b.share; });
  }

  const Campaign& campaign_;
  ImpactResiduals& residuals_;
  const ImpactRecords& records_;
  const Studied& studied_;
  ImpactResiduals::Foretold foretold_;
  Eigen::Index samples_;
  Eigen::Index size_;
  Eigen::Index gauges_;
  double peak_ = 0.0;  ///< largest reading foretold at the group's speed
  ImpactComparison out_;
};

}  // namespace

ImpactComparison ImpactStudy::compare(const Studied& studied) {
  return ImpactComparer(campaign_, residuals_, studied, executor_.first).run();
}

}  // namespace kolsky
