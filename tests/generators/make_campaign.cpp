// Writes a campaign with hidden effects: bench file, tables and captures in one folder, the truth
// in another file.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <iostream>

#include "processing/base/error.hpp"
#include "tests/generators/campaign.hpp"
#include "tests/generators/campaign_files.hpp"
#include "tests/generators/measured_noise.hpp"
#include "tests/generators/truth_file.hpp"

namespace {

using namespace kolsky;
using namespace kolsky::testing;

struct Arguments {
  std::string kind = "bar";
  std::vector<std::string> effects;
  CampaignWishes wishes;
  std::string noise = "white";
  std::string noise_record;
  std::string out = "campaign";
  std::string truth;
  std::string form = "both";
  bool tolerances = false;
  bool list = false;
  int bits = -1;
  std::size_t samples = 0;
  double rate_Hz = 0.0;
  double radius_m = 0.0;
};

void list_effects(bool split) {
  for (const EffectKind& kind : split ? shpb_effects() : bar_effects()) {
    std::cout << fmt::format("{}{}\t[{}]\tnull {}\ttypical {}{}\n", kind.id,
                             kind.per_gauge ? ":GAUGE" : "", kind.unit, kind.null, kind.typical,
                             kind.withheld ? "\twithheld from the library" : "");
  }
}

void settle(Arguments& arguments) {
  CampaignWishes& wishes = arguments.wishes;
  wishes.split = arguments.kind == "shpb";
  wishes.colour = colour_named(arguments.noise);
  if (!arguments.noise_record.empty()) {
    wishes.colour = NoiseColour::measured;
    wishes.measured_noise = measured_noise(arguments.noise_record);
  }
  wishes.tolerances = arguments.tolerances ? Tolerances::filed : Tolerances::none;
  if (arguments.bits >= 0) {
    wishes.bits = arguments.bits;
  }
  if (arguments.samples > 0) {
    wishes.samples = arguments.samples;
  }
  if (arguments.rate_Hz > 0.0) {
    wishes.rate_Hz = arguments.rate_Hz;
  }
  if (arguments.radius_m > 0.0) {
    wishes.radius_m = arguments.radius_m;
  }
  if (arguments.truth.empty()) {
    arguments.truth = arguments.out + ".truth.json";
  }
}

int run(Arguments& arguments) {
  settle(arguments);
  Campaign campaign = draw_campaign(arguments.wishes);
  for (const std::string& text : arguments.effects) {
    hide(campaign, parse_effect(text));
  }
  const CampaignFolder folder{arguments.out, arguments.form != "captures",
                              arguments.form != "tables", arguments.wishes.seed % 2 == 0};
  if (campaign.filed_bars) {
    write_bars(folder, *campaign.filed_bars);
  }
  write_campaign(folder, shots_of(campaign));
  std::ofstream(arguments.truth) << truth_of(campaign).dump(2) << "\n";
  std::cout << fmt::format("{}: {} shots, truth in {}\n", arguments.out, arguments.wishes.shots,
                           arguments.truth);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Writes a campaign of records with hidden effects and, apart from it, the truth.");
  app.add_option("--kind", arguments.kind, "bar or shpb")->check(CLI::IsMember({"bar", "shpb"}));
  app.add_option(
      "--effect", arguments.effects,
      "ID[:GAUGE]=STRENGTH[,key=value], in the unit of the effects' reference; again for "
      "more");
  app.add_option("--shots", arguments.wishes.shots)->check(CLI::Range(1, 99));
  app.add_option("--gauges", arguments.wishes.gauges)->check(CLI::Range(1, 8));
  double microstrain = 4.0;
  app.add_option("--noise", microstrain, "rms in microstrain");
  app.add_option("--noise-colour", arguments.noise)
      ->check(CLI::IsMember({"white", "coloured", "pink"}));
  app.add_option("--noise-record", arguments.noise_record,
                 "TABLE.csv:COLUMN:ROWS, the quiet beginning of a measured record");
  app.add_option("--seed", arguments.wishes.seed);
  app.add_option("--bits", arguments.bits, "8 to 16, 0 for none; drawn if not given");
  app.add_option("--samples", arguments.samples, "per record; drawn if not given");
  app.add_option("--rate", arguments.rate_Hz, "Hz; drawn if not given");
  app.add_option("--radius", arguments.radius_m, "of the bar, m; drawn if not given");
  app.add_flag("--elastic", arguments.wishes.elastic, "a metal bar");
  app.add_flag("--solid-specimen", arguments.wishes.solid_specimen,
               "axisymmetric, with its own mass and friction; of split bars");
  CLI::Option* soft =
      app.add_flag("--soft-specimen", arguments.wishes.soft_specimen, "a rubber; of split bars");
  app.add_flag("--low-loss-specimen", arguments.wishes.low_loss_specimen,
               "a solid that relaxes little; of split bars")
      ->excludes(soft);
  app.add_flag("--tolerances", arguments.tolerances,
               "file deviations (_sd) and draw the true numbers within them");
  app.add_option("--form", arguments.form)->check(CLI::IsMember({"tables", "captures", "both"}));
  app.add_option("--out", arguments.out, "folder");
  app.add_option("--truth", arguments.truth, "file for the truth; OUT.truth.json if not given");
  app.add_flag("--list", arguments.list, "the effects, and nothing else");
  CLI11_PARSE(app, argc, argv);
  arguments.wishes.noise_strain = microstrain * 1e-6;
  if (arguments.list) {
    list_effects(arguments.kind == "shpb");
    return 0;
  }
  try {
    return run(arguments);
  } catch (const InputError& error) {
    std::cerr << error.what() << "\n";
    return 2;
  }
}
