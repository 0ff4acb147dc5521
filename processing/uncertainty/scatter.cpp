#include "processing/uncertainty/scatter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace kolsky {

double quantile(std::vector<double>& values, double p) {
  const double index = p * static_cast<double>(values.size() - 1);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::lround(index));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double mean_of(const std::vector<double>& values) {
  double mean = 0.0;
  for (const double value : values) {
    mean += value / static_cast<double>(values.size());
  }
  return mean;
}

double sd_of(const std::vector<double>& values) {
  const double mean = mean_of(values);
  double squares = 0.0;
  for (const double value : values) {
    squares += (value - mean) * (value - mean);
  }
  return values.size() > 1 ? std::sqrt(squares / static_cast<double>(values.size() - 1)) : 0.0;
}

void free_of_noise_added(UncertainFigure& figure, const std::vector<double>& noisier) {
  const double sign = figure.value < 0.0 ? -1.0 : 1.0;
  const double lifted = sign * (mean_of(noisier) - figure.value);
  figure.lifted_by_noise = (1.0 + std::numbers::sqrt2) * std::max(0.0, lifted);
  const double nearest_zero =
      sign * figure.value - figure.lifted_by_noise - kDeviationsOf95 * figure.sd;
  if (sign > 0.0) {
    figure.low = std::min(figure.low, nearest_zero);
  } else {
    figure.high = std::max(figure.high, -nearest_zero);
  }
}

UncertainFigure uncertain_figure(std::string name, double value, std::vector<double> draws) {
  UncertainFigure figure{std::move(name), value, sd_of(draws), 0.0, 0.0};
  figure.low = quantile(draws, kLow);
  figure.high = quantile(draws, kHigh);
  return figure;
}

}  // namespace kolsky
