#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace kolsky {

/// The line that ends a capture file, after HDF5's own end of file where its readers do not look:
/// the SHA-256 of every byte before it. It finds any flipped bit, and lets HDF5, which crashes on
/// some damaged files, see only what was written. Here for the bytes that go before it.
[[nodiscard]] std::string seal_of(std::span<const std::byte> content);

/// Checks a file's seal. @return the bytes in front of it
/// @throws InputError if it is no capture, cut short or changed
std::uint64_t check_seal(const std::filesystem::path& path);

}  // namespace kolsky
