#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "processing/criticism/verdict/diagnosis.hpp"
#include "processing/criticism/verdict/loud_pulses.hpp"
#include "processing/criticism/verdict/unexplained.hpp"

namespace kolsky {

/// Anything can be expanded in three effects: that one is missing which the library does not have
/// is likelier than that three are at once.
inline constexpr std::size_t kMostBelieved = 2;
/// Those which not every bar has: it ends, and sends waves back from there, and has a thickness.
[[nodiscard]] std::vector<std::string> beside_the_bar(const std::vector<std::string>& effects);
/// Those of these which count: what a solid does as its formula has it of the sizes filed is no
/// surprise.
/// @param fitted  with all of them
[[nodiscard]] std::vector<std::string> surprises(const std::vector<std::string>& effects,
                                                 const Model& fitted);

/// Whether an effect is so strong that nothing is built so: then noise was fitted with it.
/// @param slack  while effects beside it are still missing, it stands for a part of these, too
[[nodiscard]] bool beyond_belief(const Studied& studied, const std::string& id,
                                 const Campaign& campaign, double slack);

/// Whether a claim is of what happens to waves on their way, on a bar with two gauges: a linear
/// fault of one channel, which the library lacks, would do the same to what one has over the other.
[[nodiscard]] bool blames_bar_of_two_gauges(const Diagnosis& diagnosis, const Campaign& campaign);
[[nodiscard]] std::string two_gauges_text();

/// Whether claims have waves reach several gauges of one bar at other times than foretold: a speed
/// that changes along the bar, which the library lacks, does so with one cause.
[[nodiscard]] bool blames_times_of_several_gauges(const Diagnosis& diagnosis,
                                                  const Campaign& campaign);
[[nodiscard]] std::string several_times_text();

/// Whether a claim is of a loss that is the same for all frequencies, which a section that changes
/// along the bar, and supports that rub, make of waves, too.
[[nodiscard]] bool blames_even_loss(const Diagnosis& diagnosis);
[[nodiscard]] std::string even_loss_text();

/// What gauges that are loud show, in a sentence. @param loud  the least likely first
[[nodiscard]] std::string loud_text(const std::vector<LoudPulses>& loud, const Campaign& campaign);
/// @param what    leaves it
/// @param misfit  that is left, in units of the noise before the pulse
[[nodiscard]] std::string left_of_one_shot_text(const std::string& what, double misfit);
/// At which gauge most is; nothing where it is not one gauge's.
[[nodiscard]] std::optional<std::string> where_text(const std::vector<LoudPulses>& loud,
                                                    const Campaign& campaign);

/// Why what was claimed is not what is missing, in sentences; empty: it may be.
/// @param current  fitted with what was claimed
/// @param remains  misfit that nothing explains, where there is any
/// @param explained  of chi2, by what was claimed
/// @param log_alpha  ln of the chance at which something is there
[[nodiscard]] std::vector<std::string> why_unknown(const Diagnosis& diagnosis,
                                                   const Studied& current, const Campaign& campaign,
                                                   const std::optional<Unexplained>& remains,
                                                   double explained, double log_alpha);

}  // namespace kolsky
