#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/base/workers.hpp"
#include "processing/identification/bar_fit.hpp"
#include "processing/identification/bar_spectrum.hpp"

namespace kolsky {

struct BarIdentificationOptions {
  std::optional<WaveTheory> theory{};  ///< none: the one the records are evidence for
  std::optional<SolidKind> solid =
      SolidKind::three_element;           ///< none: the one the records are evidence for
  std::optional<FarEndReturn> far_end{};  ///< none: the one the records are evidence for
  bool compare_solids = true;             ///< fit the other families too, for the table
  double band_limit_Hz = 0.0;             ///< 0: where the pulses fall below the noise
};

/// One way to explain the records.
struct Alternative {
  BarTheory theory;
  double log_evidence = 0.0;
  double chi2_reduced = 0.0;
  bool left_behind = false;  ///< so far that its search was left: more or less so much
  std::string failed;        ///< why there is no fit; empty where there is one
};

/// What the records say of the choice between explanations that differ in one respect.
struct ChoiceByEvidence {
  bool told_apart = false;  ///< the best is ahead by a log evidence of 5
  double ahead = 0.0;       ///< by how much; 0 where there was nothing to choose
  bool asked = false;       ///< the caller chose
};

struct BarIdentification {
  BarFit fit;            ///< of the solid that was asked for, or that the evidence chose
  BarFit three_element;  ///< under the same wave theory and far end
  /// Of the solid that the evidence chose, whichever was asked for, where it is clearly ahead: by
  /// this one the spectrum goes, which a solid that does not fit would lead astray.
  BarFit likeliest;
  ChoiceByEvidence wave_theory, far_end, solid;
  bool two_passes =
      false;  ///< one gauge stood for two (see split_passes); the far end counts as free
  std::vector<Alternative> alternatives;  ///< all that were compared, best first
  std::vector<FittedNumber> over_shots;   ///< three-element: mean of the shots' own, sd over them
  BarSpectrum spectrum;
  BarSpectrum straight_lines;       ///< the paper's analysis, where it applies
  std::vector<FittedNumber> paper;  ///< three-element solid through it up to 15 kHz
  std::vector<std::string> shot_ids;
  std::optional<double> temperature_K;  ///< mean of the shots', where all are known
  std::vector<std::string> warnings;
};

/// Whether there is a loss, and not only what noise makes of one (kWidestLogOfALoss of E2).
[[nodiscard]] bool loss_shows(const BarFit& three_element);

/// The whole identification of a bar from its shots: which waves travel in it, what comes back from
/// its far end, what it is made of. Where theories cannot be told apart, the deviations of the
/// three-element parameters take in how far these lie from each other, by their odds.
/// @throws InputError as BarData, and where no explanation can be fitted
[[nodiscard]] BarIdentification identify_bar(const std::vector<Shot>& shots,
                                             const BarIdentificationOptions& options,
                                             const Workers& workers = {});

}  // namespace kolsky
