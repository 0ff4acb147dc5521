#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "clients/cli/command.hpp"
#include "processing/base/shot.hpp"

namespace kolsky::cli {

/// Which records a model is held against, and how far.
struct JudgedRecords {
  std::vector<std::string> captures;  ///< files or folders of them
  std::optional<double> band_limit_Hz;
  std::optional<double> until_s;  ///< from each record's first sample
};

/// --band-limit and --until, which set it.
void add_judged_options(JudgedRecords& judged, std::vector<Argument>& arguments);

/// The captures, read, each cut off where --until says. @throws InputError
[[nodiscard]] std::vector<Shot> read_shots(const JudgedRecords& judged);

/// Captures named on the command line (files or folders), read. @throws InputError
[[nodiscard]] std::vector<Shot> read_shots(const std::vector<std::string>& captures);

/// "up to 0.0012 s, up to 20000 Hz" where --until and --band-limit were given, else empty: for what
/// a model's history tells.
[[nodiscard]] std::string limits_text(const JudgedRecords& judged);

/// The files of captures that the command line names.
[[nodiscard]] std::vector<std::filesystem::path> files_of(const std::vector<std::string>& captures);

/// What --band-limit asks for; 0, what the noise allows, where it was not given.
/// @throws InputError where it is not above 0
[[nodiscard]] double band_limit_of(std::optional<double> asked_Hz);

}  // namespace kolsky::cli
