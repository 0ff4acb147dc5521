// What speaks against a claim.
#include "processing/criticism/verdict/doubts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "processing/criticism/verdict/disbelief.hpp"
#include "processing/criticism/verdict/refits.hpp"
#include "tests/generators/campaign.hpp"
#include "tests/unit/criticism/filed_bars.hpp"

namespace kolsky {
namespace {

const std::string kClaim = "gauge-factor:g2";

/// One thing is missing, and it is claimed.
class Doubts : public ::testing::Test {
 protected:
  Doubts()
      : campaign_(read_campaign(testing::shots_of(with_a_fault()))),
        study_(campaign_, 0.0, Workers{}),
        found_(claimed()),
        before_(without(study_, found_.current, kClaim)) {}

  static testing::Campaign with_a_fault() {
    testing::Campaign truth =
        testing::draw_campaign({.seed = 7, .shots = 3, .gauges = 3, .samples = 2000});
    testing::hide(truth, testing::parse_effect(kClaim + "=0.03"));
    return truth;
  }

  Findings claimed() {
    Model model = paper_model(BenchKind::bar, false);
    model.effects.push_back(use_named(kClaim));
    const Studied fitted = study_.fit(model);
    Findings found{.first = fitted, .current = fitted, .start = model};
    found.diagnosis.effects = {kClaim};
    return found;
  }

  bool says_worse(const HeldOut& held_out, const DiagnosisOptions& options = {}) {
    found_.diagnosis.held_out = held_out;
    const double noise = noise_of(found_.current.misfit, campaign_.shots.size());
    const std::vector<std::string> reasons =
        doubts(study_, options, found_, before_, std::nullopt, noise);
    return std::ranges::any_of(reasons, [](const std::string& reason) {
      return reason.find("held out misfit more") != std::string::npos;
    });
  }

  Campaign campaign_;
  Study study_;
  Findings found_;
  Studied before_;
};

TEST_F(Doubts, AreOfAClaimThatShotsHeldOutAreFartherFrom) {
  EXPECT_TRUE(says_worse({.before = 1.10, .after = 1.11, .floor = 1.0}));
  EXPECT_FALSE(says_worse({.before = 1.11, .after = 1.10, .floor = 1.0}));
}

TEST_F(Doubts, AskShotsHeldOutOnlyOfClaimsAndWhereThatSafeguardStands) {
  const HeldOut worse{.before = 1.10, .after = 1.11, .floor = 1.0};
  DiagnosisOptions unguarded;
  unguarded.safeguards.held_out = false;
  EXPECT_FALSE(says_worse(worse, unguarded));
  found_.diagnosis.effects.clear();
  EXPECT_FALSE(says_worse(worse));
}

// Three were told of beside a list of four.
TEST_F(Doubts, CountAsManyEffectsAsAreListed) {
  found_.diagnosis.effects = {kClaim, "crosstalk:g3", "temperature", "geometric-dispersion"};
  for (const char* id : {"crosstalk:g3", "temperature", "geometric-dispersion"}) {
    found_.current.model.effects.push_back(use_named(id));
  }
  const std::vector<std::string> reasons =
      why_unknown(found_.diagnosis, found_.current, campaign_, std::nullopt, 0.0, -5.0);
  EXPECT_TRUE(std::ranges::any_of(reasons, [](const std::string& reason) {
    return reason.find("it takes 4 effects") != std::string::npos;
  }));
}

}  // namespace
}  // namespace kolsky
