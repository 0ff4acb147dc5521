#include "clients/cli/judged_records.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "clients/cli/captures.hpp"
#include "drivers/files/captures/capture.hpp"
#include "processing/base/error.hpp"
#include "processing/criticism/records/campaign.hpp"

namespace kolsky::cli {

void add_judged_options(JudgedRecords& judged, std::vector<Argument>& arguments) {
  arguments.push_back(option("--band-limit", "HZ",
                             "upper end of the frequencies judged; else what the noise allows",
                             &judged.band_limit_Hz));
  arguments.push_back(option("--until", "S",
                             "judges each record only so far [s from its first sample], as where "
                             "the bench does something later that no model has; else to its end",
                             &judged.until_s));
}

std::vector<Shot> read_shots(const JudgedRecords& judged) {
  if (judged.until_s && *judged.until_s <= 0.0) {
    throw InputError("--until", "must be above 0 s",
                     "give a time in seconds from the records' first sample");
  }
  std::vector<Shot> shots = read_shots(judged.captures);
  for (Shot& shot : shots) {
    if (judged.until_s && bad_data(shot).empty()) {
      cut_at(shot, *judged.until_s);
      if (const std::string left = bad_data(shot); !left.empty()) {
        throw InputError("--until", "leaves nothing of " + shot.id + " to judge: " + left,
                         "give a later time, in seconds from the records' first sample");
      }
    }
  }
  return shots;
}

std::string limits_text(const JudgedRecords& judged) {
  std::string text = judged.until_s ? fmt::format("up to {:g} s", *judged.until_s) : "";
  if (judged.band_limit_Hz) {
    text += fmt::format("{}up to {:g} Hz", text.empty() ? "" : ", ", *judged.band_limit_Hz);
  }
  return text;
}

std::vector<Shot> read_shots(const std::vector<std::string>& captures) {
  std::vector<Shot> shots = captured_shots(captures);
  const auto name_of_file = [](const Shot& shot) {
    return std::filesystem::path(shot.id).filename().string();
  };
  std::map<std::string, std::size_t> called;
  for (const Shot& shot : shots) {
    ++called[name_of_file(shot)];
  }
  // Of two folders one name may stand for two captures: then as they were given.
  const bool ambiguous =
      std::any_of(called.begin(), called.end(), [](const auto& name) { return name.second > 1; });
  for (Shot& shot : shots) {
    shot.id = ambiguous ? shot.id : name_of_file(shot);
  }
  return shots;
}

std::vector<std::filesystem::path> files_of(const std::vector<std::string>& captures) {
  std::vector<std::filesystem::path> files;
  for (const std::string& name : captures) {
    for (const auto& file : captures_in(name)) {
      files.push_back(file);
    }
  }
  return files;
}

double band_limit_of(std::optional<double> asked_Hz) {
  if (asked_Hz && *asked_Hz <= 0.0) {
    throw InputError("--band-limit", "must be above 0 Hz", "give a positive number in Hz");
  }
  return asked_Hz.value_or(0.0);
}

}  // namespace kolsky::cli
