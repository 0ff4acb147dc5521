#include "tests/hidden_effects/whitening.hpp"

#include <algorithm>
#include <cmath>

namespace kolsky::scoring {

namespace {

std::vector<double> autocovariance(const std::vector<std::vector<double>>& records,
                                   std::size_t order) {
  std::vector<double> covariance(order + 1, 0.0);
  double count = 0.0;
  for (const auto& record : records) {
    for (std::size_t lag = 0; lag <= order; ++lag) {
      for (std::size_t n = lag; n < record.size(); ++n) {
        covariance[lag] += record[n] * record[n - lag];
      }
    }
    count += static_cast<double>(record.size());
  }
  for (double& value : covariance) {
    value /= count;
  }
  return covariance;
}

}  // namespace

Whitening::Whitening(const std::vector<std::vector<double>>& noise_samples, std::size_t order) {
  const std::vector<double> r = autocovariance(noise_samples, order);
  std::vector<double> a;
  double error = r[0];
  for (std::size_t k = 1; k <= order; ++k) {
    double next = r[k];
    for (std::size_t i = 0; i < a.size(); ++i) {
      next -= a[i] * r[k - 1 - i];
    }
    const double reflection = next / error;
    std::vector<double> updated = a;
    for (std::size_t i = 0; i < a.size(); ++i) {
      updated[i] -= reflection * a[a.size() - 1 - i];
    }
    updated.push_back(reflection);
    a = std::move(updated);
    error *= 1.0 - reflection * reflection;
  }
  sigma_ = std::sqrt(error);
  coefficient_ = std::move(a);
}

std::vector<double> Whitening::operator()(const std::vector<double>& record) const {
  std::vector<double> out(record.size());
  for (std::size_t n = 0; n < record.size(); ++n) {
    double value = record[n];
    for (std::size_t k = 0; k < std::min(n, coefficient_.size()); ++k) {
      value -= coefficient_[k] * record[n - 1 - k];
    }
    out[n] = value / sigma_;
  }
  return out;
}

}  // namespace kolsky::scoring
