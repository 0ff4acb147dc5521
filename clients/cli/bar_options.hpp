#pragma once

#include <optional>
#include <string>

#include "clients/cli/command.hpp"
#include "processing/base/bench.hpp"
#include "processing/base/material.hpp"

namespace kolsky::cli {

// Options that several commands take of a bar, and what they say of it.

/// Which of a bench's bars: input (default) or output.
[[nodiscard]] Argument bar_option(std::optional<std::string>* target);

/// How waves travel: elementary, love or exact, and what else a command takes.
/// @param help  what is chosen, and the default
[[nodiscard]] Argument dispersion_option(std::string help, std::optional<std::string>* target,
                                         const std::optional<std::string>& further = {});

/// `--solid` or alike: a family of solids by name, or auto.
[[nodiscard]] Argument solid_option(std::string name, std::string help,
                                    std::optional<std::string>* target);

/// Three elements where nothing is asked for. @return nothing for auto
[[nodiscard]] std::optional<SolidKind> solid_asked(const std::optional<std::string>& name);

/// What a bar is taken to be, for people. @param given  a bar model, if there is any
[[nodiscard]] std::string bar_in_words(const Bar& bar, const Bench& bench,
                                       const std::optional<Material>& given);

}  // namespace kolsky::cli
