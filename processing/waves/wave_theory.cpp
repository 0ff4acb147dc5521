#include "processing/waves/wave_theory.hpp"

#include "processing/base/error.hpp"

namespace kolsky {

WaveTheory wave_theory(const std::string& name) {
  for (const WaveTheory theory : {WaveTheory::elementary, WaveTheory::love, WaveTheory::exact}) {
    if (name == name_of(theory)) {
      return theory;
    }
  }
  throw InputError("dispersion", "\"" + name + "\" is not a wave theory",
                   "give elementary, love or exact");
}

std::string name_of(WaveTheory theory) {
  switch (theory) {
    case WaveTheory::elementary:
      return "elementary";
    case WaveTheory::love:
      return "love";
    case WaveTheory::exact:
      break;
  }
  return "exact";
}

}  // namespace kolsky
