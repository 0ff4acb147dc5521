#pragma once

#include <string>
#include <string_view>

#include "processing/base/shot.hpp"
#include "processing/reduction/reduction.hpp"
#include "proto/forward.hpp"

// Between what the program works with and what goes over the wire, exact to the bit both ways.
// `encode` replaces the whole message and reuses its memory. `decode` takes messages from anywhere:
// what cannot be what it should be throws InputError with the place in the message, as "shot:
// channels[1].scale".
namespace kolsky::wire {

/// @param capture  the file the shot is, or will be, stored in
/// `shot.bench` itself does not travel, the text it was read from does.
/// @throws InputError where a code does not fit the integers its channel's `bits` ask for
void encode(const Shot& shot, const std::string& capture, v1::Shot& message);

/// Everything but `bench`: read that from `bench_toml` (drivers/files/settings/bench_file.hpp).
[[nodiscard]] Shot decode(const v1::Shot& message);

/// Replaces all but `timings`, which are of the run and not of the reduction: those are emptied.
void encode(const Reduction& reduction, const std::string& shot_id, v1::Result& message);
[[nodiscard]] Reduction decode(const v1::Result& message);

void encode(const Quality& quality, v1::Quality& message);
/// The stated verdict must be one, but what counts is the worst of the checks, as everywhere.
[[nodiscard]] Quality decode(const v1::Quality& message);

void encode(const Gap& gap, v1::GapInfo& message);
[[nodiscard]] Gap decode(const v1::GapInfo& message);

void encode(const TriggerEvent& trigger, v1::TriggerInfo& message);
[[nodiscard]] TriggerEvent decode(const v1::TriggerInfo& message);

/// Reads bytes as the message. @param place  whose bytes, for the error
/// @throws InputError where they are not
void parse(std::string_view bytes, const std::string& place,
           google::protobuf::MessageLite& message);

/// Whether the command changes what the daemon does, and so takes the lease. `status`,
/// `list_shots`, `get_shot`, `snapshot` and `diagnosis` do not.
[[nodiscard]] bool changes_state(const v1::ControlRequest& request);

}  // namespace kolsky::wire
