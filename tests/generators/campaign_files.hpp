#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"

namespace kolsky::testing {

/// A campaign as its user has it: bench.toml, shotNN.csv with what `kolsky import csv` needs in
/// import.sh, and shotNN.h5.
struct CampaignFolder {
  std::filesystem::path folder;
  bool tables = true;
  bool captures = true;
  bool time_from_trigger = false;
};

/// @return the captures, or the tables where none are written
std::vector<std::filesystem::path> write_campaign(const CampaignFolder& to,
                                                  std::vector<Shot> shots);
/// bars.toml for `--bar-model`.
void write_bars(const CampaignFolder& to, const Material& bars);

[[nodiscard]] std::string bench_text(const Bench& bench);

}  // namespace kolsky::testing
