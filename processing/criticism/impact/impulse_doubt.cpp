#include "processing/criticism/impact/impulse_doubt.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "processing/criticism/fitting/statistics.hpp"

namespace kolsky {

namespace {

/// Share of a record's peak below which there is no contact: there the offset is.
constexpr double kNoContact = 0.01;
/// What samples 30 us apart and an offset beside them leave of an impulse at one speed, and not at
/// another.
constexpr double kAlike = 0.002;

/// Of a shot, the impulse read over that foretold, less 1, and less what the measured rebound makes
/// of it. Where the far end's reflection is judged, too, that is of the other sense and counts as
/// much.
double impulse_off(const ImpactResiduals::Foretold& foretold, std::size_t shot,
                   std::size_t of_gauges, std::size_t samples, double incident) {
  const Eigen::VectorXd& reading = foretold.reading[shot];
  const Eigen::VectorXd& left = foretold.residual[shot];
  const double floor =
      kNoContact * reading.head(static_cast<Eigen::Index>(of_gauges)).cwiseAbs().maxCoeff();
  double read = 0.0;
  double said = 0.0;
  for (std::size_t first = 0; first < of_gauges; first += samples) {
    double offset = 0.0;
    double quiet = 0.0;
    double senses = 0.0;
    for (std::size_t k = first; k < first + samples; ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      if (std::abs(reading[i]) < floor) {
        offset += left[i];
        quiet += 1.0;
      } else {
        const double sense = std::copysign(1.0, reading[i]);
        read += sense * left[i];
        said += sense * reading[i];
        senses += sense;
      }
    }
    read -= quiet > 0.0 ? senses * offset / quiet : 0.0;
  }
  const auto rebound = static_cast<Eigen::Index>(of_gauges);
  return read / said - left[rebound] / (incident + reading[rebound]);
}

/// Such shares by speed, and how they differ.
struct BySpeed {
  std::vector<double> mean;
  double all = 0.0;      ///< mean of all shots
  double among = 0.0;    ///< variance of a shot about its speed's mean
  double between = 0.0;  ///< the same as the speeds' means have it
};

BySpeed by_speed(const ImpactResiduals& residuals, const ImpactResiduals::Foretold& foretold,
                 double shots) {
  const ImpactRecords& records = residuals.records();
  const auto groups = static_cast<double>(records.groups.size());
  BySpeed out;
  for (std::size_t g = 0; g < records.groups.size(); ++g) {
    const std::vector<std::size_t>& members = records.groups[g].shots;
    std::vector<double> own;
    for (const std::size_t n : members) {
      own.push_back(impulse_off(foretold, n, residuals.of_gauges(), records.window.samples,
                                records.incident(g)));
    }
    const double sum = std::accumulate(own.begin(), own.end(), 0.0);
    out.mean.push_back(sum / static_cast<double>(own.size()));
    out.all += sum / shots;
    for (const double off : own) {
      out.among += std::pow(off - out.mean.back(), 2) / (shots - groups);
    }
  }
  for (std::size_t g = 0; g < records.groups.size(); ++g) {
    const auto count = static_cast<double>(records.groups[g].shots.size());
    out.between += count * std::pow(out.mean[g] - out.all, 2) / (groups - 1.0);
  }
  return out;
}

}  // namespace

std::optional<std::string> impulse_doubt(ImpactStudy& study, const Studied& current) {
  ImpactResiduals& residuals = study.residuals();
  const auto groups = static_cast<double>(residuals.records().groups.size());
  const auto shots = static_cast<double>(study.campaign().shots.size());
  constexpr double kFewest = 3.0;  // shots beyond one at each speed, to know how they differ
  if (groups < 2.0 || shots - groups < kFewest) {
    return std::nullopt;
  }
  const auto foretold =
      residuals.foretell(current.composition, current.fit.theta, study.executor().first);
  if (!foretold.sound) {
    return std::nullopt;
  }
  const BySpeed off = by_speed(residuals, foretold, shots);
  const double f = off.between / (off.among + shots / groups * kAlike * kAlike);
  if (!(log_f_tail(f, groups - 1.0, shots - groups) < kUnexplained)) {
    return std::nullopt;
  }
  const auto furthest =
      std::ranges::max_element(off.mean, {}, [&](double mean) { return std::abs(mean - off.all); });
  const auto group = static_cast<std::size_t>(furthest - off.mean.begin());
  return fmt::format(
      "over the ball's change of momentum the impulse that gauges read at {:.1f} m/s is {:.2g} "
      "% {} than at all speeds, where shots of one speed differ by {:.2g} %: no ball does that; "
      "what reads the force does not grow with it (an amplifier or a converter at its end, a "
      "bridge)",
      residuals.records().groups[group].speed_m_per_s, 100.0 * std::abs(*furthest - off.all),
      *furthest < off.all ? "less" : "more", 100.0 * std::sqrt(off.among));
}

}  // namespace kolsky
