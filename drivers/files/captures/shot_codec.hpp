#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"

namespace kolsky {

/// What a stored shot must be, so that whatever is journaled can become a capture and be read back:
/// an id that can name a file, a positive rate, channels of one length, finite scales, texts
/// without NUL.
/// @throws InputError whose place is the field, as "channels[1].scale"
void check_storable(const Shot& shot);

/// Everything of a shot but its codes and the parsed bench, in the one form that journal records
/// begin with and that a capture's metadata digest is taken over. Little endian;
/// docs/capture-format.md has the fields. The parsed bench is left out because bench_toml says the
/// same.
[[nodiscard]] std::vector<std::byte> encode_metadata(const Shot& shot);

/// Appends the metadata and the codes of all channels, each in the fewest of 2 or 4 bytes that hold
/// them.
void encode_shot(const Shot& shot, std::vector<std::byte>& out);

/// The inverse; `bench` stays empty, see `attach_bench`.
/// @param place  where the bytes come from, for messages
/// @throws InputError on anything but a whole encoded shot of a known version that is storable
[[nodiscard]] Shot decode_shot(std::span<const std::byte> bytes, const std::string& place);

/// Parses the bench a stored shot carries as text. @throws InputError if the text is no bench, or
/// its gauges are not the shot's channels
void attach_bench(Shot& shot, const std::string& place);

}  // namespace kolsky
