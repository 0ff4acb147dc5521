#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/criticism/search/search.hpp"
#include "processing/criticism/verdict/diagnosis.hpp"

namespace kolsky {

/// Beside the best, rivals this close in evidence (squares of normal deviates) are not told apart:
/// the true one stays in the set in 99.7 of 100 cases.
inline constexpr double kTie = 7.5;
/// How far the best is ahead of a rival that is told from it: twice as far where that comes out
/// about as strong as the sizes filed make it and the best does not. Before any record is seen,
/// what physics asks for is likelier than a fault (a number filed as exact that is not) that does
/// as well, and formulas of a solid are first terms.
[[nodiscard]] double tie_limit(const EffectUse& best, const EffectUse& rival);

/// What one search certifies: the best, and what cannot be told from it.
struct Choice {
  std::string id;
  std::size_t candidate = 0;
  Studied studied;
  std::vector<std::string> ties;
  /// The shots do not agree on it, or it is not ahead, as may be while another is missing.
  bool on_trial = false;
  /// By how much its strength is another in a variant of it that fits as well: of a hum that is as
  /// well of 50 as of 60 Hz.
  double variants_differ = 0.0;
  /// In squares of normal deviates, or of misfit over the noise if that is more, over the next that
  /// could be named in its place, be it in a tie with it. Of a first choice only.
  std::optional<double> lead_over_next = std::nullopt;
};

/// Chooses what is claimed of what searches find, on chance, on shots that were held out, on what
/// is built at all and on whether the shots agree.
class Chooser {
 public:
  /// @param diagnosis  takes what becomes of the candidates; outlives this
  Chooser(Study& study, const DiagnosisOptions& options, Diagnosis& diagnosis)
      : study_(study), options_(options), diagnosis_(diagnosis) {}

  /// Where nothing is claimed yet: the candidates' rows take what the refits found, and what the
  /// shots do not agree on is chosen on trial where nothing else is.
  /// @param base    the model that was searched
  /// @param barred  is not chosen, however well it does, and then nothing is on trial
  [[nodiscard]] std::optional<Choice> choose_first(Search& search, const Studied& base,
                                                   const std::vector<std::string>& barred);
  /// Beside what is claimed.
  [[nodiscard]] std::optional<Choice> choose_next(Search& search, const Studied& base);

 private:
  /// What a search refitted, and how it fares on shots that were held out.
  struct Found {
    Search& search;
    std::vector<Refit> refits;
    std::vector<Certification> held_out;
    const std::vector<std::string>& barred;
  };
  /// Places among the refits.
  struct Places {
    std::optional<std::size_t> best;  ///< that may be named
    /// To that: foretold, but the shots disagree on it, or it is far behind what is not foretold.
    std::optional<std::size_t> nearest;
    std::vector<std::size_t> confirmed;
  };

  [[nodiscard]] Found found_by(Search& search, const Studied& base,
                               const std::vector<std::string>& barred);
  void note_all(const Found& found);
  [[nodiscard]] Places places_of(const Found& found);
  void prefer_library(const Found& found, Places& places) const;
  [[nodiscard]] bool sound(const Found& found, std::size_t i) const;
  [[nodiscard]] bool foretold(const Found& found, std::size_t i) const;
  [[nodiscard]] bool agreed(const Found& found, std::size_t i) const;
  [[nodiscard]] Choice chosen(Found& found, Places places);
  [[nodiscard]] static bool is_barred(const Found& found, std::size_t i);
  [[nodiscard]] std::optional<double> lead_over_next(const Found& found, std::size_t best) const;
  [[nodiscard]] bool claimable(const Search& search, const Refit& refit) const;
  [[nodiscard]] bool states_a_strength(const Search& search, const Refit& refit) const;
  [[nodiscard]] bool plausible(const Search& search, const Refit& refit) const;
  /// ln of the chance, the search counted, above which nothing comes into question.
  [[nodiscard]] double least_plausible() const;
  [[nodiscard]] std::vector<Certification> certify(const Search& search,
                                                   const std::vector<Refit>& refits,
                                                   const Studied& base) const;

  Study& study_;
  const DiagnosisOptions& options_;
  Diagnosis& diagnosis_;
};

}  // namespace kolsky
