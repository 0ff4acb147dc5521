#include "drivers/files/capture.hpp"
