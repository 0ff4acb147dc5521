// A user who is told that an effect is missing finds out what that is.
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>
#include <string>

#include "processing/models/effect.hpp"
#include "tests/unit/page.hpp"

namespace kolsky {
namespace {

TEST(EffectsPage, HoldsEveryEffectOfTheLibrary) {
  const std::string page = testing::page("docs/methods/effects.md");
  for (const Effect* effect : effect_library()) {
    const std::string& id = effect->about().id;
    const bool of_a_bar = id.starts_with("output-bar-");
    // "bar-density, bar-diameter, bar-modulus and output-..." stand in one row.
    EXPECT_NE(page.find(of_a_bar ? id.substr(7) : id), std::string::npos) << id;
  }
}

TEST(EffectsPage, AndOtherPagesThatAnEffectCitesAreThere) {
  for (const Effect* effect : effect_library()) {
    std::istringstream cited(effect->about().reference);
    std::string one;
    EXPECT_FALSE(effect->about().reference.empty()) << effect->about().id;
    while (std::getline(cited >> std::ws, one, ';')) {
      if (one.find(".md") != std::string::npos) {
        EXPECT_TRUE(std::filesystem::exists(testing::kProject / one))
            << effect->about().id << ": " << one;
      }
    }
  }
}

}  // namespace
}  // namespace kolsky
