#include <unistd.h>

#include <iostream>

#include "clients/cli/program.hpp"
#include "clients/terminal/terminal.hpp"

int main(int argc, char** argv) {
  return kolsky::cli::run_program({argv + 1, argv + argc}, std::cout, std::cerr,
                                  kolsky::terminal_of(STDOUT_FILENO));
}
