#pragma once

#include <vector>

#include "processing/criticism/fitting/study.hpp"

namespace kolsky {

/// Each shot's sum of squared whitened residuals with the shared parameters fitted to the other
/// shots, to first order around the common fit. Strengths of a shot's own (a drift, how warm its
/// bars were) are found in the shot itself, and their share of its noise is put back. With one
/// shot: its own.
[[nodiscard]] std::vector<double> held_out_squares(const Studied& studied,
                                                   std::size_t residuals_per_shot);

/// The same of folds: shots that are left out together.
/// @param folds  by fold, places of its shots
[[nodiscard]] std::vector<double> held_out_squares(
    const Studied& studied, std::size_t residuals_per_shot,
    const std::vector<std::vector<std::size_t>>& folds);

/// The same at finite size: where the records at the foretold parameters are not what first order
/// says they are, the other shots are fitted by themselves.
[[nodiscard]] std::vector<double> held_out_squares(const Studied& studied, ShotResiduals& residuals,
                                                   const Workers& executor);

/// What is held out of a campaign: shot by shot, or of a single shot's record part by part, to
/// first order.
[[nodiscard]] std::vector<double> held_out_squares(const Studied& studied, Study& study);

/// The same, to first order of shots too.
[[nodiscard]] std::vector<double> foretold_squares(const Studied& studied, Study& study);

/// The measure of a model on what its fit did not see: chi-square per residual, what is filed of
/// the bench among them. A model that bends filed numbers to fit is no better for it.
/// @param squares   held out, of all folds
/// @param residuals  how many there are on all of them
[[nodiscard]] double held_out_misfit(const std::vector<double>& squares, double penalty,
                                     double residuals);

/// What a fit leaves.
enum class Left { noise, more };

/// What the true model would leave of these very records, in the same measure. Where nothing shows
/// that more than noise is left, it is what the fit left and what its numbers took up, one each:
/// noise that repeats by chance is in all of them alike, and is nothing that an effect could close.
/// Else noise is what differs between the shots.
/// @param shots  1: there is nothing but the noise as it is known
[[nodiscard]] double floor_of(const Studied& after, Left left, std::size_t shots);

/// What an effect brought on shots that the fits did not see.
struct Certification {
  double gain = 0.0;       ///< of chi2
  std::size_t better = 0;  ///< how many shots gained
  /// Of all that shots say of the effect, what those say that gained. A shot at the mean
  /// temperature says nothing of how moduli change with it: it gains or loses by chance.
  double share = 0.0;
};

/// @param before, after  held-out squares without and with it
/// @param relief  how much less the fit strains what is filed of the bench, each shot's equal part
/// @param weight  how much each shot says of the effect; empty: all the same
[[nodiscard]] Certification certification(const std::vector<double>& before,
                                          const std::vector<double>& after, double relief,
                                          std::vector<double> weight = {});

}  // namespace kolsky
