#include "processing/prediction/ball_prediction.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <atomic>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <optional>

#include "processing/base/error.hpp"
#include "processing/impact/impact.hpp"
#include "processing/reduction/ball/contact_numbers.hpp"

namespace kolsky {

namespace {

/// What one impact came to, read as its measurement reads it.
struct Outcome {
  ContactNumbers contact;
  double restitution = 0.0;
  double strained_share = 0.0;
};

struct Draw {
  Material core;
  Material cover;
  double speed = 0.0;  ///< in deviations
};

class Numbers {
 public:
  explicit Numbers(unsigned seed) : engine_(seed) {}
  double operator()() { return normal_(engine_); }

 private:
  boost::random::mt19937 engine_;
  boost::random::normal_distribution<double> normal_;
};

constexpr std::size_t kModuli = 3;
using Moduli = std::array<double, kModuli>;

Moduli moduli_of(const Material& material) {
  return {material.E1_Pa(), material.E2_Pa(), material.eta2_Pa_s()};
}

/// Draws of log moduli: they stay positive, and a per cent is a per cent.
class MaterialDraws {
 public:
  explicit MaterialDraws(const BallPosterior& ball) : ball_(ball) {
    const Moduli core = moduli_of(ball.core.material);
    const Moduli cover = moduli_of(ball.cover.material);
    Joint relative;
    for (std::size_t i = 0; i < kModuli; ++i) {
      for (std::size_t j = 0; j < kModuli; ++j) {
        const auto a = static_cast<Eigen::Index>(i);
        const auto b = static_cast<Eigen::Index>(j);
        relative(a, b) = ball.core.covariance[i][j] / (core[i] * core[j]);
        relative(a + 3, b + 3) = ball.cover.covariance[i][j] / (cover[i] * cover[j]);
        relative(a, b + 3) = relative(b + 3, a) = ball.between[i][j] / (core[i] * cover[j]);
      }
    }
    // By eigenvectors: a covariance may be of lower rank, or off by its last bits.
    const Eigen::SelfAdjointEigenSolver<Joint> solver(relative);
    root_ = solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  }

  Draw next(Numbers& numbers) const {
    Eigen::Matrix<double, 6, 1> white;
    for (double& number : white) {
      number = numbers();
    }
    const Eigen::Matrix<double, 6, 1> move = root_ * white;
    Draw draw{ball_.core.material, ball_.cover.material, numbers()};
    Eigen::Index at = 0;
    for (Material* material : {&draw.core, &draw.cover}) {
      material->E1_Pa().value *= std::exp(move[at++]);
      material->E2_Pa().value *= std::exp(move[at++]);
      material->eta2_Pa_s().value *= std::exp(move[at++]);
    }
    return draw;
  }

 private:
  using Joint = Eigen::Matrix<double, 6, 6>;
  const BallPosterior& ball_;
  Joint root_;
};

double interpolated(const std::vector<double>& values, double place) {
  if (place < 0.0) {
    return 0.0;
  }
  const auto n = static_cast<std::size_t>(place);
  const double share = place - static_cast<double>(n);
  return n + 1 < values.size() ? (1.0 - share) * values[n] + share * values[n + 1] : 0.0;
}

struct Spread {
  double mean = 0.0;
  double sd = 0.0;
};

template <typename Value>
Spread spread_of(const std::vector<std::optional<Outcome>>& outcomes, const Value& value) {
  double sum = 0.0;
  double count = 0.0;
  for (const auto& outcome : outcomes) {
    if (outcome) {
      sum += value(*outcome);
      ++count;
    }
  }
  Spread spread;
  spread.mean = sum / count;
  for (const auto& outcome : outcomes) {
    if (outcome) {
      spread.sd += std::pow(value(*outcome) - spread.mean, 2) / (count - 1.0);
    }
  }
  spread.sd = std::sqrt(spread.sd);
  return spread;
}

/// The runs behind one speed.
struct Runs {
  std::optional<Outcome> fine;
  std::optional<Outcome> coarse;
  std::vector<std::optional<Outcome>> draws;
};

template <typename Value>
Foretold foretold(const Runs& runs, const Value& value) {
  return {value(*runs.fine), spread_of(runs.draws, value).sd,
          std::abs(value(*runs.fine) - value(*runs.coarse))};
}

BallPrediction summary_of(const ForetoldSpeed& asked, const Runs& runs, double interval_s) {
  BallPrediction prediction;
  prediction.asked = asked;
  prediction.strained_share = runs.fine->strained_share;
  prediction.failed = static_cast<std::size_t>(std::count_if(
      runs.draws.begin(), runs.draws.end(), [](const auto& outcome) { return !outcome; }));
  if (runs.draws.size() < prediction.failed + 2) {
    throw InputError("posterior", "is so wide that no drawn ball survives the impact",
                     "identify the specimens from more shots");
  }
  prediction.peak_force_N = foretold(runs, [](const Outcome& o) { return o.contact.peak_force_N; });
  prediction.contact_time_s =
      foretold(runs, [](const Outcome& o) { return o.contact.contact_time_s; });
  prediction.impulse_N_s = foretold(runs, [](const Outcome& o) { return o.contact.impulse_N_s; });
  prediction.restitution = foretold(runs, [](const Outcome& o) { return o.restitution; });
  const auto force_at = [&](const Outcome& outcome, double time_s) {
    return interpolated(outcome.contact.force_N, (time_s + outcome.contact.foot_s) / interval_s);
  };
  for (std::size_t n = 0; n < runs.fine->contact.force_N.size(); ++n) {
    const double time_s = static_cast<double>(n) * interval_s;
    prediction.time_s.push_back(time_s);
    prediction.force_N.push_back(force_at(*runs.fine, time_s));
    prediction.force_sd_N.push_back(
        spread_of(runs.draws, [&](const Outcome& o) { return force_at(o, time_s); }).sd);
  }
  return prediction;
}

}  // namespace

std::vector<BallPrediction> foretell_impacts(
    const Bench& bench, const BallPosterior& ball, const std::vector<ForetoldSpeed>& speeds,
    const PredictionOptions& options, const Workers& workers,
    const std::function<void(std::size_t, std::size_t)>& progress) {
  Numbers numbers(options.seed);
  const MaterialDraws materials(ball);
  std::vector<Draw> draws;
  for (std::size_t i = 0; i < options.draws; ++i) {
    draws.push_back(materials.next(numbers));
  }
  const double interval_s = impact::kHistoryInterval_s;
  const auto run = [&](const Material& core_material, const Material& cover_material,
                       const ForetoldSpeed& asked, double speed_m_per_s, std::size_t elements) {
    const auto part = [&](const Material& material) {
      impact::BallMaterial own{material, options.reading};
      own.law = options.law;
      return own;
    };
    impact::ImpactModel model = impact::impact_on(bench, part(core_material), part(cover_material),
                                                  impact::TargetKind::dashpot, speed_m_per_s);
    model.friction = options.friction;
    model.elements = elements;
    const impact::ImpactHistory history = impact::simulate(model);
    // Room behind the release, so that the low-passed force has come to rest.
    std::vector<double> force = history.force_N;
    force.resize(force.size() + static_cast<std::size_t>(100e-6 / interval_s), 0.0);
    return Outcome{contact_numbers(force, interval_s, asked.low_pass_Hz, asked.contact_threshold),
                   history.restitution, history.strained_share.front()};
  };
  std::vector<Runs> runs(speeds.size());
  for (Runs& speed : runs) {
    speed.draws.resize(draws.size());
  }
  const std::size_t each = draws.size() + 2;
  std::atomic<std::size_t> done = 0;
  workers.run(each * speeds.size(), [&](std::size_t task, std::size_t /*worker*/) {
    const ForetoldSpeed& asked = speeds[task / each];
    Runs& speed = runs[task / each];
    const std::size_t which = task % each;
    if (which == 0) {
      speed.fine = run(ball.core.material, ball.cover.material, asked, asked.speed_m_per_s,
                       options.fine_elements);
    } else if (which == 1) {
      speed.coarse = run(ball.core.material, ball.cover.material, asked, asked.speed_m_per_s,
                         options.elements);
    } else {
      const Draw& draw = draws[which - 2];
      try {
        speed.draws[which - 2] =
            run(draw.core, draw.cover, asked,
                asked.speed_m_per_s + draw.speed * asked.speed_m_per_s.sd, options.elements);
      } catch (const InputError&) {
        // A draw far out may invert an element; it is counted.
      }
    }
    const std::size_t now = ++done;
    if (progress) {
      progress(now, each * speeds.size());
    }
  });
  std::vector<BallPrediction> predictions;
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    predictions.push_back(summary_of(speeds[i], runs[i], interval_s));
  }
  return predictions;
}

}  // namespace kolsky
