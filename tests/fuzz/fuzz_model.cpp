// Any text is a model that reads back as itself, or refused with one line; formulas included.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "drivers/files/models/model_file.hpp"
#include "processing/base/error.hpp"
#include "processing/models/formula.hpp"

namespace {

using kolsky::InputError;

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

void try_model(const std::string& text) {
  try {
    const std::string once = kolsky::format_model(kolsky::parse_model(text, "f.toml"));
    require(kolsky::format_model(kolsky::parse_model(once, "f.toml")) == once);
  } catch (const InputError& error) {
    const std::string line = error.what();
    require(line.find('\n') == std::string::npos);
    require(line.starts_with("f.toml"));
    require(!error.mend().empty());
  }
}

/// The text as a formula by itself: what parses also runs.
void try_formula(const std::string& text) {
  try {
    const kolsky::Formula formula(text, {{"s", kolsky::dimension_of("1/s")}, {"c", {}}});
    const std::vector<kolsky::Complex> path{{1.0, 2.0}, {1.0, 3.0}};
    const kolsky::Complex c = 0.5;
    const std::vector<std::span<const kolsky::Complex>> values{path, {&c, 1}};
    std::vector<kolsky::Complex> out(path.size());
    formula.evaluate(values, out);
  } catch (const InputError& error) {
    require(error.place().starts_with("column "));
    require(!error.mend().empty());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  try_model(text);
  try_formula(text);
  return 0;
}
