#include <unistd.h>

#include <csignal>
#include <iostream>

#include "clients/cli/program.hpp"
#include "clients/terminal/terminal.hpp"

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the limit of the shell is an error like others
  return kolsky::cli::run_program({argv + 1, argv + argc}, std::cout, std::cerr,
                                  kolsky::terminal_of(STDOUT_FILENO));
}
