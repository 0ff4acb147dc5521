#include <unistd.h>

#include <csignal>
#include <iostream>

#include "clients/cli/program.hpp"
#include "clients/terminal/terminal.hpp"
#include "drivers/memory/kept_memory.hpp"

int main(int argc, char** argv) {
  kolsky::keep_freed_memory();
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the limit of the shell is an error like others
  return kolsky::cli::run_program({argv + 1, argv + argc}, std::cout, std::cerr,
                                  kolsky::terminal_of(STDOUT_FILENO));
}
