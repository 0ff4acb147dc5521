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

/// What gauges share of noise that is slow beside the quiet parts: covariance of two gauges'
/// samples about their slopes, so far apart that quicker noise has none, and its deviation where
/// the gauges have nothing in common.
struct Wander {
  double covariance = 0.0;
  double sd = 0.0;

  [[nodiscard]] bool is_seen() const {
    constexpr double kSigma = 3.0;
    return covariance > kSigma * sd;
  }
  /// Of each shot's slope: of a random walk, the slowest that turns.
  [[nodiscard]] double slope_variance(double quiet_s) const {
    constexpr double kOfWalk = 30.0;  // its slope's variance times duration^2 over that covariance
    return is_seen() ? kOfWalk * covariance / (quiet_s * quiet_s) : 0.0;
  }
};

/// Mean of products of two gauges' samples of one shot, a thirtieth to a fifteenth of them apart:
/// at some of these lags where there are many, for what is slow tells the same at the next.
double slow_product(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  constexpr Eigen::Index kLags = 32;
  const Eigen::Index first = std::max<Eigen::Index>(1, a.size() / 30);
  const Eigen::Index last = std::max(first, a.size() / 15);
  const Eigen::Index step = (last - first) / kLags + 1;
  double sum = 0.0;
  double count = 0.0;
  for (Eigen::Index lag = first; lag <= last; lag += step) {
    sum += (product(a, b, lag) + product(b, a, lag)) / static_cast<double>(2 * (a.size() - lag));
    count += 1.0;
  }
  return sum / count;
}

/// Variance of such a mean of so many samples where the two have nothing in common, or a little
/// more: as if it were at one lag.
double product_variance(const std::vector<double>& a, const std::vector<double>& b,
                        Eigen::Index samples) {
  double sum = a.front() * b.front();
  for (std::size_t lag = 1; lag < a.size(); ++lag) {
    sum += 2.0 * a[lag] * b[lag];
  }
  return sum / static_cast<double>(samples);
}

Wander wander_of(const QuietParts& parts) {
  double sum = 0.0;
  double variance = 0.0;
  double count = 0.0;
  for (std::size_t a = 0; a < parts.about.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      for (std::size_t n = 0; n < parts.weights.size(); ++n) {
        sum += slow_product(parts.about[a][n], parts.about[b][n]);
        variance +=
            product_variance(parts.covariance[a], parts.covariance[b], parts.about[a][n].size());
        count += 1.0;
      }
    }
  }
  return {sum / count, std::sqrt(variance) / count};
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

/// Of the samples before a shot's pulse.
double duration_s(const CampaignShot& shot) {
  return shot.facts.time_s[shot.quiet_samples - 1] - shot.facts.time_s.front();
}

/// Sums of squares of slopes over their variances.
struct Scatter {
  std::vector<double> between;  ///< of the shots' means over the gauges, by shot
  std::vector<double> wander;   ///< what noise that gauges share may make of each
  double within = 0.0;          ///< about the means, all shots
  double white_share = 0.0;     ///< variance of as much white noise over that of the noise
};

/// @return nothing where a gauge is silent
std::optional<Scatter> scatter_of(const Campaign& campaign, const QuietParts& parts,
                                  const SlopesByShot& less) {
  Scatter scatter;
  const Wander wander = wander_of(parts);
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
    scatter.between.push_back(mean * mean / weight);
    scatter.wander.push_back(weight * wander.slope_variance(duration_s(campaign.shots[n])));
    scatter.within += square - mean * mean / weight;
  }
  return scatter;
}

bool long_enough(const Campaign& campaign) {
  return campaign.gauges() > 1 && std::ranges::all_of(campaign.shots, [](const auto& shot) {
           return shot.quiet_samples >= kFewestSamples;
         });
}

double log_chance_of(const Campaign& campaign, const QuietParts& parts, std::size_t gauge) {
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

}  // namespace

double slope_before(const CampaignShot& shot, const std::vector<double>& record) {
  const Eigen::VectorXd weights = weights_of(shot);
  return weights.dot(Eigen::Map<const Eigen::VectorXd>(record.data(), weights.size()));
}

SlopesByShot variances_of_slopes(const Campaign& campaign) {
  const QuietParts parts = quiet_parts(campaign);
  SlopesByShot variances(campaign.shots.size());
  for (std::size_t n = 0; n < variances.size(); ++n) {
    for (const std::vector<double>& covariance : parts.covariance) {
      variances[n].push_back(slope_variance(covariance, parts.weights[n]));
    }
  }
  return variances;
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
  double of_means = 0.0;
  for (std::size_t n = 0; n < scatter->between.size(); ++n) {
    of_means +=
        scatter->between[n] / (noise * (1.0 + further * shared) + scatter->wander[n]) / shots;
  }
  return log_f_tail(of_means, shots, belief + differences);
}

bool wanders_in_common(const Campaign& campaign) {
  return long_enough(campaign) && wander_of(quiet_parts(campaign)).is_seen();
}

std::vector<double> log_chances_of_slopes(const Campaign& campaign) {
  std::vector<double> chances(campaign.gauges(), 0.0);
  if (long_enough(campaign)) {
    const QuietParts parts = quiet_parts(campaign);
    for (std::size_t gauge = 0; gauge < chances.size(); ++gauge) {
      chances[gauge] = log_chance_of(campaign, parts, gauge);
    }
  }
  return chances;
}

}  // namespace kolsky
