#include "processing/criticism/examination.hpp"

namespace kolsky {

std::optional<Diagnosis> verdict_without_fit(const std::vector<Shot>& shots) {
  Diagnosis diagnosis;
  for (const Shot& shot : shots) {
    if (const std::string reason = bad_data(shot); !reason.empty()) {
      diagnosis.verdict = DiagnosisVerdict::bad_data;
      diagnosis.notes = {shot.id + ": " + reason};
      return diagnosis;
    }
  }
  // Of an impact the model foretells the records themselves.
  if (shots.front().bench.kind != BenchKind::impact && shots.front().bench.gauges.size() < 2) {
    diagnosis.verdict = DiagnosisVerdict::untestable;
    diagnosis.notes = {"one gauge, and each shot's source is free: record with two at least"};
    return diagnosis;
  }
  return std::nullopt;
}

}  // namespace kolsky
