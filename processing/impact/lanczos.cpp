#include "processing/impact/lanczos.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace kolsky::impact {
namespace {

// Largest eigenvalue of a symmetric tridiagonal matrix, by bisection on Sturm's count.
double largest_of_tridiagonal(const std::vector<double>& diagonal, const std::vector<double>& off) {
  double high = 0.0;
  for (std::size_t i = 0; i < diagonal.size(); ++i) {
    const double before = i > 0 ? std::abs(off[i - 1]) : 0.0;
    const double after = i < off.size() ? std::abs(off[i]) : 0.0;
    high = std::max(high, diagonal[i] + before + after);
  }
  double low = 0.0;
  for (int step = 0; step < 60; ++step) {
    const double guess = 0.5 * (low + high);
    double pivot = 1.0;
    bool one_above = false;
    for (std::size_t i = 0; i < diagonal.size(); ++i) {
      const double coupling = i > 0 ? off[i - 1] * off[i - 1] / pivot : 0.0;
      pivot = guess - diagonal[i] - coupling;
      one_above = one_above || pivot < 0.0;
    }
    (one_above ? low : high) = guess;
  }
  return high;
}

}  // namespace

// Four sums at a time: one alone waits for each of its additions.
double dot(std::span<const double> a, std::span<const double> b) {
  std::array<double, 4> sums{};
  std::size_t i = 0;
  for (; i + 4 <= a.size(); i += 4) {
    for (std::size_t k = 0; k < 4; ++k) {
      sums[k] += a[i + k] * b[i + k];
    }
  }
  for (; i < a.size(); ++i) {
    sums[0] += a[i] * b[i];
  }
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

double largest_eigenvalue(
    std::vector<double> start, int steps,
    const std::function<void(std::span<const double>, std::span<double>)>& apply) {
  std::vector<double>& q = start;
  const double length = std::sqrt(dot(q, q));
  std::for_each(q.begin(), q.end(), [length](double& value) { value /= length; });
  std::vector<double> before(q.size(), 0.0);
  std::vector<double> next(q.size());
  std::vector<double> diagonal;
  std::vector<double> off;
  for (int k = 0; k < steps; ++k) {
    apply(q, next);
    const double along = dot(next, q);
    diagonal.push_back(along);
    const double back = off.empty() ? 0.0 : off.back();
    for (std::size_t i = 0; i < next.size(); ++i) {
      next[i] -= along * q[i] + back * before[i];
    }
    const double coupling = std::sqrt(dot(next, next));
    if (!(coupling > 1e-12 * along) || k + 1 == steps) {
      break;
    }
    off.push_back(coupling);
    before.swap(q);
    for (std::size_t i = 0; i < next.size(); ++i) {
      q[i] = next[i] / coupling;
    }
  }
  return largest_of_tridiagonal(diagonal, off);
}

}  // namespace kolsky::impact
