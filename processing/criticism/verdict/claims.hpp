#pragma once

#include <functional>
#include <string>
#include <vector>

#include "processing/criticism/verdict/diagnosis.hpp"

namespace kolsky {

/// Of a candidate; nothing where it is not among them.
void set_verdict(Diagnosis& diagnosis, const std::string& id, CandidateVerdict verdict);

/// Takes a claim back.
void drop_claim(Diagnosis& diagnosis, const std::string& id, CandidateVerdict verdict);
/// All of them, as rejected. @return what was claimed
std::vector<std::string> drop_claims(Diagnosis& diagnosis);

/// Nothing is named, and the model stays as it was: misfits and held-out misfit after are those
/// before. @param reasons  in sentences; what came nearest is added to them
/// @param floor  of the held-out misfit, by the noise as that model has it
void give_up(Diagnosis& diagnosis, const std::vector<std::string>& reasons, const Model& before,
             double floor);

/// The verdict that the claims make (adequate without any), and the candidates' by it. What is
/// claimed itself is no rival of what is claimed beside it.
/// @param found         the model with them
/// @param set_strength  of what is claimed
void settle_claims(Diagnosis& diagnosis, const Model& found,
                   const std::function<void(CandidateResult&)>& set_strength);

}  // namespace kolsky
