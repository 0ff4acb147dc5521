#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "processing/base/workers.hpp"
#include "processing/identification/bar_identification.hpp"
#include "processing/identification/bar_search.hpp"

namespace kolsky {

/// Theories of one bar's records, each searched as far as the choice between them needs.
///
/// All are searched roughly, with the shots as one. Those that the best of these leaves behind by
/// far more than a closer search could make up stay at that. The others are searched nearly to the
/// end, each by the weights of the noise that it foretells itself: residuals hold the source's
/// noise as the theory carries it, so that by another's weights what carries less would look
/// better.
class Explanations {
 public:
  /// @param data outlives this
  explicit Explanations(const BarData& data, Workers workers = {})
      : data_(data), workers_(std::move(workers)) {}

  /// Searches roughly, all from what was looked at before. All that may lead are looked at before
  /// the first is compared.
  void look(const std::vector<BarTheory>& theories);
  /// Also from the pulses' own speed and decay: another end leads astray, from where nothing leads
  /// back.
  void look_afresh(const BarTheory& theory);
  /// What the leading one leaves, over what noise would.
  [[nodiscard]] double left_over_noise() const;
  /// By how much chi2 a theory that was looked at is behind the leading one; 0 where it was not.
  [[nodiscard]] double behind(const BarTheory& theory) const;
  /// The one with the least that is left by a rough search; none where none was found.
  [[nodiscard]] const BarTheory* leading() const;

  /// What is compared: without the shots' own estimates. Null where it cannot be fitted.
  /// @param next  searched roughly beside them: what is likely to be asked for then
  [[nodiscard]] std::vector<const BarFit*> at(const std::vector<BarTheory>& theories,
                                              const std::vector<BarTheory>& next = {});
  [[nodiscard]] const BarFit* at(const BarTheory& theory) { return at(std::vector{theory})[0]; }
  /// The same of one with a number more than the leading one: null, too, where a rough search finds
  /// it no better.
  [[nodiscard]] const BarFit* at_if_better(const BarTheory& theory);

  /// Three elements searched to the end, with the shots' own estimates, and other families of
  /// solids from where they are at their best, to compare. Where that search has no end, for there
  /// is no loss to find, an elastic bar, and nothing to compare it with.
  struct Solids {
    BarFit three_element;
    std::vector<const BarFit*> others;
  };
  [[nodiscard]] Solids solids(const BarFit& three_element, const std::vector<SolidKind>& others);

  /// A Kelvin branch beside those of another fit, faster, slower or between them, by the weights of
  /// three elements. Null where there is no such family, or it cannot be fitted.
  [[nodiscard]] const BarFit* branch_more(const BarFit& three_element, const BarFit& fewer);

  /// The same without any loss; where that is far behind also from how stiff the lossy one is: what
  /// a loss too quick for the band leaves is an elastic bar, and weak pulses' speed may be far off.
  /// Null where it cannot be fitted.
  [[nodiscard]] const BarFit* lossless_beside(const BarFit& lossy);

  /// An end that returns all or nothing once more, from where one that may return anything is best:
  /// it holds the others within it.
  [[nodiscard]] const BarFit* again(const BarTheory& theory, const BarFit& partial);

  /// The fit of one that was compared, searched to the end, with the shots' own estimates. Null
  /// where that search does not end: it counts among those that failed then.
  [[nodiscard]] const BarFit* finished(const BarTheory& theory);

  /// All that were compared, best first.
  [[nodiscard]] std::vector<Alternative> alternatives() const;

 private:
  struct Entry {
    BarTheory theory;
    const Entry* near = nullptr;        ///< from where it is first searched
    std::unique_ptr<BarSearch> search;  ///< null where it failed
    double rough_chi2 = 0.0;
    bool left_behind = false;
    std::optional<BarFit> fit;
    std::string failed;
  };

  Entry* find(const BarTheory& theory);
  Entry& add(const BarTheory& theory);
  std::vector<Entry*> add_new(const std::vector<BarTheory>& theories);
  Entry& rough(const BarTheory& theory);
  void start_roughly(Entry& entry);
  void search_from_filed(Entry& entry);
  [[nodiscard]] double expected_chi2() const;
  void lead_with(Entry& entry);
  void compare(Entry& entry);
  void compare_from(Entry& entry, const BarFit& three_element,
                    const BarLikelihood::Weights& weights);
  [[nodiscard]] BarFit searched_to_end(Entry& entry);
  [[nodiscard]] std::optional<BarFit> if_it_ends(Entry& entry);
  [[nodiscard]] BarFit without_loss(BarTheory theory);
  void compare(Entry& entry, const std::function<void(BarSearch&)>& closely);
  /// By another search, where that ends better.
  using Start = std::function<std::unique_ptr<BarSearch>(const BarData&, const BarTheory&)>;
  void try_from(Entry& entry, const Start& start);
  [[nodiscard]] Alternative left_roughly(const Entry& entry) const;
  [[nodiscard]] double hopeless() const;
  [[nodiscard]] bool far_behind(const Entry& entry) const;
  [[nodiscard]] const Entry* nearest(const BarTheory& theory) const;
  /// @param hopeless  as BarSearch has it: only for what begins near its end
  void search_roughly(Entry& entry, const std::vector<double>& start, double hopeless = HUGE_VAL);

  const BarData& data_;
  Workers workers_;
  std::vector<std::unique_ptr<Entry>> entries_;
  Entry* leader_ = nullptr;
};

}  // namespace kolsky
