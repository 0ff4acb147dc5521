#include "tests/generators/solid_bar_shots.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>

#include "tests/generators/bar_readings.hpp"
#include "tests/generators/campaign_draw.hpp"
#include "tests/generators/elastic_shpb.hpp"
#include "tests/generators/unit_source.hpp"

namespace kolsky::testing {

namespace {

constexpr double kNoise = 4e-6;
constexpr int kBits = 16;
constexpr double kRange = 0.005;
constexpr double kBeside_m = 0.5e-3;
constexpr std::array<double, SolidBarShots::kGauges> kPlaces_m{0.1, 0.3, 0.5, 0.7};

using Record = std::vector<double>;

BarWorld world_of(const PublishedPmma& bar) {
  BarWorld world;
  world.material.E1_Pa = bar.material.E1_Pa;
  world.material.E2_Pa = bar.material.E2_Pa;
  world.material.eta2_Pa_s = bar.material.eta2_Pa_s;
  world.material.density_kg_m3 = bar.material.density_kg_m3;
  world.material.poisson_ratio = bar.poisson_ratio;
  world.end_r = 0.0;
  world.dispersive = true;
  world.timing.samples = 1500;
  world.timing.pretrigger = 200;
  for (const double place_m : kPlaces_m) {
    for (const double beside : {-kBeside_m, 0.0, kBeside_m}) {
      TrueGauge gauge;
      gauge.position_m = place_m + beside;
      world.gauges.push_back(gauge);
    }
  }
  std::mt19937_64 random(4);
  const Timing& timing = world.timing;
  const double start_s = timing.lead_s + 150e-6;
  const auto knots = static_cast<std::size_t>(timing.window_s() / timing.knot_s()) + 1;
  for (std::size_t i = 0; i < SolidBarShots::kShots; ++i) {
    TrueShot shot;
    shot.source = draw_pulse(random, start_s, timing.knot_s(), knots);
    shot.peak_strain = 1e-3 + 2e-3 * static_cast<double>(i) / (SolidBarShots::kShots - 1);
    world.shots.push_back(shot);
  }
  return world;
}

/// A gauge's record where it is displaced, and its slope along the bar.
Record displaced(const std::vector<Record>& stations, std::size_t gauge, double by_m) {
  const Record& before = stations[3 * gauge];
  const Record& at = stations[3 * gauge + 1];
  const Record& behind = stations[3 * gauge + 2];
  const double u = by_m / kBeside_m;
  Record record(at.size());
  for (std::size_t n = 0; n < at.size(); ++n) {
    record[n] = at[n] + 0.5 * u * (behind[n] - before[n]) +
                0.5 * u * u * (behind[n] - 2.0 * at[n] + before[n]);
  }
  return record;
}

Eigen::VectorXd stacked(const std::vector<Record>& stations) {
  const auto samples = static_cast<Eigen::Index>(stations.front().size());
  const auto gauges = static_cast<Eigen::Index>(SolidBarShots::kGauges);
  Eigen::VectorXd all(gauges * samples);
  for (Eigen::Index g = 0; g < gauges; ++g) {
    all.segment(g * samples, samples) = Eigen::Map<const Eigen::VectorXd>(
        stations[static_cast<std::size_t>(3 * g + 1)].data(), samples);
  }
  return all;
}

/// Makes the noise of stacked records white, of unit variance.
class Whitener {
 public:
  Whitener(NoiseColour colour, const Timing& timing) {
    const auto samples = static_cast<Eigen::Index>(timing.samples);
    const double quantum = 2.0 * kRange / std::ldexp(1.0, kBits);
    std::vector<double> by_lag = covariance_of(colour, kNoise, timing.period_s(), timing.samples);
    by_lag[0] += quantum * quantum / 12.0;
    Eigen::MatrixXd covariance(samples, samples);
    for (Eigen::Index a = 0; a < samples; ++a) {
      for (Eigen::Index b = 0; b < samples; ++b) {
        covariance(a, b) = by_lag[static_cast<std::size_t>(std::abs(a - b))];
      }
    }
    white_sd_ = std::sqrt(by_lag[0]);
    if (colour != NoiseColour::white) {
      factor_.compute(covariance);
    }
  }

  void apply(Eigen::MatrixXd& columns) const {
    const Eigen::Index samples = factor_.rows();
    if (samples == 0) {
      columns /= white_sd_;
      return;
    }
    for (Eigen::Index from = 0; from < columns.rows(); from += samples) {
      auto own = columns.middleRows(from, samples);
      factor_.matrixL().solveInPlace(own);
    }
  }

 private:
  double white_sd_ = 1.0;
  Eigen::LLT<Eigen::MatrixXd> factor_;  ///< empty where the noise is white
};

/// Removes from whitened columns whatever sources and offsets can make.
class FreeOfSources {
 public:
  FreeOfSources(const BarWorld& world, const Responses& responses, const Whitener& whitener) {
    const Timing& timing = world.timing;
    const auto samples = static_cast<Eigen::Index>(timing.samples);
    const auto knots = static_cast<Eigen::Index>(world.shots.front().source.size());
    const auto gauges = static_cast<Eigen::Index>(SolidBarShots::kGauges);
    design_ = Eigen::MatrixXd::Zero(gauges * samples, knots + gauges);
    for (Eigen::Index k = 0; k < knots; ++k) {
      Record source(static_cast<std::size_t>(k) + 1, 0.0);
      source.back() = 1.0;
      for (Eigen::Index g = 0; g < gauges; ++g) {
        const Record record = superpose(responses.strain[static_cast<std::size_t>(3 * g + 1)],
                                        responses.step_s, source, timing.periods_per_knot,
                                        timing.period_s(), -timing.lead_s, timing.samples);
        design_.col(k).segment(g * samples, samples) =
            Eigen::Map<const Eigen::VectorXd>(record.data(), samples);
      }
    }
    for (Eigen::Index g = 0; g < gauges; ++g) {
      design_.col(knots + g).segment(g * samples, samples).setOnes();
    }
    whitener.apply(design_);
    design_.leftCols(knots) /= design_.leftCols(knots).cwiseAbs().maxCoeff();
    design_.rightCols(gauges) /= design_.rightCols(gauges).cwiseAbs().maxCoeff();
    Eigen::MatrixXd normal = design_.transpose() * design_;
    normal.diagonal().array() += 1e-11 * normal.diagonal().maxCoeff();
    solver_.compute(normal);
  }

  [[nodiscard]] Eigen::MatrixXd operator()(const Eigen::MatrixXd& columns) const {
    return columns - design_ * solver_.solve(design_.transpose() * columns);
  }

 private:
  Eigen::MatrixXd design_;
  Eigen::LDLT<Eigen::MatrixXd> solver_;
};

}  // namespace

SolidBarShots::SolidBarShots(const PublishedPmma& bar)
    : world_(world_of(bar)),
      truth_{bar.material.E1_Pa, bar.material.E2_Pa, bar.material.eta2_Pa_s},
      readings_(BarForward().readings(world_)) {}

std::vector<Shot> SolidBarShots::draw(const Tolerances& tolerances, std::mt19937_64& random,
                                      NoiseColour colour) const {
  std::normal_distribution<double> normal(0.0, 1.0);
  Bench bench;
  bench.kind = BenchKind::bar;
  bench.sampling_frequency_Hz = {world_.timing.rate_Hz, 0.0};
  bench.input.length_m = {world_.length_m};
  bench.input.diameter_m = {2.0 * world_.radius_m};
  bench.input.density_kg_m3 = {world_.material.density_kg_m3};
  bench.input.poisson_ratio = {world_.material.poisson_ratio};
  std::array<double, kGauges> gain{};
  std::array<double, kGauges> moved_m{};
  for (std::size_t g = 0; g < kGauges; ++g) {
    Gauge gauge;
    gauge.name = "g" + std::to_string(g + 1);
    gauge.bar = "input";
    gauge.position_m = {kPlaces_m[g], tolerances.position_sd_m};
    gauge.unit = "V";
    gauge.strain_per_V = Measured{1.0, tolerances.gain_sd};
    bench.gauges.push_back(gauge);
    gain[g] = 1.0 + tolerances.gain_sd * normal(random);
    moved_m[g] = tolerances.position_sd_m * normal(random);
  }
  std::vector<Shot> shots;
  for (const auto& stations : readings_) {
    std::vector<Record> records;
    for (std::size_t g = 0; g < kGauges; ++g) {
      records.push_back(displaced(stations, g, moved_m[g]));
      for (double& value : records.back()) {
        value *= gain[g];
      }
    }
    if (colour != NoiseColour::white) {
      for (Record& record : records) {
        const Record own = noise(colour, kNoise, world_.timing.period_s(), record.size(), random);
        std::transform(record.begin(), record.end(), own.begin(), record.begin(), std::plus<>());
      }
    }
    const auto seed = static_cast<unsigned>(random());
    shots.push_back(
        digitise(bench, records, colour == NoiseColour::white ? kNoise : 0.0, kBits, kRange, seed));
  }
  return shots;
}

std::array<double, 3> SolidBarShots::bound(const Tolerances& tolerances, NoiseColour colour) const {
  constexpr double kStep = 2e-3;
  const auto gauges = static_cast<Eigen::Index>(kGauges);
  const auto samples = static_cast<Eigen::Index>(world_.timing.samples);
  if (!beside_) {
    beside_.emplace();
    for (std::size_t m = 0; m < beside_->moved.size(); ++m) {
      BarWorld world = world_;
      double& number = m == 0   ? world.material.E1_Pa
                       : m == 1 ? world.material.E2_Pa
                                : world.material.eta2_Pa_s;
      number *= std::exp(kStep);
      beside_->moved[m] = BarForward().readings(world);
    }
    beside_->responses = BarForward().sensor_responses(world_, world_.shots.front());
  }
  const Whitener whitener(colour, world_.timing);
  const FreeOfSources free(world_, beside_->responses, whitener);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(3 + 2 * gauges, 3 + 2 * gauges);
  for (std::size_t s = 0; s < readings_.size(); ++s) {
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(gauges * samples, 3 + 2 * gauges);
    const Eigen::VectorXd at = stacked(readings_[s]);
    for (Eigen::Index m = 0; m < 3; ++m) {
      columns.col(m) = (stacked(beside_->moved[static_cast<std::size_t>(m)][s]) - at) / kStep;
    }
    for (Eigen::Index g = 0; g < gauges; ++g) {
      const auto rows = Eigen::seqN(g * samples, samples);
      const auto& before = readings_[s][static_cast<std::size_t>(3 * g)];
      const auto& behind = readings_[s][static_cast<std::size_t>(3 * g + 2)];
      columns(rows, 3 + g) = at(rows);
      columns(rows, 3 + gauges + g) = (Eigen::Map<const Eigen::VectorXd>(behind.data(), samples) -
                                       Eigen::Map<const Eigen::VectorXd>(before.data(), samples)) /
                                      (2.0 * kBeside_m);
    }
    whitener.apply(columns);
    const Eigen::MatrixXd left = free(columns);
    information += left.transpose() * left;
  }
  constexpr double kExact = 1e-9;
  for (Eigen::Index g = 0; g < gauges; ++g) {
    information(3 + g, 3 + g) += std::pow(std::max(tolerances.gain_sd, kExact), -2);
    information(3 + gauges + g, 3 + gauges + g) +=
        std::pow(std::max(tolerances.position_sd_m, kExact), -2);
  }
  // Gains, places and moduli differ by many orders of magnitude.
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd covariance =
      scale.asDiagonal() * (scale.asDiagonal() * information * scale.asDiagonal()).inverse() *
      scale.asDiagonal();
  return {std::sqrt(covariance(0, 0)), std::sqrt(covariance(1, 1)), std::sqrt(covariance(2, 2))};
}

}  // namespace kolsky::testing
