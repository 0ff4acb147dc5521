#pragma once

#include <vector>

namespace kolsky::scoring {

/// A filter that makes noise white, of unit variance: out[n] = (in[n] - sum a_k in[n-k])/sigma.
class Whitening {
 public:
  /// For white noise.
  explicit Whitening(double sigma) : sigma_(sigma) {}
  /// Fitted to samples of the noise by Levinson's recursion.
  Whitening(const std::vector<std::vector<double>>& noise_samples, std::size_t order);

  [[nodiscard]] std::vector<double> operator()(const std::vector<double>& record) const;

 private:
  double sigma_;
  std::vector<double> coefficient_;
};

}  // namespace kolsky::scoring
