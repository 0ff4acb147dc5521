#pragma once

#include <string>

/// The daemon's log: one line per event on stderr, written by a thread of its own so that no caller
/// waits for a terminal or a pipe that does not drain (the oldest lines go then). Not for the
/// acquisition thread.
namespace kolsky::log {

enum class Level { quiet, normal, verbose };

void start(Level level);
/// Writes what is left; later lines are written directly.
void stop();

void debug(const std::string& line);
void info(const std::string& line);
void warning(const std::string& line);
void error(const std::string& line);

}  // namespace kolsky::log
