#pragma once

#include <array>
#include <cstdint>

/// Names and numbers that writing and reading a capture share; docs/capture-format.md describes
/// them.
namespace kolsky::capture_layout {

inline constexpr std::int32_t kFormat = 1;
inline constexpr const char* kEntry = "entry";
inline constexpr const char* kGauges = "gauges";
inline constexpr const char* kTime = "time";
inline constexpr const char* kRaw = "raw";
inline constexpr const char* kChannels =
    "channels";  ///< the raw datasets in the order of the bench
inline constexpr const char* kShot = "shot";
inline constexpr const char* kBarModel = "bar_model_toml";
inline constexpr const char* kReduction = "reduction";
inline constexpr const char* kMetaKey = "key";  ///< of a fact whose key cannot name an HDF5 object
inline constexpr std::size_t kGapColumns = 3;
inline constexpr std::array<const char*, 3> kTriggerKinds{"incident", "forced", "marked"};

}  // namespace kolsky::capture_layout
