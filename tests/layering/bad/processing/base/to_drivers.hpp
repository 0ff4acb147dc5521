#include "drivers/files/captures/capture.hpp"
