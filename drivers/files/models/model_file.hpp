#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "drivers/files/models/model_step.hpp"
#include "processing/models/model.hpp"

namespace kolsky {

/// A model with the lineage that its file carries along: nothing that it once was is lost.
struct ModelFile {
  Model model;
  std::string bar_source;  ///< where the bars' moduli come from, for people; may be empty
  /// Names of the gauges of the bench that it was made for or fitted on last; empty: not known.
  std::vector<std::string> gauges;
  std::vector<ModelStep> history;
  /// Its file holds another model than its last step left: somebody wrote into it, as one may.
  bool edited_by_hand = false;

  [[nodiscard]] std::string parent() const {
    return history.empty() ? std::string{} : history.back().parent;
  }
  /// As it was after so many steps, with their history; 0: as it began. @throws InputError where
  /// there were fewer
  [[nodiscard]] ModelFile at(std::size_t steps) const;
  /// After how many steps it was first what it is after so many: going back is a step, too, and
  /// leads to what was there before.
  [[nodiscard]] std::size_t first_alike(std::size_t steps) const;
};

/// @throws InputError: file, line, key and mend; also where a history has no seal (`ledger`) or
/// another's
[[nodiscard]] ModelFile read_model(const std::filesystem::path& path);
[[nodiscard]] ModelFile parse_model(const std::string& text, const std::string& name);

/// TOML that reads back as the same bits; without the history where it is not asked for. With one
/// its seal is written, and that of the model as the last step left it (`state`).
[[nodiscard]] std::string format_model(const ModelFile& file, bool with_history = true);

/// One digest of several captures, of their own digests in rising order: by it a history knows what
/// a fit saw, in whatever order. @throws InputError for a file that cannot be read
[[nodiscard]] std::string digest_of_files(const std::vector<std::filesystem::path>& files);

/// Whether a history's digest is that of these captures; versions up to 0.1.0 made it of their
/// digests in the order in which they were given.
[[nodiscard]] bool is_digest_of(const std::string& digest,
                                const std::vector<std::filesystem::path>& files);

/// "2026-11-21T14:00:00Z", as a history has it.
[[nodiscard]] std::string utc_now();

/// Appends a step: the file as it is now becomes the parent of what follows. What was edited by
/// hand before is noted with the step.
void begin_step(ModelFile& file, const std::string& action, const std::string& when = utc_now());

}  // namespace kolsky
