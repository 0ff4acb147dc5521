#include "tests/hidden_effects/case.hpp"

#include <fstream>

#include "tests/generators/campaign_files.hpp"
#include "tests/generators/truth_file.hpp"

namespace kolsky::scoring {

std::string name_of(CaseKind kind) {
  switch (kind) {
    case CaseKind::null:
      return "null";
    case CaseKind::single:
      return "single";
    case CaseKind::tied:
      return "tied";
    case CaseKind::two:
      return "double";
    case CaseKind::absorbed:
      return "absorbed";
    case CaseKind::withheld:
      return "withheld";
  }
  return "";
}

CaseFiles write_case(const Case& drawn, const std::filesystem::path& root) {
  CaseFiles files;
  files.folder = root / "cases" / drawn.id;
  std::filesystem::remove_all(files.folder);  // what an earlier run left of the same case
  files.bench = files.folder / "bench.toml";
  files.truth = root / "truth" / (drawn.id + ".json");
  if (drawn.campaign.filed_bars) {
    testing::write_bars({.folder = files.folder}, *drawn.campaign.filed_bars);
    files.bars = files.folder / "bars.toml";
  }
  files.kind = drawn.campaign.split ? "shpb" : "bar";
  files.captures = testing::write_campaign({.folder = files.folder, .tables = false},
                                           testing::shots_of(drawn.campaign));
  std::filesystem::create_directories(files.truth.parent_path());
  nlohmann::json truth = testing::truth_of(drawn.campaign);
  truth["case"] = name_of(drawn.kind);
  truth["multiples"] = drawn.multiples;
  std::ofstream(files.truth) << truth.dump(2) << "\n";
  return files;
}

}  // namespace kolsky::scoring
