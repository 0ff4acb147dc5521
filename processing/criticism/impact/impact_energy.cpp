#include "processing/criticism/impact/impact_energy.hpp"

#include <algorithm>

#include "processing/algebra/algebra.hpp"

namespace kolsky {

namespace {

/// How a shot's own arrival and its gauges' offsets move its residuals.
Eigen::MatrixXd free_of(const ImpactShape& shape, Eigen::Index size, Eigen::Index samples) {
  const Eigen::Index gauges = size / samples;
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(size, 1 + gauges);
  columns.col(0) = shape.by_time.head(size);
  for (Eigen::Index j = 0; j < gauges; ++j) {
    columns.col(1 + j).segment(j * samples, samples).setOnes();
  }
  return columns;
}

}  // namespace

ImpactEnergy::ImpactEnergy(const ImpactRecords& records, const std::vector<ImpactShape>& shapes,
                           const Eigen::MatrixXd& noise, const Eigen::MatrixXd& inverse,
                           double speed_sd)
    : records_(records) {
  const Eigen::Index size = noise.rows();
  const auto samples = static_cast<Eigen::Index>(records.window.samples);
  for (std::size_t g = 0; g < shapes.size(); ++g) {
    const Eigen::MatrixXd columns = free_of(shapes[g], size, samples);
    const Eigen::MatrixXd weighted = inverse * columns;
    weight_.emplace_back(inverse - weighted * symmetric_inverse(columns.transpose() * weighted) *
                                       weighted.transpose());
    const Eigen::VectorXd by_speed = speed_sd * shapes[g].by_speed.head(size);
    const auto left = static_cast<double>(size - columns.cols());
    expected_.push_back(left + by_speed.dot(weight_.back() * by_speed));
    noise_ += left * static_cast<double>(records.groups[g].shots.size());
  }
  for (const std::vector<double>& judged : records.judged) {
    const Eigen::Map<const Eigen::VectorXd> y(judged.data(), size);
    signal_ += y.dot(inverse * y);
  }
}

double ImpactEnergy::repeated(const Eigen::VectorXd& means) const {
  const auto groups = static_cast<Eigen::Index>(weight_.size());
  double energy = 0.0;
  for (Eigen::Index g = 0; g < groups; ++g) {
    const auto own = static_cast<std::size_t>(g);
    const Eigen::VectorXd mean = means.segment(g * (means.size() / groups), weight_[own].rows());
    energy +=
        static_cast<double>(records_.groups[own].shots.size()) * mean.dot(weight_[own] * mean) -
        expected_[own];
  }
  return std::max(0.0, energy);
}

}  // namespace kolsky
