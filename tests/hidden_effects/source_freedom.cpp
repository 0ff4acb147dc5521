#include "tests/hidden_effects/source_freedom.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

namespace kolsky::scoring {

SourceFreedom::SourceFreedom(std::vector<std::vector<double>> responses, std::vector<double> offset,
                             std::size_t samples, std::ptrdiff_t first, std::size_t stride,
                             double scale)
    : responses_(std::move(responses)),
      offset_(std::move(offset)),
      samples_(static_cast<std::ptrdiff_t>(samples)),
      first_(first),
      stride_(static_cast<std::ptrdiff_t>(stride)),
      bells_((samples_ - first_ + stride_ - 1) / stride_) {
  const Eigen::Index size = bells_ + static_cast<Eigen::Index>(responses_.size());
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(size, size);
  fill_normal(normal);
  // No bell is more than some thirty pulses high: keeps what nobody sees from being free.
  normal.diagonal().head(bells_).array() += 1.0 / (900.0 * scale * scale);
  normal.diagonal().tail(size - bells_).array() += 1e-6;
  factor_ = normal.llt().matrixL();
}

void SourceFreedom::fill_normal(Eigen::MatrixXd& normal) const {
  const auto start = [this](Eigen::Index k) { return first_ + k * stride_; };
  for (std::size_t g = 0; g < responses_.size(); ++g) {
    const double* const h = responses_[g].data();
    const auto length = static_cast<std::ptrdiff_t>(responses_[g].size());
    std::vector<double> sums(static_cast<std::size_t>(length) + 1, 0.0);
    for (Eigen::Index apart = 0; apart < bells_; ++apart) {
      const std::ptrdiff_t shift = apart * stride_;
      for (std::ptrdiff_t j = 0; j < length; ++j) {
        const double product = j + shift < length ? h[j] * h[j + shift] : 0.0;
        sums[static_cast<std::size_t>(j) + 1] = sums[static_cast<std::size_t>(j)] + product;
      }
      for (Eigen::Index k = apart; k < bells_; ++k) {
        const std::ptrdiff_t low = std::max<std::ptrdiff_t>(0, -start(k));
        const std::ptrdiff_t high = std::min(samples_ - start(k), length);
        if (high <= low) {
          continue;
        }
        const double sum =
            sums[static_cast<std::size_t>(high)] - sums[static_cast<std::size_t>(low)];
        normal(k, k - apart) += sum;
      }
    }
    const Eigen::Index column = bells_ + static_cast<Eigen::Index>(g);
    for (Eigen::Index k = 0; k < bells_; ++k) {
      for (std::ptrdiff_t n = std::max<std::ptrdiff_t>(0, start(k));
           n < std::min(samples_, start(k) + length); ++n) {
        normal(column, k) += h[n - start(k)] * offset_[static_cast<std::size_t>(n)];
      }
    }
    for (const double value : offset_) {
      normal(column, column) += value * value;
    }
  }
  normal.triangularView<Eigen::StrictlyUpper>() =
      normal.triangularView<Eigen::StrictlyLower>().transpose();
}

Eigen::VectorXd SourceFreedom::onto_unknowns(
    const std::vector<std::vector<double>>& direction) const {
  Eigen::VectorXd out =
      Eigen::VectorXd::Zero(bells_ + static_cast<Eigen::Index>(responses_.size()));
  for (std::size_t g = 0; g < responses_.size(); ++g) {
    const double* const h = responses_[g].data();
    const auto length = static_cast<std::ptrdiff_t>(responses_[g].size());
    const double* const v = direction[g].data();
    for (Eigen::Index k = 0; k < bells_; ++k) {
      const std::ptrdiff_t start = first_ + k * stride_;
      double sum = 0.0;
      for (std::ptrdiff_t n = std::max<std::ptrdiff_t>(0, start);
           n < std::min(samples_, start + length); ++n) {
        sum += h[n - start] * v[n];
      }
      out[k] += sum;
    }
    for (std::ptrdiff_t n = 0; n < samples_; ++n) {
      out[bells_ + static_cast<Eigen::Index>(g)] += offset_[static_cast<std::size_t>(n)] * v[n];
    }
  }
  return out;
}

std::vector<std::vector<double>> SourceFreedom::remainder(
    std::vector<std::vector<double>> direction) const {
  Eigen::VectorXd unknowns = onto_unknowns(direction);
  factor_.triangularView<Eigen::Lower>().solveInPlace(unknowns);
  factor_.triangularView<Eigen::Lower>().transpose().solveInPlace(unknowns);
  for (std::size_t g = 0; g < responses_.size(); ++g) {
    const double* const h = responses_[g].data();
    const auto length = static_cast<std::ptrdiff_t>(responses_[g].size());
    double* const v = direction[g].data();
    for (Eigen::Index k = 0; k < bells_; ++k) {
      const std::ptrdiff_t start = first_ + k * stride_;
      for (std::ptrdiff_t n = std::max<std::ptrdiff_t>(0, start);
           n < std::min(samples_, start + length); ++n) {
        v[n] -= unknowns[k] * h[n - start];
      }
    }
    for (std::ptrdiff_t n = 0; n < samples_; ++n) {
      v[n] -=
          unknowns[bells_ + static_cast<Eigen::Index>(g)] * offset_[static_cast<std::size_t>(n)];
    }
  }
  return direction;
}

Eigen::MatrixXd SourceFreedom::remaining_products(
    const std::vector<const std::vector<std::vector<double>>*>& directions) const {
  const auto count = static_cast<Eigen::Index>(directions.size());
  const auto rows = samples_ * static_cast<std::ptrdiff_t>(responses_.size());
  Eigen::MatrixXd seen(rows, count);
  Eigen::MatrixXd onto(bells_ + static_cast<Eigen::Index>(responses_.size()), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto& direction = *directions[static_cast<std::size_t>(i)];
    for (std::size_t g = 0; g < direction.size(); ++g) {
      seen.col(i).segment(static_cast<Eigen::Index>(g) * samples_, samples_) =
          Eigen::Map<const Eigen::VectorXd>(direction[g].data(), samples_);
    }
    onto.col(i) = onto_unknowns(direction);
  }
  factor_.triangularView<Eigen::Lower>().solveInPlace(onto);
  return seen.transpose() * seen - onto.transpose() * onto;
}

}  // namespace kolsky::scoring
