#include "clients/cli/command.hpp"
