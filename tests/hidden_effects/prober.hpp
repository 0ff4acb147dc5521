#pragma once

#include <functional>
#include <vector>

#include "tests/generators/campaign.hpp"
#include "tests/hidden_effects/source_freedom.hpp"
#include "tests/hidden_effects/whitening.hpp"

namespace kolsky::scoring {

/// One thing that could change the records, per unit of strength from its null.
struct Candidate {
  testing::HiddenEffect effect;  ///< with the strength at which the difference was taken
  testing::EffectKind kind;
  double null = 0.0;
  double most = 0.0;  ///< strength from null that a laboratory may have and the generator can make
};

/// Whether an effect is there or not, rather than more or less.
[[nodiscard]] bool is_there_or_not(const std::string& id);

/// What a change leaves in every record, per unit and whitened.
struct Direction {
  testing::Readings readings;
  double prior_sd = 0.0;  ///< 0: free
  /// Brings a campaign so many units along it, however far.
  std::function<void(testing::Campaign&, double)> move{};

  /// What its prior adds to its information.
  [[nodiscard]] double known() const { return prior_sd > 0.0 ? 1.0 / (prior_sd * prior_sd) : 0.0; }
};

/// Changes of a campaign's records, from the generator alone: whitened with the noise drawn.
class Prober {
 public:
  /// @param campaign  outlives this
  explicit Prober(const testing::Campaign& campaign);

  /// What every analyser has to fit besides sources and offsets: moduli, and what is filed with a
  /// deviation.
  [[nodiscard]] std::vector<Direction> nuisances();
  /// Per unit of strength, to second order.
  [[nodiscard]] testing::Readings unit_change(const Candidate& candidate);
  /// The same change at every gauge, at the cost of one.
  [[nodiscard]] testing::Readings unit_change_everywhere(const Candidate& candidate);
  /// All that one campaign reads otherwise than another on the same bench.
  [[nodiscard]] testing::Readings whole_change(const testing::Campaign& changed,
                                               const testing::Campaign& from);
  [[nodiscard]] SourceFreedom freedom();

 private:
  // Ties are exact to first order: differences must be better than that.
  enum class Differences { central, one_sided, whole };

  [[nodiscard]] static Differences differences_of(const testing::EffectKind& kind);
  [[nodiscard]] testing::Readings unit_change(const std::function<testing::Campaign(double)>& at,
                                              double step, Differences differences);
  [[nodiscard]] std::function<testing::Campaign(double)> along(
      std::function<void(testing::Campaign&, double)> move) const;
  void add_modulus(std::vector<Direction>& out, double testing::TrueMaterial::*member, bool held,
                   double relative_sd);
  void add_specimen(std::vector<Direction>& out);
  void add_gauges(std::vector<Direction>& out);

  const testing::Campaign& campaign_;
  testing::CampaignForward forward_;
  Whitening whiten_;
  testing::Readings base_;
};

}  // namespace kolsky::scoring
