#include "processing/criticism/search/quiet_slopes.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>

#include "processing/criticism/fitting/statistics.hpp"

namespace kolsky {

namespace {

constexpr std::size_t kFewestSamples = 16;
constexpr std::size_t kMostLags = 256;

/// What turns a shot's quiet samples into their slope: nothing, where there are not two of them.
Eigen::VectorXd weights_of(const CampaignShot& shot) {
  const auto count = static_cast<Eigen::Index>(shot.quiet_samples);
  const Eigen::Map<const Eigen::VectorXd> time_s(shot.facts.time_s.data(), count);
  Eigen::VectorXd weights = time_s.array() - (count > 0 ? time_s.mean() : 0.0);
  if (count > 1) {
    weights /= weights.squaredNorm();
  }
  return weights;
}

/// A gauge's quiet samples less their line.
Eigen::VectorXd about_slope(const CampaignShot& shot, std::size_t gauge,
                            const Eigen::VectorXd& weights) {
  const Eigen::Map<const Eigen::VectorXd> record(shot.strain[gauge].data(), weights.size());
  return record.array() - record.mean() -
         weights.dot(record) / weights.squaredNorm() * weights.array();
}

/// Every gauge's quiet samples about their slopes, all shots in a row.
struct QuietParts {
  std::vector<Eigen::VectorXd> weights;             ///< by shot
  std::vector<std::vector<Eigen::VectorXd>> about;  ///< by gauge and shot
  std::vector<std::vector<double>> covariance;      ///< of those, by gauge and lag
};

/// Sum of products of samples so far apart.
double product(const Eigen::VectorXd& a, const Eigen::VectorXd& b, Eigen::Index apart) {
  const Eigen::Index count = a.size() - apart;
  return count > 0 ? a.head(count).dot(b.tail(count)) : 0.0;
}

std::vector<double> autocovariance(const std::vector<Eigen::VectorXd>& by_shot) {
  Eigen::Index shortest = 4 * static_cast<Eigen::Index>(kMostLags);
  for (const Eigen::VectorXd& part : by_shot) {
    shortest = std::min(shortest, part.size());
  }
  std::vector<double> list;
  for (Eigen::Index lag = 0; lag <= shortest / 4; ++lag) {
    double sum = 0.0;
    double count = 0.0;
    for (const Eigen::VectorXd& part : by_shot) {
      sum += product(part, part, lag);
      count += static_cast<double>(part.size() - lag);
    }
    list.push_back(sum / count);
  }
  return list;
}

QuietParts quiet_parts(const Campaign& campaign) {
  QuietParts parts;
  parts.about.resize(campaign.gauges());
  for (const CampaignShot& shot : campaign.shots) {
    parts.weights.push_back(weights_of(shot));
    for (std::size_t j = 0; j < campaign.gauges(); ++j) {
      parts.about[j].push_back(about_slope(shot, j, parts.weights.back()));
    }
  }
  for (const auto& of_gauge : parts.about) {
    parts.covariance.push_back(autocovariance(of_gauge));
  }
  return parts;
}

/// Variance of a slope, of noise with this autocovariance (Bartlett's window), not below what as
/// much white noise would have.
double slope_variance(const std::vector<double>& covariance, const Eigen::VectorXd& weights) {
  double sum = 0.0;
  for (std::size_t lag = 1; lag < covariance.size(); ++lag) {
    const double taper = 1.0 - static_cast<double>(lag) / static_cast<double>(covariance.size());
    sum +=
        2.0 * taper * covariance[lag] * product(weights, weights, static_cast<Eigen::Index>(lag));
  }
  return covariance.front() * weights.squaredNorm() + std::max(0.0, sum);
}

/// Of the gauges' samples about their slopes, the mean over pairs; not below 0.
double mean_correlation(const QuietParts& parts) {
  double sum = 0.0;
  double pairs = 0.0;
  for (std::size_t a = 0; a < parts.about.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      double cross = 0.0;
      double of_a = 0.0;
      double of_b = 0.0;
      for (std::size_t n = 0; n < parts.weights.size(); ++n) {
        cross += parts.about[a][n].dot(parts.about[b][n]);
        of_a += parts.about[a][n].squaredNorm();
        of_b += parts.about[b][n].squaredNorm();
      }
      sum += cross / std::sqrt(of_a * of_b);
      pairs += 1.0;
    }
  }
  return std::max(0.0, sum / pairs);
}

/// Degrees of freedom by which the samples' spectrum tells how slopes scatter: none where the noise
/// is slow, or where the differences between gauges scatter more than it says, as what wanders too
/// slowly to show otherwise makes them.
double belief_in_spectrum(double white_share, double within, double differences) {
  constexpr double kSlow = 0.5;
  constexpr double kWhite = 0.9;
  constexpr double kMost = 30.0;
  constexpr double kOrdinary = -3.0;
  if (log_chi2_tail(within, differences) < kOrdinary) {
    return 0.0;
  }
  return kMost * std::clamp((white_share - kSlow) / (kWhite - kSlow), 0.0, 1.0);
}

/// Sums of squares of slopes over their variances.
struct Scatter {
  double between = 0.0;      ///< of the shots' means over the gauges
  double within = 0.0;       ///< about them
  double white_share = 0.0;  ///< variance of as much white noise over that of the noise
};

/// @return nothing where a gauge is silent
std::optional<Scatter> scatter_of(const Campaign& campaign, const QuietParts& parts,
                                  const SlopesByShot& less) {
  Scatter scatter;
  for (std::size_t n = 0; n < campaign.shots.size(); ++n) {
    double weight = 0.0;
    double mean = 0.0;
    double square = 0.0;
    for (std::size_t j = 0; j < campaign.gauges(); ++j) {
      const std::vector<double>& covariance = parts.covariance[j];
      if (!(covariance.front() > 0.0)) {
        return std::nullopt;
      }
      const double variance = slope_variance(covariance, parts.weights[n]);
      const double slope = slope_before(campaign.shots[n], campaign.shots[n].strain[j]) -
                           (less.empty() ? 0.0 : less[n][j]);
      scatter.white_share += covariance.front() * parts.weights[n].squaredNorm() / variance /
                             static_cast<double>(campaign.gauges() * campaign.shots.size());
      weight += 1.0 / variance;
      mean += slope / variance;
      square += slope * slope / variance;
    }
    scatter.between += mean * mean / weight;
    scatter.within += square - mean * mean / weight;
  }
  return scatter;
}

bool long_enough(const Campaign& campaign) {
  return campaign.gauges() > 1 && std::ranges::all_of(campaign.shots, [](const auto& shot) {
           return shot.quiet_samples >= kFewestSamples;
         });
}

}  // namespace

double slope_before(const CampaignShot& shot, const std::vector<double>& record) {
  const Eigen::VectorXd weights = weights_of(shot);
  return weights.dot(Eigen::Map<const Eigen::VectorXd>(record.data(), weights.size()));
}

double log_chance_of_common_slopes(const Campaign& campaign, const SlopesByShot& less) {
  if (!long_enough(campaign)) {
    return 0.0;
  }
  const QuietParts parts = quiet_parts(campaign);
  const std::optional<Scatter> scatter = scatter_of(campaign, parts, less);
  if (!scatter) {
    return 0.0;
  }
  const double shared = mean_correlation(parts);
  const auto shots = static_cast<double>(campaign.shots.size());
  const auto further = static_cast<double>(campaign.gauges() - 1);
  const double differences = shots * further;
  const double belief = belief_in_spectrum(scatter->white_share, scatter->within, differences);
  const double noise =
      (belief + scatter->within / std::max(1e-3, 1.0 - shared)) / (belief + differences);
  const double of_means = scatter->between / shots / (1.0 + further * shared);
  return log_f_tail(of_means / noise, shots, belief + differences);
}

double log_chance_of_slopes(const Campaign& campaign, std::size_t gauge) {
  if (!long_enough(campaign)) {
    return 0.0;
  }
  const QuietParts parts = quiet_parts(campaign);
  if (!(parts.covariance[gauge].front() > 0.0)) {
    return 0.0;
  }
  const auto shots = static_cast<double>(campaign.shots.size());
  const std::vector<double>& covariance = parts.covariance[gauge];
  double square = 0.0;
  double white_share = 0.0;
  for (std::size_t n = 0; n < campaign.shots.size(); ++n) {
    const double slope = slope_before(campaign.shots[n], campaign.shots[n].strain[gauge]);
    const double variance = slope_variance(covariance, parts.weights[n]);
    square += slope * slope / variance;
    white_share += covariance.front() * parts.weights[n].squaredNorm() / variance / shots;
  }
  const double belief = belief_in_spectrum(white_share, 0.0, 1.0);
  return belief > 0.0 ? log_f_tail(square / shots, shots, belief) : 0.0;
}

}  // namespace kolsky
