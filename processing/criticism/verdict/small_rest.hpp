#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "processing/criticism/fitting/study.hpp"

namespace kolsky {

/// By how much of chi2 a fit is worse without each of the effects that are claimed, but for those
/// which every bar has.
struct ClaimGains {
  /// As strong as a solid's formula makes them with the sizes filed, as far as they are known. Such
  /// formulas are first terms of what solids do.
  std::map<std::string, double> by_formula;
  std::map<std::string, double> others;
};

[[nodiscard]] ClaimGains claim_gains(Study& study, const Studied& current,
                                     const std::vector<std::string>& effects, double noise);

/// A solid's formula is seldom better than to so much of the chi2 that it explains (a seventh of
/// its strength), so that less than that beside it is no sign of another effect: solids of finite
/// elements left up to 1.4 %, and 20 campaigns with one thing hidden that the library lacks, which
/// two or three of its effects came near, 15 % and more of the least.
inline constexpr double kSmallRest = 0.02;

/// Of chi2, what is next to nothing beside claims of which one is a formula's: of what explains
/// least of all others, or of what the formulas do, and moves none of these by much; 0 without a
/// formula.
[[nodiscard]] double small_rest(const ClaimGains& gains);

/// The claim, of three or more, that explains next to nothing of what the others do; none where
/// there is no such or none of the others is a formula's.
[[nodiscard]] std::optional<std::string> dwarfed(const ClaimGains& gains);

/// What claims leave that is their own, of chi2.
struct SmallRest {
  ClaimGains gains;
  double chi2 = 0.0;
};

/// How far it may have moved a strength, of itself: as if all of it were along what that effect
/// does; 0 where nothing is left or the effect has no part in it.
[[nodiscard]] double share_moved(const std::optional<SmallRest>& rest, const std::string& effect);

/// It, for people. @param aside  what would take up a part of it; empty for none
[[nodiscard]] std::string small_rest_text(const SmallRest& rest, const std::string& aside);

/// Why nothing is named where one of three was set aside and the others are not known without it.
/// @pre it is dwarfed
[[nodiscard]] std::string dwarfed_text(ClaimGains gains, const std::string& aside);

}  // namespace kolsky
