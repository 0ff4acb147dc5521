#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>

namespace kolsky {

/// What is asked of a reduction, in the words of `kolsky reduce`, of a daemon's [reduction] and of
/// the captures that it stores. What is not asked for is as usual.
struct ReductionRequest {
  std::optional<std::string> dispersion;  ///< elementary, love, exact
  std::optional<std::string> separate;    ///< auto, never, gauges, equilibrium
  std::optional<std::string> stress;      ///< three-wave, one-wave, two-wave
  std::optional<std::string> inertia;     ///< none, axial, radial, both
  std::optional<double> friction;         ///< coefficient between specimen and bars
  std::optional<double> band_limit_Hz;
  std::optional<double> duration_s;  ///< of the histories
  bool with_true = false;            ///< true strain and stress beside the engineering ones

  friend bool operator==(const ReductionRequest&, const ReductionRequest&) = default;

  [[nodiscard]] bool asks() const { return *this != ReductionRequest{}; }

  /// This request, and the other one's word where this one is silent.
  [[nodiscard]] ReductionRequest over(const ReductionRequest& other) const;
};

/// Its keys, as settings and captures name them; `true` is the flag's.
inline constexpr std::array<std::pair<const char*, std::optional<std::string> ReductionRequest::*>,
                            4>
    kRequestWords{{{"dispersion", &ReductionRequest::dispersion},
                   {"separate", &ReductionRequest::separate},
                   {"stress", &ReductionRequest::stress},
                   {"inertia", &ReductionRequest::inertia}}};
inline constexpr std::array<std::pair<const char*, std::optional<double> ReductionRequest::*>, 3>
    kRequestNumbers{{{"friction", &ReductionRequest::friction},
                     {"band_limit_Hz", &ReductionRequest::band_limit_Hz},
                     {"duration_s", &ReductionRequest::duration_s}}};
inline constexpr const char* kRequestTrue = "true";

inline ReductionRequest ReductionRequest::over(const ReductionRequest& other) const {
  ReductionRequest both = other;
  for (const auto& [key, word] : kRequestWords) {
    if (this->*word) {
      both.*word = this->*word;
    }
  }
  for (const auto& [key, number] : kRequestNumbers) {
    if (this->*number) {
      both.*number = this->*number;
    }
  }
  both.with_true = with_true || other.with_true;
  return both;
}

}  // namespace kolsky
