#pragma once

#include <filesystem>
#include <string>

#include "clients/cli/reports/json_value.hpp"
#include "drivers/files/models/model_file.hpp"

namespace kolsky::cli {

/// The model of a file, or of "M.toml@3" as it was after three steps; @0 is how it began.
/// @throws InputError
[[nodiscard]] ModelFile model_named(const std::string& name);

/// The model of a file whose history goes on. @throws InputError of "M.toml@3", too: what was is
/// not changed
[[nodiscard]] ModelFile model_to_continue(const std::string& name);

/// Their names, in the bench's order.
[[nodiscard]] std::vector<std::string> gauges_of(const Bench& bench);

/// @param name  of the model's file, for people
/// @throws InputError where captures of this bench are not what the model is of: its kind, and the
/// gauges that its effects name
void require_model_of(const Bench& bench, const Model& model, const std::string& name);

/// Writes a model in the place of the one that had this name. Where that one took steps that this
/// one did not, it is given another name: no history is lost.
/// @return that name; empty where there was nothing to lose
/// @throws InputError as replace_file, and where what is there is no model that can be read
[[nodiscard]] std::string write_model(const std::filesystem::path& path, const ModelFile& file);

/// What is said of that name, a line; empty where there is none.
[[nodiscard]] std::string kept_text(const std::string& name, const std::string& kept);

/// The same for programs: `kept`.
void add_kept(const std::string& kept, JsonObject& answer);

/// "edited by hand after step 2"; empty where it was not.
[[nodiscard]] std::string edited_text(const ModelFile& file);

/// A step as `kolsky model history --json` gives it.
[[nodiscard]] JsonValue describe(const ModelStep& step);

/// What a step kept besides its action, for people; empty where there is nothing.
[[nodiscard]] std::string ledger_text(const ModelStep& step);

}  // namespace kolsky::cli
