#include <chrono>
#include "processing/reduction/reducer.hpp"
