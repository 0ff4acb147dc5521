#include "daemon/critic/diagnosis_message.hpp"

#include <google/protobuf/util/json_util.h>

#include <cmath>
#include <stdexcept>

#include "kolsky/v1/kolsky.pb.h"

namespace kolsky {

namespace {

void put(const Misfit& misfit, v1::Misfit& message) {
  message.set_chi2_reduced(misfit.chi2_reduced);
  message.set_repeatable_share(misfit.repeatable_share);
  message.set_noise_floor_share(misfit.noise_floor_share);
}

void put(const CandidateResult& candidate, v1::DiagnosisCandidate& message) {
  message.set_effect(candidate.effect);
  message.set_parameter(candidate.parameter);
  message.set_unit(candidate.unit);
  message.set_strength(candidate.strength);
  message.set_sd(candidate.sd);
  message.set_p_value(std::exp(candidate.own_log_p));
  message.set_log_p(candidate.log_p);
  message.set_gain(candidate.gain);
  message.set_held_out_gain(candidate.held_out_gain);
  message.set_smallest_detectable(candidate.detectable);
  message.set_smallest_identifiable(candidate.identifiable);
  message.set_nearest_rival(candidate.nearest_rival);
  message.set_verdict(name_of(candidate.verdict));
}

}  // namespace

void fill(const Diagnosis& diagnosis, v1::Diagnosis& message) {
  message.mutable_summary()->set_verdict(name_of(diagnosis.verdict));
  for (const std::string& id : diagnosis.effects) {
    message.mutable_summary()->add_effects(id);
  }
  for (const auto& [id, ties] : diagnosis.tied_with) {
    v1::TextList& list = (*message.mutable_tied_with())[id];
    for (const std::string& other : ties) {
      list.add_items(other);
    }
  }
  put(diagnosis.before, *message.mutable_misfit()->mutable_before());
  put(diagnosis.after, *message.mutable_misfit()->mutable_after());
  v1::HeldOut& held_out = *message.mutable_misfit()->mutable_held_out();
  held_out.set_before(diagnosis.held_out.before);
  held_out.set_after(diagnosis.held_out.after);
  held_out.set_floor(diagnosis.held_out.floor);
  for (const CandidateResult& candidate : diagnosis.candidates) {
    put(candidate, *message.add_candidates());
  }
  for (const NextExperiment& next : diagnosis.next_experiment) {
    v1::NextExperiment& experiment = *message.add_next_experiment();
    experiment.set_change(next.change);
    for (const std::string& id : next.separates) {
      experiment.add_separates(id);
    }
  }
  for (const std::string& note : diagnosis.notes) {
    message.add_notes(note);
  }
  message.set_unexplained_log_p(diagnosis.unexplained_log_p);
}

std::string json_of(const v1::Diagnosis& message) {
  google::protobuf::util::JsonPrintOptions options;
  options.add_whitespace = true;
  options.always_print_primitive_fields = true;
  options.preserve_proto_field_names = true;
  std::string text;
  const auto done = google::protobuf::util::MessageToJsonString(message, &text, options);
  if (!done.ok()) {
    throw std::runtime_error("the diagnosis does not become JSON: " + done.ToString());
  }
  return text;
}

}  // namespace kolsky
