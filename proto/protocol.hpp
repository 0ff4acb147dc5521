#pragma once

#include <cstddef>
#include <cstdint>

// What both ends of the wire agree on beside the messages themselves.
namespace kolsky::wire {

inline constexpr std::uint32_t kSchemaVersion = 1;

// First frame of a published message.
inline constexpr const char* kStatusTopic = "status";
inline constexpr const char* kShotTopic = "shot";
inline constexpr const char* kResultTopic = "result";
inline constexpr const char* kFaultTopic = "fault";
inline constexpr const char* kComparisonTopic = "comparison";
inline constexpr const char* kDiagnosisTopic = "diagnosis";
inline constexpr const char* kPreviewTopic = "preview";

inline constexpr const char* kDefaultResultsEndpoint = "tcp://127.0.0.1:5600";
inline constexpr const char* kDefaultPreviewEndpoint = "tcp://127.0.0.1:5601";
inline constexpr const char* kDefaultControlEndpoint = "tcp://127.0.0.1:5602";

/// A request longer than this is refused; none of the real ones comes near.
inline constexpr std::size_t kMaxRequestBytes = 65536;

}  // namespace kolsky::wire
