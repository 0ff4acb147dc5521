#pragma once

#include <Eigen/Core>
#include <vector>

#include "tests/generators/bar_world.hpp"

namespace kolsky::scoring {

/// A shot's own unknowns, the bells of its source and an offset per gauge, taken out of whatever
/// is seen in its records. The normal matrix follows from prefix sums, since bells are shifted
/// copies.
class SourceFreedom {
 public:
  /// @param responses  whitened answer of each gauge to a bell that begins at sample 0, per sample
  /// @param offset     whitened constant of one, per sample
  /// @param first      sample at which the first bell begins (negative: before the record)
  SourceFreedom(std::vector<std::vector<double>> responses, std::vector<double> offset,
                std::size_t samples, std::ptrdiff_t first, std::size_t stride, double scale);

  /// What remains of the products between directions of one shot, each [gauge][sample], whitened.
  [[nodiscard]] Eigen::MatrixXd remaining_products(
      const std::vector<const std::vector<std::vector<double>>*>& directions) const;
  /// What remains of one direction itself.
  [[nodiscard]] std::vector<std::vector<double>> remainder(
      std::vector<std::vector<double>> direction) const;
  /// The whitened constant of one.
  [[nodiscard]] const std::vector<double>& offset() const { return offset_; }

 private:
  [[nodiscard]] Eigen::VectorXd onto_unknowns(
      const std::vector<std::vector<double>>& direction) const;
  void fill_normal(Eigen::MatrixXd& normal) const;

  std::vector<std::vector<double>> responses_;
  std::vector<double> offset_;
  std::ptrdiff_t samples_, first_, stride_;
  Eigen::Index bells_;
  Eigen::MatrixXd factor_;
};

}  // namespace kolsky::scoring
