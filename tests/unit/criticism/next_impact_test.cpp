#include "processing/criticism/impact/next_impact.hpp"

#include <gtest/gtest.h>

namespace kolsky {
namespace {

std::string change_for(const std::vector<std::string>& tied) {
  const NextExperiment next = next_impact(tied);
  EXPECT_EQ(next.separates, tied);
  return next.change;
}

/// Each tie is told by what leaves the other out: the bridge without the ball, the contact without
/// the material, the material without the contact.
TEST(NextImpact, LeavesOutWhatTheTieIsWith) {
  EXPECT_NE(change_for({"bridge-nonlinearity", "gauge-factor"}).find("shunt or a striker"),
            std::string::npos);
  EXPECT_NE(change_for({"core-nonlinearity", "amplifier-bandwidth"}).find("shunt or a striker"),
            std::string::npos);
  EXPECT_NE(change_for({"off-centre-contact", "core-nonlinearity"}).find("photograph"),
            std::string::npos);
  EXPECT_NE(change_for({"sabot-contact", "contact-friction"}).find("rebound speeds"),
            std::string::npos);
  const std::string materials = change_for({"core-nonlinearity", "cover-nonlinearity"});
  EXPECT_NE(materials.find("Hopkinson bar at larger strain"), std::string::npos) << materials;
  EXPECT_NE(materials.find("15 to 20 m/s"), std::string::npos) << materials;
}

/// With the bridge in the tie nothing else is told before it.
TEST(NextImpact, AsksForTheBridgeFirst) {
  EXPECT_EQ(change_for({"sabot-contact", "bridge-nonlinearity"}),
            change_for({"gauge-factor", "cover-nonlinearity"}));
}

}  // namespace
}  // namespace kolsky
