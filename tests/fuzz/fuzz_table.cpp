// Any bytes are a table of finite numbers with an even time axis, or refused with one line.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "drivers/files/tables/quantise.hpp"
#include "drivers/files/tables/scope_table.hpp"
#include "drivers/files/tables/time_axis.hpp"
#include "processing/base/error.hpp"

namespace {

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

bool all_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(),
                     [](double value) { return std::isfinite(value); });
}

void try_table(std::string_view bytes) {
  const kolsky::ScopeTable table = kolsky::parse_scope_table(bytes, "t.csv");
  require(table.time_s.size() >= 2 && !table.columns.empty());
  require(all_finite(table.time_s));
  for (const kolsky::TableColumn& column : table.columns) {
    require(column.values.size() == table.time_s.size());
    require(all_finite(column.values));
    require(kolsky::quantise(column.values).codes.size() == column.values.size());
  }
  require(kolsky::measured_rate_Hz(table) > 0.0);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(data, data + size);
  try {
    try_table(bytes);
  } catch (const kolsky::InputError& error) {
    const std::string line = error.what();
    require(line.find('\n') == std::string::npos);
    require(line.starts_with("t.csv"));
    require(!error.mend().empty());
  }
  return 0;
}
