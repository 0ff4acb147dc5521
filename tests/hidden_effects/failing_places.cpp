#include "tests/hidden_effects/failing_places.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/non_central_chi_squared.hpp>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <random>
#include <unsupported/Eigen/FFT>

namespace kolsky::scoring {

namespace {

using testing::Campaign;
using testing::Readings;
using Records = std::vector<std::vector<double>>;

// What is commonly asked of a test: false in one of twenty cases, found in four of five.
constexpr double kLevel = 0.05;
constexpr double kPower = 0.8;
constexpr double kTrace = 1e-3;
constexpr int kMostSteps = 12;
constexpr double kAtRest = 0.1;  // of chi-square
constexpr double kLeastDamping = 1e-3;
constexpr double kMostDamping = 1e3;
constexpr int kMostTurns = 12;
constexpr double kSettled = 1.0;  // of chi-square, in a turn
constexpr int kNoiseDraws = 200;
// What the whole change has less of than this share at a gauge is rounding.
constexpr double kUntouched = 1e-9;

double risen(double time_s, double at_s, double fade_s) {
  const double place = fade_s > 0.0     ? std::clamp(2.0 * (time_s - at_s) / fade_s, -1.0, 1.0)
                       : time_s >= at_s ? 1.0
                                        : -1.0;
  return std::sin(std::numbers::pi / 4.0 * (place + 1.0));
}

std::vector<double> weights_of(const Stretch& stretch, double period_s, std::size_t samples) {
  std::vector<double> weights(samples);
  for (std::size_t n = 0; n < samples; ++n) {
    const double t = static_cast<double>(n) * period_s;
    const double gone = risen(t, stretch.end_s, stretch.fade_out_s);
    weights[n] =
        risen(t, stretch.start_s, stretch.fade_in_s) * std::sqrt(std::max(0.0, 1.0 - gone * gone));
  }
  return weights;
}

/// Whether there may be such a bar: a long step of a fit may lead to moduli below nothing.
bool could_be(const Campaign& campaign) {
  constexpr double kSlowest_m_per_s = 100.0;
  constexpr double kQuickest_m_per_s = 30e3;
  const testing::TrueMaterial& material = campaign.world.material;
  const double speed_m_per_s = std::sqrt(material.E1_Pa / material.density_kg_m3);
  return speed_m_per_s > kSlowest_m_per_s && speed_m_per_s < kQuickest_m_per_s &&
         (material.elastic || (material.E2_Pa > 0.0 && material.eta2_Pa_s > 0.0)) &&
         std::ranges::all_of(campaign.world.gauges,
                             [](const auto& gauge) { return gauge.position_m > 0.0; });
}

double square_of(const std::vector<double>& record) {
  double sum = 0.0;
  for (const double value : record) {
    sum += value * value;
  }
  return sum;
}

// What is constant is not judged: zero on average before the pulse.
std::vector<double> level(const std::vector<double>& record, const std::vector<double>& quiet,
                          const std::vector<double>& offset) {
  double cross = 0.0;
  double square = 0.0;
  for (std::size_t n = 0; n < quiet.size(); ++n) {
    cross += quiet[n] * quiet[n] * record[n] * offset[n];
    square += quiet[n] * quiet[n] * offset[n] * offset[n];
  }
  std::vector<double> out = record;
  for (std::size_t n = 0; square > 0.0 && n < out.size(); ++n) {
    out[n] -= cross / square * offset[n];
  }
  return out;
}

// Energies of a record in bands, once it is weighted.
class Bands {
 public:
  Bands(const std::vector<std::pair<double, double>>& bands_Hz, double period_s)
      : bands_Hz_(bands_Hz), period_s_(period_s) {
    transform_.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  }

  std::vector<double> energies(const std::vector<double>& record,
                               const std::vector<double>& weights) {
    std::vector<double> part(record.size());
    for (std::size_t n = 0; n < part.size(); ++n) {
      part[n] = record[n] * weights[n];
    }
    transform_.fwd(lines_, part);
    const double width_Hz = 1.0 / (period_s_ * static_cast<double>(part.size()));
    std::vector<double> out(bands_Hz_.size(), 0.0);
    for (std::size_t b = 0; b < out.size(); ++b) {
      // What lies below the lowest is there by the windows' fading alone, and counts to it.
      const double from_Hz = b == 0 ? 0.0 : bands_Hz_[b].first;
      for (auto f = static_cast<std::size_t>(std::ceil(from_Hz / width_Hz - 1e-6));
           f < lines_.size() && static_cast<double>(f) * width_Hz < bands_Hz_[b].second; ++f) {
        out[b] += (f == 0 ? 0.5 : 1.0) * std::norm(lines_[f]);
      }
    }
    return out;
  }

 private:
  const std::vector<std::pair<double, double>>& bands_Hz_;
  double period_s_;
  Eigen::FFT<double> transform_;
  std::vector<std::complex<double>> lines_;
};

// Of a place's energy under noise.
struct Moments {
  double mean = 0.0;
  double variance = 0.0;
};

std::vector<Moments> moments_of(const std::vector<std::vector<double>>& draws) {
  std::vector<Moments> out(draws.front().size());
  const auto count = static_cast<double>(draws.size());
  for (std::size_t b = 0; b < out.size(); ++b) {
    for (const std::vector<double>& draw : draws) {
      out[b].mean += draw[b] / count;
    }
    for (const std::vector<double>& draw : draws) {
      const double off = draw[b] - out[b].mean;
      out[b].variance += off * off / (count - 1.0);
    }
  }
  return out;
}

std::vector<bool> touched_gauges(const Readings& change) {
  std::vector<double> energy(change.front().size(), 0.0);
  for (const Records& shot : change) {
    for (std::size_t g = 0; g < shot.size(); ++g) {
      energy[g] += square_of(shot[g]);
    }
  }
  const double most = *std::ranges::max_element(energy);
  std::vector<bool> touched;
  for (const double own : energy) {
    touched.push_back(own > kUntouched * most);
  }
  return touched;
}

void mark_traces(std::vector<PlaceTruth>& places) {
  std::map<std::size_t, double> by_shot;
  for (const PlaceTruth& one : places) {
    by_shot[std::get<2>(one.place)] += one.excess;
  }
  for (PlaceTruth& one : places) {
    one.trace = one.excess < kTrace * by_shot[std::get<2>(one.place)];
  }
}

std::vector<Records> draw_noise(const SourceFreedom& freedom, std::size_t gauges,
                                std::size_t samples) {
  std::mt19937_64 random(29);
  std::normal_distribution<double> normal;
  std::vector<Records> draws;
  for (int i = 0; i < kNoiseDraws; ++i) {
    Records records(gauges, std::vector<double>(samples));
    for (std::vector<double>& record : records) {
      std::ranges::generate(record, [&] { return normal(random); });
    }
    draws.push_back(freedom.remainder(std::move(records)));
  }
  return draws;
}

}  // namespace

double findable_excess(double freedom) {
  const double limit =
      boost::math::quantile(boost::math::complement(boost::math::chi_squared(freedom), kLevel));
  return boost::math::non_central_chi_squared::find_non_centrality(freedom, limit, 1.0 - kPower);
}

bool PlaceTruth::fails() const {
  return freedom > 0.0 && !trace && excess > findable_excess(freedom);
}

FailingPlaces::FirstOrder::FirstOrder(const Campaign& about)
    : prober(about), freedom(prober.freedom()), nuisances(prober.nuisances()) {
  const auto count = static_cast<Eigen::Index>(nuisances.size());
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(count, count);
  for (std::size_t shot = 0; shot < about.world.shots.size(); ++shot) {
    std::vector<const Records*> of_shot;
    for (const Direction& direction : nuisances) {
      of_shot.push_back(&direction.readings[shot]);
    }
    products += freedom.remaining_products(of_shot);
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    Direction& direction = nuisances[static_cast<std::size_t>(i)];
    products(i, i) += direction.known();
    direction.readings = left_of(std::move(direction.readings));
  }
  information = std::move(products);
}

Eigen::VectorXd FailingPlaces::FirstOrder::step(const Eigen::VectorXd& pull, double damping) const {
  Eigen::MatrixXd damped = information;
  damped.diagonal() *= 1.0 + damping;
  return damped.ldlt().solve(pull);
}

Readings FailingPlaces::FirstOrder::left_of(Readings change) const {
  for (Records& shot : change) {
    shot = freedom.remainder(std::move(shot));
  }
  return change;
}

Eigen::VectorXd FailingPlaces::FirstOrder::pull_of(const Readings& left,
                                                   const Eigen::VectorXd& places) const {
  Eigen::VectorXd pull = Eigen::VectorXd::Zero(places.size());
  for (std::size_t i = 0; i < nuisances.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    pull[at] = -nuisances[i].known() * places[at];
    for (std::size_t shot = 0; shot < left.size(); ++shot) {
      const Records& own = nuisances[i].readings[shot];
      for (std::size_t g = 0; g < own.size(); ++g) {
        pull[at] += std::inner_product(own[g].begin(), own[g].end(), left[shot][g].begin(), 0.0);
      }
    }
  }
  return pull;
}

double FailingPlaces::FirstOrder::objective(const Readings& left,
                                            const Eigen::VectorXd& places) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < nuisances.size(); ++i) {
    sum += nuisances[i].known() * std::pow(places[static_cast<Eigen::Index>(i)], 2);
  }
  for (const Records& shot : left) {
    for (const std::vector<double>& record : shot) {
      sum += square_of(record);
    }
  }
  return sum;
}

FailingPlaces::FailingPlaces(const Campaign& bare)
    : bare_(bare),
      about_bare_(bare),
      noise_(draw_noise(about_bare_.freedom, bare.world.gauges.size(), bare.world.timing.samples)) {
}

Campaign FailingPlaces::bare_at(const Eigen::VectorXd& places) const {
  Campaign moved = bare_;
  for (Eigen::Index i = 0; i < places.size(); ++i) {
    about_bare_.nuisances[static_cast<std::size_t>(i)].move(moved, places[i]);
  }
  return moved;
}

double FailingPlaces::approach(FirstOrder& about, const Campaign& hidden, Fit& fit) const {
  const auto left_at = [&](const Eigen::VectorXd& places) {
    return about.left_of(about.prober.whole_change(hidden, bare_at(places)));
  };
  fit.left = left_at(fit.places);
  const double begun = about.objective(fit.left, fit.places);
  double least = begun;
  double damping = 0.0;
  for (int step = 0; step < kMostSteps && damping < kMostDamping;) {
    const Eigen::VectorXd pull = about.pull_of(fit.left, fit.places);
    const Eigen::VectorXd move = about.step(pull, damping);
    if (pull.dot(move) < kAtRest) {
      break;
    }
    const Eigen::VectorXd next = fit.places + move;
    const bool possible = could_be(bare_at(next));
    Readings there = possible ? left_at(next) : Readings{};
    const double found = possible ? about.objective(there, next) : INFINITY;
    if (!(found < least)) {
      damping = std::max(kLeastDamping, 10.0 * damping);
      continue;
    }
    ++step;
    fit.places = next;
    fit.left = std::move(there);
    least = found;
    damping = damping > kLeastDamping ? 0.1 * damping : 0.0;
  }
  return begun - least;
}

// By Levenberg and Marquardt's steps, with derivatives of the bare campaign and then of where these
// lead, until nothing falls any more: a large misfit carries moduli along a curved valley to where
// they do something else.
Readings FailingPlaces::left_by_fit(const Campaign& hidden) {
  Fit fit{Eigen::VectorXd::Zero(static_cast<Eigen::Index>(about_bare_.nuisances.size())), {}};
  double fallen = approach(about_bare_, hidden, fit);
  for (int turn = 1; turn < kMostTurns && fallen > kSettled; ++turn) {
    const Campaign moved = bare_at(fit.places);
    FirstOrder about_moved(moved);
    fallen = approach(about_moved, hidden, fit);
  }
  return std::move(fit.left);
}

std::vector<PlaceTruth> FailingPlaces::of(const Campaign& hidden, const Places& places) {
  const Readings left = left_by_fit(hidden);
  const std::vector<bool> touched = touched_gauges(about_bare_.prober.whole_change(hidden, bare_));
  const testing::Timing& timing = bare_.world.timing;
  Bands bands(places.bands_Hz, timing.period_s());
  std::vector<PlaceTruth> out;
  for (std::size_t g = 0; g < touched.size(); ++g) {
    const std::string& gauge = bare_.world.gauges[g].name;
    std::vector<std::vector<double>> quiet(left.size());
    for (const Stretch& stretch : places.stretches) {
      if (stretch.gauge == gauge && stretch.quiet) {
        quiet[stretch.shot] = weights_of(stretch, timing.period_s(), timing.samples);
      }
    }
    for (const Stretch& stretch : places.stretches) {
      if (stretch.gauge != gauge) {
        continue;
      }
      const std::vector<double> weights = weights_of(stretch, timing.period_s(), timing.samples);
      const auto energies = [&](const std::vector<double>& record) {
        return bands.energies(level(record, quiet[stretch.shot], about_bare_.freedom.offset()),
                              weights);
      };
      const std::vector<double> found = energies(left[stretch.shot][g]);
      std::vector<std::vector<double>> draws;
      for (const Records& draw : noise_) {
        draws.push_back(energies(draw[g]));
      }
      const std::vector<Moments> noise = moments_of(draws);
      for (std::size_t b = 0; b < found.size(); ++b) {
        PlaceTruth truth{{gauge, stretch.window, stretch.shot, b}, 0.0, 0.0, touched[g], false};
        if (noise[b].variance > 0.0) {
          truth.freedom = 2.0 * noise[b].mean * noise[b].mean / noise[b].variance;
          truth.excess = found[b] * truth.freedom / noise[b].mean;
        }
        out.push_back(std::move(truth));
      }
    }
  }
  mark_traces(out);
  return out;
}

}  // namespace kolsky::scoring
