#include "daemon/shots/summary.hpp"

#include "processing/base/error.hpp"
#include "processing/reduction/loop_summary.hpp"
#include "processing/reduction/requested.hpp"

namespace kolsky {

namespace {

const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::pass:
      return "pass";
    case Verdict::warn:
      return "warn";
    case Verdict::fail:
      break;
  }
  return "fail";
}

}  // namespace

Reduction reduce_as_filed(Reducer& reducer, const Shot& shot) {
  reducer.set_options(options_of(shot.reduction));
  return reducer.reduce(shot);
}

Reduction reduce_or_say_why(Reducer& reducer, const Shot& shot) {
  Reduction reduction;
  try {
    return reduce_as_filed(reducer, shot);
  } catch (const InputError& error) {
    reduction.quality.reason = error.what();
  } catch (const std::exception& error) {
    reduction.quality.reason =
        std::string("the reduction failed, which it should not: ") + error.what();
  }
  return reduction;
}

CatalogueEntry summarise(const Shot& shot, const Reduction& reduction, const std::string& capture) {
  CatalogueEntry entry;
  entry.id = shot.id;
  entry.utc_ns = shot.utc_ns;
  entry.capture = capture;
  entry.verdict = name_of(reduction.quality.verdict());
  entry.reducible = reduction.quality.reducible;
  entry.reason = reduction.quality.reason;
  const LoopSummary loop = summarise(reduction);
  entry.peak_stress_Pa = loop.peak_stress_Pa;
  entry.peak_strain = loop.peak_strain;
  if (reduction.ball) {
    entry.peak_force_N = reduction.ball->peak_force_N;
    entry.restitution = reduction.ball->restitution().value_or(Measured{});
  }
  return entry;
}

}  // namespace kolsky
