#include "processing/criticism/verdict/examination.hpp"

#include <algorithm>

namespace kolsky {

namespace {

/// In one shot at least; the first does in all.
std::size_t gauges_with_a_pulse(const std::vector<Shot>& shots) {
  std::size_t count = 0;
  for (std::size_t j = 0; j < shots.front().bench.gauges.size(); ++j) {
    count += std::ranges::any_of(shots, [&](const Shot& shot) { return holds_pulse(shot, j); });
  }
  return count;
}

}  // namespace

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
  if (shots.front().bench.kind != BenchKind::impact && gauges_with_a_pulse(shots) < 2) {
    diagnosis.verdict = DiagnosisVerdict::untestable;
    diagnosis.notes = {
        "no gauge but the first holds a pulse that stands out of its noise: record for longer, or "
        "nearer to the specimen"};
    return diagnosis;
  }
  return std::nullopt;
}

}  // namespace kolsky
