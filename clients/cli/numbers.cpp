#include "clients/cli/numbers.hpp"

#include <cmath>
#include <cstdlib>
#include <sstream>

#include "processing/base/error.hpp"

namespace kolsky::cli {

double number_in(const std::string& text, const std::string& place) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (end == text.c_str() || *end != '\0' || !std::isfinite(value)) {
    throw InputError(place, "\"" + text + "\" is not a number", "give a number");
  }
  return value;
}

std::vector<double> numbers_in(const std::string& list, const std::string& place) {
  std::vector<double> numbers;
  std::istringstream words(list);
  for (std::string word; std::getline(words, word, ',');) {
    numbers.push_back(number_in(word, place));
  }
  if (numbers.empty()) {
    throw InputError(place, "holds no number", "give some, with commas between");
  }
  return numbers;
}

}  // namespace kolsky::cli
