#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/criticism/verdict/findings.hpp"

namespace kolsky {

/// The other half of the gauges, with the same kind of error the other way. What all gauges read
/// too much or too late alike is the source's, so that an error of half of them fits as one of the
/// others.
struct Complement {
  std::vector<std::string> claimed;  ///< of one kind, two at least
  std::vector<std::string> others;   ///< at the gauges that these are not at
  Studied studied;                   ///< with the others in their place
  double lead = 0.0;  ///< of these over the claimed, in chi2 over the noise; below 0: behind

  /// Whether the records cannot tell them from what is claimed.
  [[nodiscard]] bool tied() const;
  /// Whether they are what should have been claimed.
  [[nodiscard]] bool ahead() const;
};

/// Of factors or delays that are claimed at half of the gauges; nothing where there are none, or
/// where the model has others of their kind.
[[nodiscard]] std::optional<Complement> complement_of(Study& study, const Findings& found);

/// They take the place of what was claimed.
void take_place(Study& study, const DiagnosisOptions& options, Complement complement,
                Findings& found);

/// Where they are tied with what is claimed each of it is tied with all of them.
void tie_with_complement(Study& study, Findings& found);

}  // namespace kolsky
