#pragma once

#include <string>

#include "clients/cli/reports/json_value.hpp"
#include "drivers/files/models/model_step.hpp"
#include "processing/criticism/verdict/diagnosis.hpp"

namespace kolsky::cli {

/// How a fit came out, as a model's ledger keeps it.
[[nodiscard]] StepFit fit_of(const Misfit& misfit, std::size_t captures);

/// Writes a diagnosis into a step: verdict, what was added, every test of an effect that was worth
/// one, misfit, held-out misfit, seeds.
void keep(const Diagnosis& diagnosis, std::size_t captures, ModelStep& step);

/// A step as `kolsky model history --json` gives it.
[[nodiscard]] JsonValue describe(const ModelStep& step);

/// What a step kept besides its action, for people; empty where there is nothing.
[[nodiscard]] std::string ledger_text(const ModelStep& step);

}  // namespace kolsky::cli
