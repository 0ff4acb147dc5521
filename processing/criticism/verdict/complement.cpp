#include "processing/criticism/verdict/complement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "processing/criticism/verdict/choice.hpp"
#include "processing/criticism/verdict/claims.hpp"
#include "processing/criticism/verdict/going_back.hpp"
#include "processing/criticism/verdict/refits.hpp"

namespace kolsky {

namespace {

/// Common to all gauges, these are amplitude and time of the source.
constexpr std::array kOfTheSource{"gauge-factor", "channel-delay"};

/// Splits what is at the gauges of one kind of error by whether it is claimed.
/// @return nothing where that are not two halves, of two gauges at least
std::optional<Complement> halves(const std::string& kind, const Campaign& campaign,
                                 const Findings& found) {
  std::vector<std::string> claimed;
  std::vector<std::string> others;
  for (const Gauge& gauge : campaign.bench.gauges) {
    const std::string id = kind + ":" + gauge.name;
    if (std::ranges::count(found.diagnosis.effects, id) > 0) {
      claimed.push_back(id);
    } else if (found.current.model.find(id) == nullptr) {
      others.push_back(id);
    }
  }
  if (claimed.size() < 2 || claimed.size() != others.size() ||
      claimed.size() + others.size() != campaign.bench.gauges.size()) {
    return std::nullopt;
  }
  return Complement{std::move(claimed), std::move(others), found.current};
}

Model exchanged(Model model, const Complement& complement) {
  std::erase_if(model.effects, [&](const EffectUse& use) {
    return std::ranges::count(complement.claimed, use.id()) > 0;
  });
  for (const std::string& id : complement.others) {
    model.effects.push_back(use_named(id));
  }
  return model;
}

}  // namespace

bool Complement::tied() const {
  return std::abs(lead) < kTie;
}

bool Complement::ahead() const {
  return lead >= kTie;
}

std::optional<Complement> complement_of(Study& study, const Findings& found) {
  for (const char* kind : kOfTheSource) {
    std::optional<Complement> complement = halves(kind, study.campaign(), found);
    if (complement) {
      const Studied& current = found.current;
      complement->studied = changed(study, current, exchanged(current.model, *complement));
      complement->lead = (current.fit.objective() - complement->studied.fit.objective()) /
                         noise_of(current.misfit, study.campaign().shots.size());
      return complement;
    }
  }
  return std::nullopt;
}

void take_place(Study& study, const DiagnosisOptions& options, Complement complement,
                Findings& found) {
  for (const std::string& id : complement.claimed) {
    drop_claim(found.diagnosis, id, CandidateVerdict::not_needed);
  }
  found.start = exchanged(found.start, complement);
  found.diagnosis.effects.insert(found.diagnosis.effects.end(), complement.others.begin(),
                                 complement.others.end());
  Choice choice{
      .id = complement.others.front(), .studied = std::move(complement.studied), .ties = {}};
  go_on_with(study, options, choice, found);
}

void tie_with_complement(Study& study, Findings& found) {
  const std::optional<Complement> complement = complement_of(study, found);
  if (!complement || !complement->tied()) {
    return;
  }
  for (const std::string& id : complement->claimed) {
    for (const std::string& other : complement->others) {
      std::vector<std::string>& ties = found.diagnosis.tied_with[id];
      if (std::ranges::count(ties, other) == 0) {
        ties.push_back(other);
      }
    }
  }
}

}  // namespace kolsky
