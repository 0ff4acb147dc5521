#include "processing/criticism/verdict/diagnosis.hpp"
