// Any text is a bench, a material or refused with one line; what is taken is in range.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>

#include "drivers/files/settings/bench_file.hpp"
#include "drivers/files/settings/material_file.hpp"
#include "processing/base/error.hpp"

namespace {

using kolsky::InputError;

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

void require_clear(const InputError& error) {
  const std::string line = error.what();
  require(line.find('\n') == std::string::npos);
  require(line.starts_with("f.toml"));
  require(!error.mend().empty());
}

bool same(const kolsky::Measured& a, const kolsky::Measured& b) {
  return a.value == b.value && a.sd == b.sd;
}

void try_bench(const std::string& text) {
  try {
    kolsky::check(kolsky::parse_bench(text, "f.toml"));
  } catch (const InputError& error) {
    require_clear(error);
  }
}

void try_material(const std::string& text) {
  try {
    const kolsky::Material material = kolsky::parse_material(text, "f.toml");
    const kolsky::Material again =
        kolsky::parse_material(kolsky::format_material(material), "f.toml");
    require(same(material.E1_Pa(), again.E1_Pa()) && same(material.eta2_Pa_s(), again.eta2_Pa_s()));
    require(material.source == again.source);
  } catch (const InputError& error) {
    require_clear(error);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  try_bench(text);
  try_material(text);
  return 0;
}
