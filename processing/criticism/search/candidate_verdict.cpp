#include "processing/criticism/search/candidate_verdict.hpp"

namespace kolsky {

std::string name_of(CandidateVerdict verdict) {
  switch (verdict) {
    case CandidateVerdict::named:
      return "named";
    case CandidateVerdict::tied:
      return "tied";
    case CandidateVerdict::rejected:
      return "rejected";
    case CandidateVerdict::unconfirmed:
      return "unconfirmed";
    case CandidateVerdict::not_needed:
      return "not needed";
    case CandidateVerdict::untestable:
      return "untestable";
  }
  return {};
}

}  // namespace kolsky
