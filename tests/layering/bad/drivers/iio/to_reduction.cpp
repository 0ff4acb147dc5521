#include "processing/reduction/reducer.hpp"
