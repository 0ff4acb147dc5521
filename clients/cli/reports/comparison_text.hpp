#pragma once

#include <optional>
#include <string>

#include "clients/cli/reports/json_value.hpp"
#include "clients/terminal/terminal.hpp"
#include "processing/criticism/comparing/comparison.hpp"
#include "processing/criticism/comparing/shot_groups.hpp"

namespace kolsky::cli {

/// "12.5 to 25 kHz"
[[nodiscard]] std::string band_text(const ComparedBand& band);

/// What a misfit's numbers mean, in a sentence or two.
[[nodiscard]] std::string in_words(const Misfit& misfit, std::size_t shots);
/// That a fit's numbers are less well known than their deviations say, where it leaves more than
/// noise does; nothing where it does not.
[[nodiscard]] std::optional<std::string> doubtful_numbers_text(const Misfit& misfit,
                                                               std::size_t shots);

/// Whether a good part of what counts as noise is that shots differ, so that it is told apart.
[[nodiscard]] bool scatters(const Misfit& misfit);

/// Members `where` (significant tiles, largest share first) and `regions` (all places, shots taken
/// together) of what `kolsky compare --json` prints.
[[nodiscard]] JsonValue describe_tiles(const Comparison& comparison, const Campaign& campaign);
[[nodiscard]] JsonValue describe_regions(const Comparison& comparison, const Campaign& campaign);
/// Member `places`: all that these tiles are taken from, failing or not. Times of a window are from
/// its record's first sample; it fades in and out around them, over so long.
[[nodiscard]] JsonValue describe_places(const Comparison& comparison, const Comparer& comparer,
                                        Study& study);

/// Member `by_strength`: the misfit by the shots' peak strain or strain rate; null where these do
/// not differ.
[[nodiscard]] JsonValue describe_strengths(const ShotGroups& groups, const Campaign& campaign);
/// The same as a table; empty where there is nothing to tell.
[[nodiscard]] std::string strengths_table(const ShotGroups& groups, const Campaign& campaign);

/// Whether any place fails.
[[nodiscard]] bool fails_anywhere(const Comparison& comparison);

/// The places that fail, as a table; none where there are none.
[[nodiscard]] std::string places_table(const Comparison& comparison, const Campaign& campaign);

/// Whether chi-square is three deviations beyond what noise as in the quiet leaves of it, which no
/// single place need show.
[[nodiscard]] bool fails_together(const Misfit& misfit);
/// By how much all places together do; empty where they do not.
[[nodiscard]] std::string together_words(const Misfit& misfit);

/// What to conclude where no place fails. That is not that nothing is missing: filed numbers that
/// are strained may have taken it up, it may be spread over all places, or be one of slow noise.
[[nodiscard]] std::string nothing_fails_words(const Model& model, const Misfit& misfit);

/// Prediction over measurement at the gauge and shot that fail most (that deviate most where none
/// does), and below it the deviation with the noise's two deviations to either side.
[[nodiscard]] std::string worst_plot(const Comparison& comparison, Comparer& comparer, Study& study,
                                     const Eigen::VectorXd& white, const Terminal& terminal);

}  // namespace kolsky::cli
