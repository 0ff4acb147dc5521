#include "clients/cli/reports/intervals.hpp"

#include <utility>

namespace kolsky::cli {

JsonObject intervals_json(const std::vector<UncertainFigure>& figures) {
  JsonObject object;
  for (const UncertainFigure& figure : figures) {
    JsonObject interval{
        {"value", figure.value}, {"sd", figure.sd}, {"low", figure.low}, {"high", figure.high}};
    if (figure.lifted_by_noise > 0.0) {
      interval.push_back({"lifted_by_noise", figure.lifted_by_noise});
    }
    object.push_back({figure.name, std::move(interval)});
  }
  return object;
}

}  // namespace kolsky::cli
