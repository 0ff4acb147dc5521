#include "processing/criticism/verdict/at_bounds.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "processing/base/range.hpp"

namespace kolsky {

std::vector<AtBound> numbers_at_bounds(const Model& fitted) {
  constexpr double kThere = 1e-3;  // of the bound itself
  std::vector<AtBound> list;
  for (const EffectUse& use : fitted.effects) {
    for (std::size_t p = 0; p < use.values.size(); ++p) {
      const ModelValue& own = use.values[p];
      const EffectParameter& parameter = use.effect->about().parameters[p];
      // A free or a fixed end is the least or most that an end may be: of what is no strength,
      // times alone have no end by nature.
      const bool endless = !parameter.auxiliary() || parameter.unit == "s";
      if (!own.free || use.per_shot || parameter.is_switch || !endless) {
        continue;
      }
      const std::array<double, 2> bounds =
          own.bounds.value_or(std::array{parameter.lower, parameter.upper});
      for (const double bound : bounds) {
        const bool null = !parameter.auxiliary() && bound == parameter.null_value;
        if (!null && std::abs(own.value - bound) <= kThere * std::abs(bound)) {
          list.push_back({use.id(), parameter.name, own.value, parameter.unit, bound == bounds[1],
                          parameter.auxiliary()});
        }
      }
    }
  }
  return list;
}

std::string in_words(const AtBound& number) {
  return fmt::format(
      "{}: {} = {} is the {} that it may be; the records may ask for {}, and deviations beside it "
      "hold for that alone",
      number.effect, number.parameter,
      in_words(number.value, number.unit == "-" ? "" : number.unit), number.most ? "most" : "least",
      number.most ? "more" : "less");
}

}  // namespace kolsky
