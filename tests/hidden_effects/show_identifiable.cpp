// Prints what a drawn bench could tell: the smallest identifiable size of every effect.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "tests/hidden_effects/identifiability.hpp"

int main(int argc, char** argv) {
  using namespace kolsky;
  testing::CampaignWishes wishes;
  bool tolerances = false;
  double rate_Hz = 0.0;
  std::size_t samples = 0;
  CLI::App app("The smallest identifiable size of every effect on the bench of that seed.");
  app.add_option("--seed", wishes.seed);
  app.add_option("--shots", wishes.shots);
  app.add_option("--gauges", wishes.gauges);
  app.add_option("--rate", rate_Hz);
  app.add_option("--samples", samples);
  app.add_flag("--split", wishes.split, "a split bar");
  app.add_flag("--elastic", wishes.elastic);
  app.add_flag("--tolerances", tolerances);
  CLI11_PARSE(app, argc, argv);
  wishes.tolerances = tolerances ? testing::Tolerances::filed : testing::Tolerances::none;
  if (rate_Hz > 0.0) {
    wishes.rate_Hz = rate_Hz;
  }
  if (samples > 0) {
    wishes.samples = samples;
  }
  const scoring::Identifiability found(testing::draw_campaign(wishes));
  fmt::print("{:<28}{:>12}{:>12}{:>9}  {}\n", "effect", "6 sigma", "smallest", "left", "closest");
  for (const scoring::Identifiable& effect : found.effects()) {
    fmt::print("{:<28}{:>12.3g}{:>12.3g}{:>9.3f}  {}\n", effect.candidate.effect.name(),
               effect.detect, effect.smallest, effect.rival_share, effect.closest);
  }
}
