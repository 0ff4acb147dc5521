#include "processing/uncertainty/scatter.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kolsky {

double quantile(std::vector<double>& values, double p) {
  const double index = p * static_cast<double>(values.size() - 1);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::lround(index));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double sd_of(const std::vector<double>& values) {
  double mean = 0.0;
  for (const double value : values) {
    mean += value / static_cast<double>(values.size());
  }
  double squares = 0.0;
  for (const double value : values) {
    squares += (value - mean) * (value - mean);
  }
  return values.size() > 1 ? std::sqrt(squares / static_cast<double>(values.size() - 1)) : 0.0;
}

void reach_as_far_down(UncertainFigure& figure) {
  if (figure.value >= 0.0) {
    figure.low = std::min(figure.low, 2.0 * figure.value - figure.high);
  } else {
    figure.high = std::max(figure.high, 2.0 * figure.value - figure.low);
  }
}

UncertainFigure uncertain_figure(std::string name, double value, std::vector<double> draws) {
  UncertainFigure figure{std::move(name), value, sd_of(draws), 0.0, 0.0};
  figure.low = quantile(draws, kLow);
  figure.high = quantile(draws, kHigh);
  return figure;
}

}  // namespace kolsky
