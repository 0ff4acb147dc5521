#include "processing/criticism/impact/impact_table.hpp"

#include <algorithm>

namespace kolsky {

std::vector<CandidateResult> table_of_impacts(const ImpactSearch& search,
                                              const ImpactCertifier& certifier) {
  std::vector<CandidateResult> table =
      first_order_table({search.candidates(), search.directions(), search.base(),
                         search.log_trials(), search.scale()});
  set_limits(search.flat(), search.scale(), table);
  std::vector<std::string> all;
  for (const ImpactRefit& refit : search.refits()) {
    all.push_back(search.candidate(refit).id());
  }
  note_refits(search, all, certifier, table);
  return table;
}

void note_refits(const ImpactSearch& search, const std::vector<std::string>& ids,
                 const ImpactCertifier& certifier, std::vector<CandidateResult>& table) {
  for (CandidateResult& result : table) {
    const auto best = std::ranges::find_if(search.refits(), [&](const ImpactRefit& refit) {
      return search.candidate(refit).id() == result.effect;
    });
    if (best == search.refits().end() || std::ranges::find(ids, result.effect) == ids.end()) {
      continue;
    }
    result.gain = best->gain;
    result.log_p = search.with_search(best->log_p);
    result.own_log_p = best->log_p;
    result.held_out_gain = certifier.held_out_gain(search.base(), best->studied);
    result.refitted = true;
    set_strength(best->studied, result.effect, result);
  }
}

}  // namespace kolsky
