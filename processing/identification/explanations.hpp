#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "processing/identification/bar_identification.hpp"
#include "processing/identification/bar_search.hpp"

namespace kolsky {

/// Theories of one bar's records, each searched as far as the choice between them needs.
///
/// All are searched roughly, with the shots as one. Those that the best of these leaves behind by
/// far more than a closer search could make up stay at that. The others are searched to the end by
/// the same weights, those of the best: so a theory that holds another one within it never looks
/// worse than that because of where it happened to be weighed.
class Explanations {
 public:
  /// @param data outlives this
  explicit Explanations(BarData& data) : data_(data) {}

  /// Searches roughly. All that may lead are looked at before the first is compared.
  void look(const BarTheory& theory);
  /// The one with the least that is left by a rough search; none where none was found.
  [[nodiscard]] const BarTheory* leading() const;

  /// What is compared: without the shots' own estimates. Null where it cannot be fitted.
  [[nodiscard]] const BarFit* at(const BarTheory& theory);
  /// Of another family of solids, from three elements at their best.
  [[nodiscard]] const BarFit* at(const BarTheory& theory, const BarFit& three_element);

  /// The fit of one that was compared, by its own weights, with the shots' own estimates.
  [[nodiscard]] BarFit finished(const BarTheory& theory);

  /// All that were compared, best first.
  [[nodiscard]] std::vector<Alternative> alternatives() const;

 private:
  struct Entry {
    BarTheory theory;
    std::unique_ptr<BarSearch> search;  ///< null where it failed
    double rough_chi2 = 0.0;
    bool left_behind = false;
    std::optional<BarFit> fit;
    std::string failed;
  };

  Entry* find(const BarTheory& theory);
  Entry& add(const BarTheory& theory);
  Entry& rough(const BarTheory& theory);
  void compare(Entry& entry, const std::vector<double>& start);
  /// By another search, where that ends better.
  using Start = std::function<std::unique_ptr<BarSearch>(BarData&, const BarTheory&)>;
  void try_from(Entry& entry, const Start& start);
  [[nodiscard]] bool far_behind(const Entry& entry) const;
  [[nodiscard]] std::vector<double> start_for(const BarTheory& theory) const;

  BarData& data_;
  std::vector<std::unique_ptr<Entry>> entries_;
  Entry* leader_ = nullptr;
  BarLikelihood::Weights weights_;
};

}  // namespace kolsky
