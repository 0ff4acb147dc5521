#pragma once

#include <Eigen/Core>
#include <vector>

#include "processing/waves/transform.hpp"

namespace kolsky {

/// Steps towards the x for which g(x) = x: of the last steps that combination is taken which would
/// have left least of g(x) - x, were g linear (Anderson 1965; Walker and Ni 2011). Plain steps to
/// a specimen's departure from its law are tens, or run away.
class FixedPoint {
 public:
  /// Forgets all steps. @param places  of x
  void begin(std::size_t places);
  /// Replaces x by what comes next. @param of_x  g(x)
  void step(std::vector<Complex>& x, const std::vector<Complex>& of_x);

 private:
  static constexpr Eigen::Index kDepth = 10;

  Eigen::MatrixXd steps_;     ///< of x, each a column
  Eigen::MatrixXd changes_;   ///< of g(x) - x by these
  Eigen::MatrixXd products_;  ///< of changes, each with each
  Eigen::VectorXd x_, rest_;  ///< the last x, and g(x) - x there
  Eigen::Index taken_ = 0;
};

}  // namespace kolsky
