#include "processing/criticism/impact_study.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "processing/algebra/algebra.hpp"
#include "processing/criticism/candidates.hpp"
#include "processing/criticism/effect_starts.hpp"
#include "processing/criticism/statistics.hpp"

namespace kolsky {

namespace {

/// Rows of a group's shots, one below the other.
Eigen::MatrixXd rows_of(const Eigen::MatrixXd& all, const SpeedGroup& group, Eigen::Index size) {
  Eigen::MatrixXd rows(size * static_cast<Eigen::Index>(group.shots.size()), all.cols());
  Eigen::Index at = 0;
  for (const std::size_t n : group.shots) {
    rows.middleRows(at, size) = all.middleRows(static_cast<Eigen::Index>(n) * size, size);
    at += size;
  }
  return rows;
}

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

/// False discovery held at 0.5 % (Benjamini and Hochberg).
void mark_significant(std::vector<ImpactTile>& tiles) {
  std::vector<ImpactTile*> ranked;
  for (ImpactTile& tile : tiles) {
    ranked.push_back(&tile);
  }
  std::sort(ranked.begin(), ranked.end(),
            [](const ImpactTile* a, const ImpactTile* b) { return a->log_p < b->log_p; });
  constexpr double kFalse = 0.005;
  std::size_t last = 0;
  for (std::size_t i = 0; i < ranked.size(); ++i) {
    if (ranked[i]->log_p <=
        std::log(kFalse * static_cast<double>(i + 1) / static_cast<double>(ranked.size()))) {
      last = i + 1;
    }
  }
  for (std::size_t i = 0; i < last; ++i) {
    ranked[i]->significant = true;
  }
}

/// Something filed is some two of its deviations off.
bool strained(const Composition& composition, const std::vector<double>& theta) {
  constexpr double kFar = 1.9;
  for (std::size_t i = 0; i < theta.size(); ++i) {
    const FreeNumber& number = composition.numbers()[i];
    if (number.prior_sd > 0.0 &&
        std::abs(number.value_at(theta[i]) - number.prior_mean) > kFar * number.prior_sd) {
      return true;
    }
  }
  return false;
}

}  // namespace

Studied ImpactStudy::finish(const Model& model, Composition composition, ModelFit fit) const {
  const double used =
      static_cast<double>(fit.residual.size()) - fit.degrees_of_freedom(composition);
  const Misfit misfit = misfit_of(fit.residual, used);
  if (fit.covariance.size() > 0) {
    fit.doubt = residuals_.doubt_of(fit.jacobian, fit.covariance);
    if (second_minimum_ && second_minimum_->theta.size() == fit.theta.size()) {
      // Two minima: the covariance of a mixture, each by what its squares count.
      const double here = 1.0 / (1.0 + std::exp(-0.5 * second_minimum_->behind / kSolverDoubt));
      const Eigen::VectorXd apart =
          Eigen::Map<const Eigen::VectorXd>(second_minimum_->theta.data(), fit.doubt.rows()) -
          Eigen::Map<const Eigen::VectorXd>(fit.theta.data(), fit.doubt.rows());
      fit.doubt += here * (1.0 - here) * apart * apart.transpose();
    }
  }
  Model after = fitted(model, composition, fit);
  return {std::move(after), std::move(composition), std::move(fit), misfit};
}

bool judges_whole(const Model& model) {
  return model.find("end-reflection") != nullptr;
}

/// A ball with little friction has a second minimum where friction is filed, with moduli and law in
/// its place, and coarse forces do not lead from there to the other. So where what is filed is
/// strained the two are compared, each with forces that were taken where it is (docs/impact.md).
ModelFit ImpactStudy::or_with_little_friction(const Model& model, const Composition& composition,
                                              ModelFit fit) {
  const EffectUse* friction = model.find("contact-friction");
  const bool filed =
      friction != nullptr && friction->values[0].free && friction->values[0].prior_sd > 0.0;
  if (!filed || !strained(composition, fit.theta)) {
    return fit;
  }
  const auto again_at = [&](const std::vector<double>& theta) {
    residuals_.anchor(composition, theta, ImpactResiduals::AnchorBy::middle);
    return fit_by_secants(composition, residuals_, executor_, theta);
  };
  constexpr double kFiledDeviations = 3.0;
  const ModelValue& mu = friction->values[0];
  std::size_t own = 0;
  while (composition.uses()[composition.numbers()[own].use].id() != friction->id()) {
    ++own;
  }
  const FreeNumber& number = composition.numbers()[own];
  std::vector<double> little = composition.start();
  little[own] = number.inside(number.theta_of(mu.prior_mean - kFiledDeviations * mu.prior_sd));
  const ModelFit near = again_at(fit.theta);
  const ModelFit other = again_at(again_at(little).theta);
  const double ahead = near.objective() - other.objective();
  if (!std::isfinite(ahead)) {
    residuals_.anchor(composition, composition.start());
    return fit;
  }
  constexpr double kElsewhere = 2.0;  ///< of chi2: more than forces are rough by
  const bool moves = ahead > kElsewhere;
  const std::vector<double>& left = moves ? near.theta : other.theta;
  constexpr double kSame = 0.5;  ///< of what is filed: the same minimum, come to from elsewhere
  if (std::abs(number.value_at(other.theta[own]) - number.value_at(near.theta[own])) >
      kSame * mu.prior_sd) {
    second_minimum_ = SecondMinimum{left, number.value_at(left[own]), std::abs(ahead)};
  }
  residuals_.anchor(composition, moves ? other.theta : composition.start());
  return moves ? other : fit;
}

Studied ImpactStudy::fit(const Model& begun) {
  const Model model =
      at_best_starts(begun, campaign_, [&](const Composition& composition, bool first) {
        if (first) {
          residuals_.prepare(composition, composition.start());
        }
        return fit_by_secants(composition, residuals_, executor_).objective();
      });
  Composition composition(model, campaign_);
  second_minimum_.reset();
  residuals_.prepare(composition, composition.start());
  ModelFit fit = or_with_little_friction(model, composition,
                                         fit_by_secants(composition, residuals_, executor_));
  residuals_.calibrate(composition, fit.theta);
  fit = fit_by_secants(composition, residuals_, executor_, fit.theta);
  return finish(model, std::move(composition), std::move(fit));
}

Studied ImpactStudy::refit(const Model& model, const Workers& executor) {
  Composition composition(model, campaign_);
  ModelFit fit = fit_by_secants(composition, residuals_, executor);
  return finish(model, std::move(composition), std::move(fit));
}

Studied ImpactStudy::refit_near(const Model& model, const Studied& other) {
  Composition composition(model, campaign_);
  ModelFit near = fit_by_secants(composition, residuals_, executor_,
                                 carry(other.composition, other.fit.theta, composition));
  ModelFit own = fit_by_secants(composition, residuals_, executor_);
  const bool better = !(near.objective() <= own.objective());
  return finish(model, std::move(composition), better ? std::move(own) : std::move(near));
}

Studied ImpactStudy::settled(const Studied& studied) {
  residuals_.anchor(studied.composition, studied.fit.theta);
  ModelFit fit = fit_by_secants(studied.composition, residuals_, executor_, studied.fit.theta);
  return finish(studied.model, studied.composition, std::move(fit));
}

Studied ImpactStudy::allowing(double share, const Studied& studied) {
  residuals_.allow(share, studied.composition, studied.fit.theta);
  ModelFit fit = fit_by_secants(studied.composition, residuals_, executor_, studied.fit.theta);
  return finish(studied.model, studied.composition, std::move(fit));
}

Studied ImpactStudy::as_it_is(const Model& model) {
  Composition composition(model, campaign_);
  ModelFit fit;
  fit.theta = composition.start();
  residuals_.prepare(composition, fit.theta);
  residuals_.calibrate(composition, fit.theta);
  fit.residual = residuals_.evaluate(composition, fit.theta, executor_.first);
  fit.chi2 = fit.residual.squaredNorm();
  fit.converged = true;
  const Misfit misfit = misfit_of(fit.residual, 0.0);
  return {model, std::move(composition), std::move(fit), misfit};
}

std::pair<double, double> ImpactStudy::repeated(const Eigen::VectorXd& white) const {
  const auto size = static_cast<Eigen::Index>(residuals_.per_shot());
  double chi2 = 0.0;
  double freedom = 0.0;
  for (const SpeedGroup& group : residuals_.records().groups) {
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(size);
    for (const std::size_t n : group.shots) {
      mean += white.segment(static_cast<Eigen::Index>(n) * size, size);
    }
    chi2 += mean.squaredNorm() / static_cast<double>(group.shots.size());
    freedom += static_cast<double>(size) - residuals_.eliminated();
  }
  const ImpactRecords& records = residuals_.records();
  for (std::size_t g = 0; g < records.groups.size(); ++g) {
    freedom -= records.unsaid_rebounds(g) == records.groups[g].shots.size() ? 1.0 : 0.0;
  }
  return {chi2, freedom};
}

Misfit ImpactStudy::misfit_of(const Eigen::VectorXd& white, double used) const {
  Misfit misfit;
  const auto shots = static_cast<double>(campaign_.shots.size());
  const double all =
      shots * (static_cast<double>(residuals_.per_shot()) - residuals_.eliminated()) -
      static_cast<double>(residuals_.records().unsaid_rebounds());
  misfit.degrees_of_freedom = std::max(1.0, all - used);
  misfit.chi2_reduced = white.squaredNorm() / misfit.degrees_of_freedom;
  const auto [chi2, freedom] = repeated(white);
  misfit.noise_scale = all > freedom ? (white.squaredNorm() - chi2) / (all - freedom) : 1.0;
  misfit.repeatable_share = std::max(0.0, chi2 - freedom) / residuals_.signal_energy();
  misfit.noise_floor_share = all / residuals_.signal_energy();
  misfit.repeatable_log_p = log_chi2_tail(chi2 / std::max(1.0, misfit.noise_scale), freedom);
  return misfit;
}

ImpactComparison ImpactStudy::compare(const Studied& studied) {
  ImpactComparison out;
  out.misfit = studied.misfit;
  const auto foretold =
      residuals_.foretell(studied.composition, studied.fit.theta, executor_.first);
  const ImpactRecords& records = residuals_.records();
  const std::size_t samples = records.window.samples;
  const auto size = static_cast<Eigen::Index>(residuals_.per_shot());
  const double force_per_strain = residuals_.force_per_strain_N();
  double excess = 0.0;
  for (std::size_t g = 0; g < records.groups.size(); ++g) {
    const SpeedGroup& group = records.groups[g];
    const auto count = static_cast<double>(group.shots.size());
    SpeedSummary summary;
    summary.speed_m_per_s = group.speed_m_per_s;
    summary.shots = group.shots.size();
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(size);
    Eigen::VectorXd reading = Eigen::VectorXd::Zero(size);
    double rebounds = 0.0;
    for (const std::size_t n : group.shots) {
      mean += foretold.residual[n] / count;
      reading += foretold.reading[n] / count;
      const ShotFacts& facts = campaign_.shots[n].facts;
      summary.restitution_foretold +=
          foretold.rebound_m_per_s[n] / *facts.incident_speed_m_per_s / count;
      if (facts.rebound_speed_m_per_s) {
        summary.restitution_measured +=
            std::abs(*facts.rebound_speed_m_per_s) / *facts.incident_speed_m_per_s;
        rebounds += 1.0;
      }
    }
    summary.restitution_measured /= std::max(1.0, rebounds);
    // What every shot may offset by itself is no misfit.
    for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
      auto own =
          mean.segment(static_cast<Eigen::Index>(j * samples), static_cast<Eigen::Index>(samples));
      own.array() -= own.mean();
    }
    const auto gauges = static_cast<Eigen::Index>(residuals_.of_gauges());
    const double peak = reading.head(gauges).cwiseAbs().maxCoeff();
    summary.rms_percent = 100.0 * rms(mean.head(gauges)) / peak;
    summary.noise_percent = 100.0 * std::sqrt(records.noise[0][0] / count) / peak;
    for (std::size_t k = 0; k < samples; ++k) {
      const auto i = static_cast<Eigen::Index>(campaign_.reference * samples + k);
      summary.foretold_N.push_back(reading[i] * force_per_strain);
      summary.measured_N.push_back((reading[i] + mean[i]) * force_per_strain);
    }
    summary.peak_foretold_N =
        *std::max_element(summary.foretold_N.begin(), summary.foretold_N.end());
    summary.peak_measured_N =
        *std::max_element(summary.measured_N.begin(), summary.measured_N.end());
    Eigen::VectorXd white = Eigen::VectorXd::Zero(size);
    for (const std::size_t n : group.shots) {
      white += studied.fit.residual.segment(static_cast<Eigen::Index>(n) * size, size);
    }
    summary.chi2_reduced =
        white.squaredNorm() / count / (static_cast<double>(size) - residuals_.eliminated());
    out.speeds.push_back(std::move(summary));

    const Eigen::MatrixXd covariance = residuals_.covariance(g);
    for (const std::size_t n : group.shots) {
      if (records.rebound[n]) {
        ImpactTile& tile = out.tiles.emplace_back();
        tile.shot = n;
        tile.window = kRebound;
        tile.freedom = 1.0;
        tile.chi2 = std::pow(foretold.residual[n][gauges], 2) / covariance(gauges, gauges);
        tile.sigma = std::sqrt(tile.chi2);
        tile.percent_of_peak =
            100.0 * std::abs(foretold.residual[n][gauges] / foretold.reading[n][gauges]);
        tile.log_p = log_chi2_tail(tile.chi2, tile.freedom);
        excess += std::max(0.0, tile.chi2 - tile.freedom);
      }
      for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
        const auto first = static_cast<Eigen::Index>(j * samples);
        const Eigen::VectorXd own =
            foretold.reading[n].segment(first, static_cast<Eigen::Index>(samples));
        for (const Window& window : windows_of(own)) {
          const std::size_t half = std::max<std::size_t>(1, window.count / 3);
          for (const bool slow : {true, false}) {
            const std::size_t from = slow ? 0 : half;
            const std::size_t end = slow ? half : window.count;
            if (from == end) {
              continue;
            }
            const Eigen::MatrixXd basis = cosines(static_cast<std::size_t>(first) + window.first,
                                                  window.count, from, end, size);
            const Eigen::VectorXd part = basis.transpose() * foretold.residual[n];
            const Eigen::MatrixXd spread = basis.transpose() * covariance * basis;
            ImpactTile tile;
            tile.gauge = j;
            tile.shot = n;
            tile.window = window.name;
            const double cycle_s =
                2.0 * static_cast<double>(window.count) * records.window.period_s;
            tile.low_Hz = static_cast<double>(from) / cycle_s;
            tile.high_Hz = static_cast<double>(end) / cycle_s;
            tile.chi2 = part.dot(solve_symmetric(spread, part));
            tile.freedom = static_cast<double>(end - from);
            tile.sigma = std::sqrt(tile.chi2 / tile.freedom);
            tile.percent_of_peak =
                100.0 * part.norm() / std::sqrt(static_cast<double>(window.count)) / peak;
            tile.log_p = log_chi2_tail(tile.chi2, tile.freedom);
            excess += std::max(0.0, tile.chi2 - tile.freedom);
            out.tiles.push_back(std::move(tile));
          }
        }
      }
    }
  }
  for (ImpactTile& tile : out.tiles) {
    tile.share = excess > 0.0 ? std::max(0.0, tile.chi2 - tile.freedom) / excess : 0.0;
  }
  mark_significant(out.tiles);
  std::sort(out.tiles.begin(), out.tiles.end(),
            [](const ImpactTile& a, const ImpactTile& b) { return a.share > b.share; });
  return out;
}

std::vector<double> held_out_speeds(const Studied& studied, const ImpactRecords& records,
                                    std::size_t per_shot) {
  const ModelFit& fit = studied.fit;
  const auto size = static_cast<Eigen::Index>(per_shot);
  std::vector<double> squares;
  for (const SpeedGroup& group : records.groups) {
    const Eigen::VectorXd own = rows_of(fit.residual, group, size);
    if (fit.theta.empty() || records.groups.size() < 2) {
      squares.push_back(own.squaredNorm());
      continue;
    }
    const Eigen::MatrixXd columns = rows_of(fit.jacobian, group, size);
    const Eigen::MatrixXd others = fit.information - columns.transpose() * columns;
    const Eigen::VectorXd move = least_norm_solution(others, columns.transpose() * own);
    squares.push_back((own + columns * move).squaredNorm());
  }
  return squares;
}

}  // namespace kolsky
