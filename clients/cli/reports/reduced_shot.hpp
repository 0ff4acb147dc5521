#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "clients/cli/reports/json_value.hpp"
#include "clients/terminal/terminal.hpp"
#include "processing/base/shot.hpp"
#include "processing/reduction/loop_summary.hpp"
#include "processing/reduction/reducer.hpp"
#include "processing/uncertainty/monte_carlo.hpp"

namespace kolsky::cli {

/// A shot with its result, whether reduced here or by the daemon: what `reduce` and `get` show.
struct ReducedShot {
  Shot shot;
  Reduction reduction;
  std::string capture;  ///< the file, absolute
  bool default_bar_model =
      false;  ///< the bars were taken for the paper's PMMA because nobody said what they are
  ReductionRequest request{};          ///< how it was asked for, filed with the shot or not
  ReductionOptions options{};          ///< and what that came to
  std::optional<std::string> bench{};  ///< a corrected bench file, in place of the shot's own
  std::optional<Uncertainty> uncertainty{};
  std::optional<Reduction> as_filed{};  ///< then: the result with the shot's own bench
};

/// Puts a corrected bench in the place of a shot's own; the samples stay as they are.
/// @throws InputError where the bench's gauges or rate are not the shot's
void rebench(Shot& shot, const std::filesystem::path& bench);

/// The path by which a file is named in output: the same from wherever it was given.
[[nodiscard]] std::string absolute_name(const std::filesystem::path& path);

/// Whether a reduction with these options has to assume what the bars are made of.
[[nodiscard]] bool assumes_bar_model(const Shot& shot, const ReductionOptions& options);

/// What a command asks of a capture's reduction.
struct Asked {
  ReductionRequest request{};
  bool as_filed = true;  ///< by what is filed with the capture where `request` is silent
  std::optional<double> arrival_s{};  ///< these as in ReductionOptions
  std::optional<Material> bar_model{};
  std::optional<std::string> bench{};  ///< a corrected bench file: the result then holds the one
                                       ///< with the shot's own too
};

/// Reads a capture and reduces it. @throws InputError
[[nodiscard]] ReducedShot reduce_capture(const std::filesystem::path& capture,
                                         const Asked& asked = {});

/// What --true does, for --help.
inline constexpr const char* kTrueHelp =
    "in --json and tables also strain_true = -ln(1 - strain) and stress_true_Pa = stress_Pa (1 - "
    "strain), for a specimen that keeps its volume";

/// The uncertainty's part of both.
/// @param front_known  false where equilibrium was taken for granted: the front force is the back's
/// then, and how far off that is no draw tells
void describe_uncertainty(const Uncertainty& uncertainty, bool front_known, JsonObject& object);
[[nodiscard]] std::string uncertainty_report(const Uncertainty& uncertainty);

/// What `reduce --json` and `get --json` print.
[[nodiscard]] JsonValue describe(const ReducedShot& shot);

/// The same for people: numbers, verdicts with their sentences, the loop and the forces drawn.
[[nodiscard]] std::string report(const ReducedShot& shot, const Terminal& terminal);

/// Parts that a specimen's report and a ball's have in common.
[[nodiscard]] JsonValue describe_meta(const std::map<std::string, std::string>& meta);
/// What was asked of the reduction, by its keys.
[[nodiscard]] JsonValue describe_request(const ReductionRequest& request);
/// reducible, reason, verdict and checks.
[[nodiscard]] JsonObject describe_checks(const Quality& quality);
[[nodiscard]] std::string report_row(const std::string& name, const std::string& text);
[[nodiscard]] std::string report_head(const ReducedShot& reduced, const Terminal& terminal);
[[nodiscard]] std::string verdicts_text(const Quality& quality, const Terminal& terminal);

[[nodiscard]] std::string verdict_name(Verdict verdict);
[[nodiscard]] Ink verdict_ink(Verdict verdict);

}  // namespace kolsky::cli
