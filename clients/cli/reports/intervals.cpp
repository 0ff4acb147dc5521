#include "clients/cli/reports/intervals.hpp"

namespace kolsky::cli {

JsonObject intervals_json(const std::vector<UncertainFigure>& figures) {
  JsonObject object;
  for (const UncertainFigure& figure : figures) {
    object.push_back({figure.name, JsonObject{{"value", figure.value},
                                              {"sd", figure.sd},
                                              {"low", figure.low},
                                              {"high", figure.high}}});
  }
  return object;
}

}  // namespace kolsky::cli
