#include "processing/criticism/impact/impact_certifier.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "processing/criticism/fitting/held_out.hpp"
#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/search/shot_strengths.hpp"

namespace kolsky {

namespace {

constexpr double kSpeedsDiffer = -9.2;  ///< ln of the chance of strengths so different
constexpr double kPart = 0.02;  ///< of what an effect explains: no matter where speeds differ

/// Nobody files a gauge's place so far from where it is.
constexpr double kMostMisplaced_m = 0.05;

/// How far a claim has a gauge from where it is filed, where nobody would [m]; else 0. At one gauge
/// arrivals are free and frequencies hardly run apart: what wants it there is bent to a shape that
/// something else has (the bar's bending runs by the place: a gauge that lagged by 6 % within 60 us
/// was bending and 12 cm).
double misplaced_m(const Studied& studied, const std::string& id, const Campaign& campaign) {
  const EffectUse* use = studied.model.find(id);
  const bool is_place = use != nullptr && use->effect->about().id == "gauge-position";
  const double off_m = is_place && campaign.gauges() == 1 ? use->values[0].value : 0.0;
  return std::abs(off_m) > kMostMisplaced_m ? off_m : 0.0;
}

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

}  // namespace

std::size_t ImpactCertifier::speeds() const {
  return study_.residuals().records().groups.size();
}

/// chi2 that strengths of their own at every speed would gain over the common one.
double ImpactCertifier::disagreement(const Studied& studied, const std::string& id) const {
  const ShotStrengths shots = shot_strengths(studied, id, study_.residuals().per_shot());
  double q = 0.0;
  for (const SpeedGroup& group : study_.residuals().records().groups) {
    double information = 0.0;
    double pull = 0.0;
    for (std::size_t i = 0; i < group.shots.size() && !shots.weight.empty(); ++i) {
      const std::size_t n = group.shots[i];
      information += shots.weight[n];
      pull += shots.weight[n] * (1.0 - shots.over_common[n]);
    }
    q += information > 0.0 ? pull * pull / information : 0.0;
  }
  return q;
}

double ImpactCertifier::gain_on_shots(const Studied& before, const Studied& after) const {
  const std::size_t per_shot = study_.residuals().per_shot();
  return sum(held_out_squares(before, per_shot)) - sum(held_out_squares(after, per_shot));
}

double ImpactCertifier::gain_on_speeds(const Studied& before, const Studied& after) const {
  const ImpactResiduals& residuals = study_.residuals();
  return sum(held_out_speeds(before, residuals.records(), residuals.per_shot())) -
         sum(held_out_speeds(after, residuals.records(), residuals.per_shot()));
}

double ImpactCertifier::held_out_gain(const Studied& before, const Studied& after) const {
  return speeds() > 1 ? gain_on_speeds(before, after) : gain_on_shots(before, after);
}

double ImpactCertifier::held_out_misfit(const Studied& studied) const {
  const ImpactResiduals& residuals = study_.residuals();
  return (speeds() > 1 ? sum(held_out_speeds(studied, residuals.records(), residuals.per_shot()))
                       : sum(held_out_squares(studied, residuals.per_shot()))) /
         static_cast<double>(studied.fit.residual.size());
}

bool ImpactCertifier::stands(const ImpactSearch& search, const ImpactRefit& refit,
                             const Studied& current) const {
  const double q = disagreement(refit.studied, search.candidate(refit).id());
  const auto count = static_cast<double>(speeds());
  const bool agrees = count < 2.0 || q < kPart * refit.gain ||
                      log_chi2_tail(q / search.scale(), count - 1.0) > kSpeedsDiffer;
  // A filed number that is set free may leave records as they were: others stood in for it, off
  // what is filed of them.
  const bool of_filed = search.candidate(refit).frees_prior && refit.of_filed > 0.5 * refit.gain;
  const bool foretells = gain_on_shots(current, refit.studied) > 0.0 &&
                         (count < 2.0 || gain_on_speeds(current, refit.studied) > 0.0);
  return search.with_search(refit.log_p) <= log_alpha_ && agrees && (of_filed || foretells);
}

bool ImpactCertifier::certified(const ImpactSearch& search, const ImpactRefit& refit,
                                const Studied& current) const {
  return stands(search, refit, current) &&
         misplaced_m(refit.studied, search.candidate(refit).id(), study_.campaign()) == 0.0;
}

std::optional<std::string> ImpactCertifier::unbelievable(const ImpactSearch& search,
                                                         const Studied& current) const {
  const std::vector<ImpactRefit>& refits = search.refits();
  if (refits.empty() || !stands(search, refits.front(), current)) {
    return std::nullopt;
  }
  const std::string id = search.candidate(refits.front()).id();
  const double off_m = misplaced_m(refits.front().studied, id, study_.campaign());
  return off_m == 0.0 ? std::nullopt
                      : std::optional(fmt::format(
                            "{} explains what noise does not, but would have its gauge {:+.2g} m "
                            "from where it is filed: something else is there",
                            id, off_m));
}

JudgedRefits ImpactCertifier::judged(const ImpactSearch& search, const Studied& current) const {
  JudgedRefits judged;
  for (const ImpactRefit& refit : search.refits()) {
    if (refit.evidence < search.refits().front().evidence - kStandsBefore) {
      break;
    }
    if (certified(search, refit, current)) {
      judged.certified = &refit;
      break;
    }
    judged.rejected.push_back(search.candidate(refit).id());
  }
  return judged;
}

std::vector<std::string> beside(const ImpactSearch& search, const ImpactRefit& own) {
  std::vector<std::string> ties;
  // An effect may be there in several variants.
  const auto tie = [&](const ImpactRefit& rival) {
    const std::string other = search.candidate(rival).id();
    if (other != search.candidate(own).id() && std::ranges::find(ties, other) == ties.end()) {
      ties.push_back(other);
    }
  };
  // Of strengths of each shot's own, several a shot lose by their number only to one that they can
  // stand for: a hum is a drift in a short record.
  const auto does_as_much = [&](const ImpactRefit& rival) {
    return search.candidate(own).use.per_shot && search.candidate(rival).use.per_shot &&
           rival.lowers > own.lowers - kStandsBefore * search.scale() * search.noise();
  };
  for (const ImpactRefit& rival : search.refits()) {
    if (rival.evidence > own.evidence - kStandsBefore || does_as_much(rival)) {
      tie(rival);
    }
  }
  for (const ImpactRefit& rival : search.unconfirmed()) {
    if (does_as_much(rival)) {
      tie(rival);
    }
  }
  return ties;
}

}  // namespace kolsky
