#include "tests/generators/measured_noise.hpp"

#include <cstdlib>
#include <fstream>
#include <numeric>
#include <sstream>

#include "processing/base/error.hpp"

namespace kolsky::testing {

std::vector<double> measured_noise(const std::string& place) {
  const std::size_t rows_at = place.rfind(':');
  const std::size_t column_at =
      rows_at == std::string::npos ? rows_at : place.rfind(':', rows_at - 1);
  if (column_at == std::string::npos) {
    throw InputError("--noise", "\"" + place + "\" names no column and rows",
                     "write TABLE.csv:COLUMN:ROWS");
  }
  const int column = std::atoi(place.substr(column_at + 1).c_str());
  const auto rows = static_cast<std::size_t>(std::atoi(place.substr(rows_at + 1).c_str()));
  std::ifstream file(place.substr(0, column_at));
  std::vector<double> values;
  for (std::string line; values.size() < rows && std::getline(file, line);) {
    std::istringstream cells(line);
    std::string cell;
    for (int i = 0; i < column; ++i) {
      std::getline(cells, cell, ',');
    }
    char* end = nullptr;
    const double value = std::strtod(cell.c_str(), &end);
    if (end != cell.c_str()) {
      values.push_back(value);
    }
  }
  if (values.size() < 16) {
    throw InputError("--noise " + place, "holds fewer than 16 numbers",
                     "name a table with commas and a column of numbers");
  }
  const double mean =
      std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  for (double& value : values) {
    value -= mean;
  }
  return values;
}

}  // namespace kolsky::testing
