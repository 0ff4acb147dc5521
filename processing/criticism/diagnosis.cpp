#include "processing/criticism/diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <set>

#include "processing/criticism/held_out.hpp"
#include "processing/criticism/next_experiment.hpp"
#include "processing/criticism/own_strengths.hpp"
#include "processing/criticism/statistics.hpp"
#include "processing/criticism/unexplained.hpp"

namespace kolsky {

namespace {

/// Beside the best, rivals this close in evidence (squares of normal deviates) are not told apart:
/// the true one stays in the set in 99.7 of 100 cases.
constexpr double kTie = 7.5;
constexpr double kDetected = 6.0;            ///< sigma
constexpr double kToldApart = 5.0;           ///< sigma beside a rival
constexpr double kAllowedRest = 0.01;        ///< of a misfit that certified effects explain
constexpr double kUnexplained = -6.9;        ///< ln of the chance that noise leaves as much
constexpr double kUnexplainedBeside = -4.6;  ///< the same beside certified effects
constexpr double kFarOff = 3.0;              ///< chi2 per degree of freedom
constexpr std::size_t kMostRefits = 14;
constexpr std::size_t kAlwaysRefits = 8;  ///< however far behind the first at first order
constexpr double kWorthRefitting = 12.0;  ///< as a square of a normal deviate
constexpr int kSimulatedRepeats = 2000;

/// A candidate refitted in full beside the model.
struct Refit {
  std::size_t candidate = 0;
  Studied studied;
  double freedom = 1.0;
  bool one_sided = false;
  double scatter = 1.0;   ///< how much more than noise the shots differ in its direction
  double gain = 0.0;      ///< of the objective, over the noise
  double evidence = 0.0;  ///< as a square of a normal deviate, the search not counted
  double log_p = 0.0;
};

Workers on_worker(std::size_t worker) {
  Workers serial;
  serial.first = worker;
  serial.run = [worker](std::size_t count,
                        const std::function<void(std::size_t, std::size_t)>& work) {
    for (std::size_t i = 0; i < count; ++i) {
      work(i, worker);
    }
  };
  return serial;
}

double log_tail(double gain, double freedom, bool one_sided) {
  const double log_p = log_chi2_tail(std::max(gain, 0.0), std::max(freedom, 1.0));
  return one_sided ? log_p - std::log(2.0) : log_p;
}

double noise_of(const Misfit& misfit, std::size_t shots) {
  return shots > 1 ? misfit.noise_scale : std::max(1.0, misfit.noise_scale);
}

/// What single shots say of an effect's strength.
struct ShotStrengths {
  std::vector<double> over_common;  ///< each shot's strength over the common one
  std::vector<double> weight;       ///< one over the variances of these

  /// The chi2 that strengths of their own would gain over strengths in proportion to `like`.
  [[nodiscard]] double departure_from(const std::vector<double>& like) const {
    double cross = 0.0;
    double square = 0.0;
    double all = 0.0;
    for (std::size_t n = 0; n < weight.size(); ++n) {
      cross += weight[n] * like[n] * over_common[n];
      square += weight[n] * like[n] * like[n];
      all += weight[n] * over_common[n] * over_common[n];
    }
    return square > 0.0 ? all - cross * cross / square : all;
  }
  [[nodiscard]] double disagreement() const {
    return departure_from(std::vector<double>(weight.size(), 1.0));
  }
  [[nodiscard]] double freedom() const {
    return weight.empty() ? 1.0 : static_cast<double>(weight.size()) - 1.0;
  }
};

/// @return nothing for strengths that are each shot's own, or fewer than three shots
ShotStrengths shot_strengths(const Studied& studied, const std::string& id, std::size_t per_shot) {
  const ModelFit& fit = studied.fit;
  std::vector<Eigen::Index> own;
  for (std::size_t i = 0; i < fit.theta.size(); ++i) {
    const FreeNumber& number = studied.composition.numbers()[i];
    const EffectUse& use = studied.composition.uses()[number.use];
    if (use.id() == id && number.shot < 0 &&
        !use.effect->about().parameters[number.parameter].auxiliary()) {
      own.push_back(static_cast<Eigen::Index>(i));
    }
  }
  const auto size = static_cast<Eigen::Index>(per_shot);
  const Eigen::Index shots = fit.residual.size() / size;
  if (own.empty() || shots < 3) {
    return {};
  }
  // What its strengths add to the residuals, clear of the other numbers, over all shots.
  Eigen::VectorXd clear = Eigen::VectorXd::Zero(fit.residual.size());
  Eigen::MatrixXd rest = fit.information;
  for (const Eigen::Index column : own) {
    const FreeNumber& number = studied.composition.numbers()[static_cast<std::size_t>(column)];
    const EffectUse& use = studied.composition.uses()[number.use];
    const double null_value = use.effect->about().parameters[number.parameter].null_value;
    const double strength = fit.theta[static_cast<std::size_t>(column)] - null_value / number.scale;
    clear += strength * fit.jacobian.col(column);
    rest.row(column).setZero();
    rest.col(column).setZero();
    rest(column, column) = 1.0;
  }
  Eigen::VectorXd share = fit.jacobian.transpose() * clear;
  for (const Eigen::Index column : own) {
    share[column] = 0.0;
  }
  clear -= fit.jacobian * rest.ldlt().solve(share);
  ShotStrengths list;
  const double noise = std::max(1.0, studied.misfit.noise_scale);
  for (Eigen::Index n = 0; n < shots; ++n) {
    const auto part = clear.segment(n * size, size);
    const double information = part.squaredNorm();
    const double pull = part.dot(fit.residual.segment(n * size, size));
    list.over_common.push_back(information > 0.0 ? 1.0 - pull / information : 1.0);
    list.weight.push_back(information / noise);
  }
  return list;
}

class Search {
 public:
  /// @param start  the model before anything was fitted
  Search(Study& study, const Studied& base, const Model& start)
      : study_(study), base_(base), start_(start) {
    candidates_ = candidates_for(base, study.campaign());
    directions_.resize(candidates_.size());
    study.executor().run(candidates_.size(), [&](std::size_t i, std::size_t worker) {
      directions_[i] = direction_of(candidates_[i], base_, study_, worker);
    });
    simulate();
  }

  [[nodiscard]] const std::vector<Candidate>& candidates() const { return candidates_; }
  [[nodiscard]] const std::vector<Direction>& directions() const { return directions_; }

  /// ln of the chance that the best of all candidates does as well on noise.
  [[nodiscard]] double with_search(double log_p) const {
    return std::min(0.0, log_p + std::log(trials_));
  }

  /// What two directions share through the model's own numbers.
  [[nodiscard]] double projected(std::size_t a, std::size_t b) const {
    return directions_[a].model_share.col(0).dot(base_.fit.covariance *
                                                 directions_[b].model_share.col(0));
  }

  [[nodiscard]] std::vector<Refit> refits() {
    const std::vector<std::size_t> chosen = worth_refitting();
    std::vector<std::optional<Refit>> done(chosen.size());
    study_.executor().run(chosen.size(), [&](std::size_t i, std::size_t worker) {
      done[i] = refit(chosen[i], worker);
    });
    std::vector<Refit> list;
    for (auto& own : done) {
      if (own && std::isfinite(own->studied.fit.objective()) &&
          !beyond_the_record(own->studied, *own) &&
          own_strengths_confirmed(own->studied, candidates_[own->candidate].id(),
                                  study_.campaign())) {
        list.push_back(std::move(*own));
      }
    }
    rate(list);
    std::sort(list.begin(), list.end(),
              [](const Refit& a, const Refit& b) { return a.evidence > b.evidence; });
    return list;
  }

 private:
  /// A relaxation much slower than the record, or quicker than a sample, is another effect's limit
  /// (a dashpot, a spring) that it only imitates.
  [[nodiscard]] bool beyond_the_record(const Studied& studied, const Refit& refit) const {
    const Candidate& candidate = candidates_[refit.candidate];
    const EffectUse* use = studied.model.find(candidate.id());
    const auto& parameters = candidate.use.effect->about().parameters;
    constexpr double kMuchSlower = 5.0;
    const double period_s = study_.residuals().judged_period_s();
    const double record_s = period_s * static_cast<double>(study_.residuals().band().judged);
    for (std::size_t p = 0; use != nullptr && p < parameters.size(); ++p) {
      const double value = use->values[p].value;
      if (parameters[p].auxiliary() && parameters[p].unit == "s" &&
          (value > kMuchSlower * record_s || value < 0.5 * study_.campaign().period_s)) {
        return true;
      }
    }
    return false;
  }

  /// How many independent tests the search amounts to, from simulated repeats of pure noise: the
  /// candidates' directions overlap.
  void simulate() {
    std::vector<std::size_t> single;
    for (std::size_t i = 0; i < directions_.size(); ++i) {
      if (directions_[i].freedom == 1.0 && directions_[i].information.rows() == 1) {
        single.push_back(i);
      }
    }
    const auto count = static_cast<Eigen::Index>(single.size());
    double others = 0.0;
    for (const Direction& direction : directions_) {
      others += direction.information.rows() > 1 && direction.freedom > 0.0 ? 1.0 : 0.0;
    }
    if (count == 0) {
      trials_ = std::max(1.0, others);
      return;
    }
    Eigen::MatrixXd columns(base_.fit.residual.size(), count);
    Eigen::MatrixXd shares(static_cast<Eigen::Index>(base_.fit.theta.size()), count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Direction& direction = directions_[single[static_cast<std::size_t>(i)]];
      const double scale = 1.0 / std::sqrt(direction.information(0, 0));
      columns.col(i) = direction.columns.col(0) * scale;
      shares.col(i) = direction.model_share.col(0) * scale;
    }
    Eigen::MatrixXd gram =
        columns.transpose() * columns - shares.transpose() * base_.fit.covariance * shares;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram);
    const Eigen::MatrixXd root =
        solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
    std::mt19937_64 random(20260101);
    std::normal_distribution<double> normal;
    std::vector<double> best;
    Eigen::VectorXd draw(count);
    for (int n = 0; n < kSimulatedRepeats; ++n) {
      for (Eigen::Index i = 0; i < count; ++i) {
        draw[i] = normal(random);
      }
      const Eigen::VectorXd z = root * draw;
      double largest = 0.0;
      for (Eigen::Index i = 0; i < count; ++i) {
        const bool one_sided = candidates_[single[static_cast<std::size_t>(i)]].one_sided;
        if (!one_sided || z[i] > 0.0) {
          // One-sided tests have half the tail: the same chance lies at a smaller square.
          const double tail = log_tail(z[i] * z[i], 1.0, one_sided);
          largest = std::max(largest, -tail);
        }
      }
      best.push_back(largest);
    }
    // Chance 5 % for the best of all: n tests have p = 1 - 0.95^(1/n) each.
    std::nth_element(best.begin(), best.begin() + kSimulatedRepeats * 95 / 100, best.end());
    const double p = std::exp(-best[static_cast<std::size_t>(kSimulatedRepeats) * 95 / 100]);
    trials_ = std::max(1.0, std::log(0.95) / std::log1p(-std::min(p, 0.5))) + others;
  }

  [[nodiscard]] double evidence_of(const Direction& direction, const Candidate& candidate) const {
    return direction.freedom > 0.0
               ? equivalent_square(log_tail(direction.gain, direction.freedom, candidate.one_sided))
               : 0.0;
  }

  /// The best variant of each effect, those near the best of all; first-order ties can separate at
  /// finite size, the more so the larger the misfit.
  [[nodiscard]] std::vector<std::size_t> worth_refitting() const {
    std::map<std::string, std::pair<double, std::size_t>> best;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      const double evidence = evidence_of(directions_[i], candidates_[i]);
      const EffectUse& use = candidates_[i].use;
      auto& own = best[use.id() + (use.per_shot ? " per shot" : "") + (use.alike ? " alike" : "")];
      if (evidence > own.first) {
        own = {evidence, i};
      }
    }
    std::vector<std::pair<double, std::size_t>> ranked;
    for (const auto& [id, own] : best) {
      if (own.first > 0.0) {
        ranked.push_back(own);
      }
    }
    std::sort(ranked.rbegin(), ranked.rend());
    std::vector<std::size_t> chosen;
    for (const auto& [evidence, i] : ranked) {
      const double margin = std::max(25.0, 0.6 * ranked.front().first);
      // Far from the records, first order says little of what fits best.
      const bool far = base_.misfit.chi2_reduced > kFarOff;
      const bool near = evidence > ranked.front().first - margin ||
                        ((far || chosen.size() < kAlwaysRefits) && evidence > kWorthRefitting);
      if (chosen.size() < kMostRefits && near) {
        chosen.push_back(i);
      }
    }
    return chosen;
  }

  /// Where first order says the strengths and the model's numbers are, or as far on the way as
  /// makes things better.
  [[nodiscard]] std::vector<double> begin_near(const Candidate& candidate,
                                               const Direction& direction,
                                               const Composition& composition,
                                               std::size_t worker) const {
    std::vector<std::size_t> strengths;
    for (std::size_t i = 0; i < composition.numbers().size(); ++i) {
      const FreeNumber& number = composition.numbers()[i];
      const EffectUse& use = composition.uses()[number.use];
      if (use.id() == candidate.id() &&
          !use.effect->about().parameters[number.parameter].auxiliary()) {
        strengths.push_back(i);
      }
    }
    std::vector<double> best = carry(base_.composition, base_.fit.theta, composition);
    if (candidate.frees_prior ||
        static_cast<Eigen::Index>(strengths.size()) != direction.step.size()) {
      return best;
    }
    const std::vector<double> null = best;
    const Eigen::VectorXd along = -base_.fit.covariance * direction.model_share * direction.step;
    double least = study_.residuals().evaluate(composition, best, worker).squaredNorm();
    for (const double share : {1.0, 0.3, 0.1}) {
      std::vector<double> moved = base_.fit.theta;
      for (std::size_t i = 0; i < moved.size(); ++i) {
        const FreeNumber& number = base_.composition.numbers()[i];
        moved[i] = std::clamp(moved[i] + share * along[static_cast<Eigen::Index>(i)],
                              number.lower / number.scale, number.upper / number.scale);
      }
      std::vector<double> start = carry(base_.composition, moved, composition);
      for (std::size_t i = 0; i < strengths.size(); ++i) {
        const FreeNumber& number = composition.numbers()[strengths[i]];
        start[strengths[i]] =
            std::clamp(null[strengths[i]] + share * direction.step[static_cast<Eigen::Index>(i)],
                       number.lower / number.scale, number.upper / number.scale);
      }
      const double chi2 = study_.residuals().evaluate(composition, start, worker).squaredNorm();
      if (chi2 < least) {
        least = chi2;
        best = std::move(start);
      }
    }
    return best;
  }

  std::optional<Refit> refit(std::size_t index, std::size_t worker) {
    const Candidate& candidate = candidates_[index];
    const Direction& direction = directions_[index];
    const Model model = with(base_.model, candidate, true);
    Composition composition(model, study_.campaign());
    ModelFit fit = fit_model(composition, study_.residuals(), on_worker(worker),
                             begin_near(candidate, direction, composition, worker));
    if (base_.misfit.chi2_reduced > kFarOff) {
      // The model's own numbers may have gone far astray for want of this effect: begin again from
      // where they started.
      Model fresh = with(start_, candidate, true);
      start_moduli(fresh, study_.campaign(), study_.residuals(), worker);
      const Composition again(fresh, study_.campaign());
      ModelFit other = fit_model(composition, study_.residuals(), on_worker(worker),
                                 carry(again, again.start(), composition));
      if (other.objective() < fit.objective()) {
        fit = std::move(other);
      }
    }
    const Misfit misfit =
        misfit_of(study_.residuals(), fit.residual, fit.degrees_of_freedom(composition), worker);
    Refit out{index,
              {fitted(model, composition, fit), std::move(composition), std::move(fit), misfit}};
    const double freedom = base_.fit.degrees_of_freedom(base_.composition) -
                           out.studied.fit.degrees_of_freedom(out.studied.composition);
    out.freedom = candidate.frees_prior ? 1.0 : std::round(freedom);
    out.one_sided = candidate.one_sided && freedom < 1.5;
    out.scatter = scatter_of(out.studied, candidate.id());
    return out;
  }

  /// Rates rivals by one measure of the noise, that of the best: what they leave of each other's
  /// misfit must not count as noise.
  void rate(std::vector<Refit>& list) const {
    const auto best =
        std::min_element(list.begin(), list.end(), [](const Refit& a, const Refit& b) {
          return a.studied.fit.objective() < b.studied.fit.objective();
        });
    if (best == list.end()) {
      return;
    }
    const double noise = noise_of(best->studied.misfit, study_.campaign().shots.size());
    for (Refit& refit : list) {
      refit.gain = (base_.fit.objective() - refit.studied.fit.objective()) / noise / refit.scatter;
      refit.evidence = equivalent_square(log_tail(refit.gain, refit.freedom, refit.one_sided));
      refit.log_p = chance_of(refit);
    }
  }

  /// How much more than noise the shots differ in the direction of an effect's strength: noise
  /// whose frequencies hang together scatters more there than its spectrum says.
  [[nodiscard]] double scatter_of(const Studied& studied, const std::string& id) const {
    const Effect* effect = studied.model.find(id)->effect;
    const bool slow = effect->about().stage == Stage::record;
    const double belief = belief_in(*effect);
    const ShotStrengths shots = shot_strengths(studied, id, study_.residuals().per_shot());
    const double q = shots.disagreement();
    constexpr double kOrdinary = -4.6;
    if (!slow && log_chi2_tail(q, shots.freedom()) > kOrdinary) {
      return 1.0;  // chance alone must not rank rivals
    }
    return std::max(1.0, (belief + q) / (belief + shots.freedom()));
  }

  /// ln of the chance of a refit's gain on noise, whose power in its direction the shots tell no
  /// better than so many degrees of freedom do.
  [[nodiscard]] double chance_of(const Refit& refit) const {
    const EffectUse& use = candidates_[refit.candidate].use;
    const std::size_t shots = study_.campaign().shots.size();
    if (use.per_shot || shots < 3 || refit.gain <= 0.0) {
      return log_tail(refit.gain, refit.freedom, refit.one_sided);
    }
    const double freedom = std::max(refit.freedom, 1.0);
    const double known = belief_in(*use.effect) + static_cast<double>(shots - 1);
    const double log_p = log_f_tail(refit.gain / freedom, freedom, known);
    return refit.one_sided ? log_p - std::log(2.0) : log_p;
  }

  /// What is known of the noise beforehand counts as much as this many shots; of slow noise, among
  /// which additions to a record are sought, little is known.
  static double belief_in(const Effect& effect) {
    return effect.about().stage == Stage::record ? 3.0 : 20.0;
  }

  Study& study_;
  const Studied& base_;
  const Model& start_;
  std::vector<Candidate> candidates_;
  std::vector<Direction> directions_;
  double trials_ = 1.0;
};

/// An effect with the right shape but the wrong name has strengths that differ from shot to shot by
/// more than noise, and by more than a small part of what it explains. Of what is added to the
/// records, slow noise makes strengths differ anyway: there it tells that they follow the shots'
/// amplitudes.
bool shots_agree(const Studied& studied, double gain, const std::string& id,
                 const Campaign& campaign, std::size_t per_shot) {
  constexpr double kChance = -9.2;
  constexpr double kPart = 0.02;
  const ShotStrengths shots = shot_strengths(studied, id, per_shot);
  const double q = shots.disagreement();
  if (log_chi2_tail(q, shots.freedom()) > kChance || q < kPart * gain) {
    return true;
  }
  std::vector<double> peaks;
  for (const CampaignShot& shot : campaign.shots) {
    peaks.push_back(shot.facts.peak_strain);
  }
  const double departure = shots.departure_from(peaks);
  constexpr double kSquare = 9.0;
  return studied.model.find(id)->effect->about().per_shot &&
         q - departure < kSquare * departure / shots.freedom();
}

HeldOut held_out(const Studied& before, const Studied& after, Study& study) {
  const std::size_t per_shot = study.residuals().per_shot();
  const auto mean = [&](const Studied& studied) {
    const std::vector<double> squares = held_out_squares(studied, per_shot);
    return std::accumulate(squares.begin(), squares.end(), 0.0) /
           static_cast<double>(squares.size() * per_shot);
  };
  return {mean(before), mean(after),
          study.campaign().shots.size() > 1 ? after.misfit.noise_scale : 1.0};
}

/// Gain of chi2 on shots the fits did not see, and in how many of them.
std::pair<double, std::size_t> certification(const Studied& before, const Studied& after,
                                             std::size_t per_shot) {
  const auto a = held_out_squares(before, per_shot);
  const auto b = held_out_squares(after, per_shot);
  double gain = 0.0;
  std::size_t better = 0;
  for (std::size_t n = 0; n < a.size(); ++n) {
    gain += a[n] - b[n];
    better += a[n] > b[n] ? 1 : 0;
  }
  return {gain, better};
}

/// Strength and deviation of an effect in a fitted model.
void set_strength(const Studied& studied, const std::string& id, CandidateResult& result) {
  const EffectUse* use = studied.model.find(id);
  if (use == nullptr || use->values.empty()) {
    return;
  }
  const auto& parameters = use->effect->about().parameters;
  const std::size_t at = use->effect->about().strength;
  result.parameter = parameters[at].name;
  result.unit = parameters[at].unit;
  result.strength = use->values[at].value;
  result.sd = use->values[at].sd;
  if (use->effect->about().quadrature) {
    result.parameter = "A";
    result.strength = std::hypot(use->values[0].value, use->values[1].value);
  }
}

}  // namespace

std::string name_of(DiagnosisVerdict verdict) {
  switch (verdict) {
    case DiagnosisVerdict::named:
      return "named";
    case DiagnosisVerdict::tied:
      return "tied";
    case DiagnosisVerdict::unknown:
      return "unknown";
    case DiagnosisVerdict::adequate:
      return "adequate";
    case DiagnosisVerdict::untestable:
      return "untestable";
    case DiagnosisVerdict::bad_data:
      return "bad-data";
  }
  return {};
}

namespace {

class Diagnostician {
 public:
  Diagnostician(Study& study, const DiagnosisOptions& options) : study_(study), options_(options) {}

  Diagnosis run(const Model& model) {
    options_.progress("fitting the model");
    start_ = model;
    Studied first = study_.fit(model);
    diagnosis_.before = first.misfit;
    Studied current = first;
    while (diagnosis_.effects.size() < options_.most_effects && add_one(current)) {
    }
    if (diagnosis_.effects.size() > 1) {
      drop_unneeded(current);
    }
    conclude(first, current);
    return std::move(diagnosis_);
  }

 private:
  bool add_one(Studied& current) {
    options_.progress(diagnosis_.effects.empty()
                          ? "testing every effect of the library"
                          : "testing what remains after " + diagnosis_.effects.back());
    Search search(study_, current, start_);
    if (diagnosis_.candidates.empty()) {
      list_candidates(search);
    }
    const std::vector<Refit> refits = search.refits();
    if (diagnosis_.effects.empty()) {
      note_refits(search, refits, current);
    }
    if (refits.empty() || search.with_search(refits.front().log_p) > options_.log_alpha) {
      return false;
    }
    const std::size_t per_shot = study_.residuals().per_shot();
    for (const Refit& refit : refits) {
      if (refit.evidence < refits.front().evidence - kTie) {
        break;
      }
      const std::string id = search.candidates()[refit.candidate].id();
      const auto [gain, better] = certification(current, refit.studied, per_shot);
      const std::size_t shots = study_.campaign().shots.size();
      const bool agrees = shots_agree(refit.studied, refit.gain, id, study_.campaign(), per_shot);
      if (gain <= 0.0 || 2 * better <= shots || !agrees ||
          search.with_search(refit.log_p) > options_.log_alpha) {
        set_verdict(id, "rejected");
        continue;
      }
      std::vector<std::string> ties;
      for (const Refit& rival : refits) {
        const std::string other = search.candidates()[rival.candidate].id();
        if (other != id && rival.evidence > refit.evidence - kTie) {
          ties.push_back(other);
        }
      }
      // The noise shows better now.
      study_.residuals().freeze(refit.studied.composition, refit.studied.fit.theta);
      Studied next = study_.refit(refit.studied);
      study_.residuals().calibrate(next.fit.residual);
      next = study_.refit(next);
      diagnosis_.effects.push_back(id);
      start_ = with(start_, search.candidates()[refit.candidate], true);
      diagnosis_.tied_with[id] = ties;
      current = std::move(next);
      return true;
    }
    return false;
  }

  /// Backward: what later effects have made superfluous goes.
  void drop_unneeded(Studied& current) {
    for (std::size_t i = 0; i + 1 < diagnosis_.effects.size();) {
      const std::string id = diagnosis_.effects[i];
      Model without = current.model;
      std::erase_if(without.effects, [&](const EffectUse& use) { return use.id() == id; });
      const Composition composition(without, study_.campaign());
      ModelFit fit = fit_model(composition, study_.residuals(), study_.executor(),
                               carry(current.composition, current.fit.theta, composition));
      const double noise = noise_of(current.misfit, study_.campaign().shots.size());
      const double loss = (fit.objective() - current.fit.objective()) / noise;
      if (equivalent_square(log_tail(loss, 1.0, false)) < 16.0 ||
          !own_strengths_confirmed(current, id, study_.campaign())) {
        const Misfit misfit =
            misfit_of(study_.residuals(), fit.residual, fit.degrees_of_freedom(composition));
        Model after = fitted(without, composition, fit);
        current = {std::move(after), composition, std::move(fit), misfit};
        diagnosis_.tied_with.erase(id);
        diagnosis_.effects.erase(diagnosis_.effects.begin() + static_cast<std::ptrdiff_t>(i));
        set_verdict(id, "not needed");
      } else {
        ++i;
      }
    }
  }

  void conclude(const Studied& first, const Studied& current) {
    options_.progress("looking for what nothing explains");
    const Unexplained left = unexplained(study_, current);
    diagnosis_.unexplained_log_p = left.log_p;
    diagnosis_.after = current.misfit;
    // Both by the same measure of the noise.
    const Studied before = diagnosis_.effects.empty() ? first : study_.refit(first);
    diagnosis_.before = before.misfit;
    diagnosis_.held_out = held_out(before, current, study_);
    diagnosis_.model = current.model;
    const double noise = noise_of(current.misfit, study_.campaign().shots.size());
    const double explained = (before.fit.objective() - current.fit.objective()) / noise;
    // That something is there is certain once an effect is certified.
    const double threshold = diagnosis_.effects.empty() ? kUnexplained : kUnexplainedBeside;
    const bool rest = diagnosis_.unexplained_log_p < threshold &&
                      left.excess > kAllowedRest * std::max(0.0, explained);
    const bool tied = std::any_of(diagnosis_.tied_with.begin(), diagnosis_.tied_with.end(),
                                  [](const auto& own) { return !own.second.empty(); });
    if (rest) {
      diagnosis_.verdict = DiagnosisVerdict::unknown;
      for (const std::string& id : diagnosis_.effects) {
        set_verdict(id, "rejected");
      }
      if (!diagnosis_.effects.empty()) {
        diagnosis_.notes.push_back("nearest, but not enough: " + diagnosis_.effects.front());
      }
      diagnosis_.effects.clear();
      diagnosis_.tied_with.clear();
    } else if (diagnosis_.effects.empty()) {
      diagnosis_.verdict = DiagnosisVerdict::adequate;
    } else {
      diagnosis_.verdict = tied ? DiagnosisVerdict::tied : DiagnosisVerdict::named;
    }
    for (const std::string& id : diagnosis_.effects) {
      set_verdict(id, diagnosis_.tied_with[id].empty() ? "named" : "tied");
      for (CandidateResult& result : diagnosis_.candidates) {
        if (result.effect == id) {
          set_strength(current, id, result);
        }
      }
    }
    for (const auto& [id, ties] : diagnosis_.tied_with) {
      for (const std::string& other : ties) {
        set_verdict(other, "tied");
      }
      if (!ties.empty()) {
        diagnosis_.next_experiment.push_back(next_experiment(id, ties, study_.campaign().bench));
      }
    }
    if (study_.campaign().shots.size() < 2) {
      diagnosis_.notes.emplace_back(
          "one shot: nothing was held out over shots; repeat the shot to certify");
    }
  }

  void set_verdict(const std::string& id, const std::string& verdict) {
    for (CandidateResult& result : diagnosis_.candidates) {
      if (result.effect == id) {
        result.verdict = verdict;
      }
    }
  }

  /// First-order strengths and limits of every effect beside the first model.
  void list_candidates(const Search& search) {
    std::map<std::string, std::size_t> at;
    for (std::size_t i = 0; i < search.candidates().size(); ++i) {
      const Candidate& candidate = search.candidates()[i];
      const Direction& direction = search.directions()[i];
      const auto known = at.find(candidate.id());
      if (known != at.end() && diagnosis_.candidates[known->second].gain >= direction.gain) {
        continue;
      }
      CandidateResult result;
      result.effect = candidate.id();
      const EffectParameter& parameter = candidate.use.effect->about().parameters.front();
      result.parameter = parameter.name;
      result.unit = parameter.unit;
      result.gain = direction.gain;
      result.log_p =
          search.with_search(log_tail(direction.gain, direction.freedom, candidate.one_sided));
      if (direction.freedom > 0.0 && direction.information.rows() > 0) {
        const double scale = candidate.frees_prior && candidate.use.values[0].prior_sd > 0.0
                                 ? candidate.use.values[0].prior_sd
                                 : parameter.typical;
        result.strength = parameter.null_value + direction.step[0] * scale;
        result.sd = scale / std::sqrt(direction.information(0, 0));
        result.detectable = kDetected * result.sd;
        set_identifiable(search, i, result);
        result.verdict = "not needed";
      } else {
        result.detectable = result.identifiable = INFINITY;
        result.verdict = "untestable";
      }
      if (known != at.end()) {
        diagnosis_.candidates[known->second] = result;
      } else {
        at[candidate.id()] = diagnosis_.candidates.size();
        diagnosis_.candidates.push_back(std::move(result));
      }
    }
  }

  /// The strength that stands at 5 sigma beside whichever other effect resembles it most.
  static void set_identifiable(const Search& search, std::size_t i, CandidateResult& result) {
    const Direction& own = search.directions()[i];
    result.identifiable = result.detectable;
    if (own.information.rows() != 1) {
      return;
    }
    double closest = 0.0;
    for (std::size_t k = 0; k < search.directions().size(); ++k) {
      const Direction& other = search.directions()[k];
      if (search.candidates()[k].id() == search.candidates()[i].id() ||
          other.information.rows() != 1 || other.freedom != 1.0) {
        continue;
      }
      const double cross = (own.columns.col(0).dot(other.columns.col(0)) - search.projected(i, k)) /
                           std::sqrt(own.information(0, 0) * other.information(0, 0));
      if (cross * cross > closest) {
        closest = std::min(1.0, cross * cross);
        result.nearest_rival = search.candidates()[k].id();
      }
    }
    result.identifiable = std::max(
        result.detectable, kToldApart * result.sd / std::sqrt(std::max(1e-12, 1.0 - closest)));
  }

  void note_refits(const Search& search, const std::vector<Refit>& refits, const Studied& current) {
    const std::size_t per_shot = study_.residuals().per_shot();
    for (const Refit& refit : refits) {
      for (CandidateResult& result : diagnosis_.candidates) {
        if (result.effect == search.candidates()[refit.candidate].id()) {
          result.gain = refit.gain;
          result.log_p = search.with_search(refit.log_p);
          result.held_out_gain = certification(current, refit.studied, per_shot).first;
          set_strength(refit.studied, result.effect, result);
        }
      }
    }
  }

  Study& study_;
  const DiagnosisOptions& options_;
  Model start_;  ///< unfitted, with the effects found so far
  Diagnosis diagnosis_;
};

}  // namespace

Diagnosis diagnose(Study& study, const Model& model, const DiagnosisOptions& options) {
  return Diagnostician(study, options).run(model);
}

}  // namespace kolsky
