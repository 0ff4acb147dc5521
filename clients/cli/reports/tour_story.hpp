#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drivers/files/models/model_step.hpp"

namespace kolsky::cli {

/// What a simulated campaign hides, as the end of a tour tells it.
struct Hidden {
  std::string id;  ///< empty: nothing
  std::string parameter;
  std::string unit;
  double strength = 0.0;
  std::string words;
  bool in_library = true;
};

/// How a diagnosis did against the truth.
enum class TourEnd {
  found,          ///< named, and that is it
  among_tied,     ///< one of those that the data cannot tell apart
  rightly_quiet,  ///< nothing hidden, nothing claimed; or in no library, and called unknown
  missed,         ///< hidden, and the model was called adequate or unknown
  wrong           ///< another effect was claimed, beside it or instead
};

struct TourVerdict {
  TourEnd end = TourEnd::missed;
  std::optional<double> strength;  ///< of the hidden effect, where it was claimed
  double sd = 0.0;
};

/// @param step  of the model's ledger, with the diagnosis
[[nodiscard]] TourVerdict judge(const Hidden& hidden, const ModelStep& step);

/// The verdict in plain words, with what to do next; to be read before the truth is told.
[[nodiscard]] std::string verdict_words(const ModelStep& step);

/// What was hidden.
[[nodiscard]] std::string truth_words(const Hidden& hidden);

/// The truth, and how the verdict compares with it.
[[nodiscard]] std::string truth_words(const Hidden& hidden, const TourVerdict& verdict);

}  // namespace kolsky::cli
