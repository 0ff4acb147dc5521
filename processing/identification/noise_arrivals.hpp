#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "processing/waves/transform.hpp"

namespace kolsky {

/// When noise of a bar's first gauge shows at the others by way of the model, which takes it for a
/// wave: as that wave passes them, comes back from the far end, and so on from turn to turn. What
/// is judged begins and ends in between, so that each moment's noise has arrivals of its own in it.
class NoiseArrivals {
 public:
  struct Times {
    std::vector<double> first_s{};  ///< from the first gauge to each other
    std::vector<double> back_s{};  ///< from each of them to the far end and back; empty: none comes
    double turn_s = 0.0;           ///< from the first gauge to the far end and back
    double lead_s = 0.0;           ///< of record before what is judged
    double judged_s = 0.0;
  };
  explicit NoiseArrivals(const Times& times);

  /// What the first gauge's noise in a bin shows at the others, over its moments.
  struct Shown {
    Eigen::MatrixXcd mean_square;  ///< of all moments, over those that are judged
    Eigen::VectorXcd mean;         ///< of the moments that are judged
  };
  /// @param first  passages to each other gauge
  /// @param back  by the far end to each other gauge, of what passed it
  /// @param turn  by the far end to the first gauge, sent on from there
  [[nodiscard]] Shown shown(std::span<const Complex> first, std::span<const Complex> back,
                            Complex turn) const;

 private:
  /// One of a gauge's, which counts from one moment to another.
  struct Arrival {
    Eigen::Index gauge = 0;
    std::size_t turns = 0;
    bool back = false;
    double late_s = 0.0;
  };
  /// From one moment on, going back in time: whether an arrival begins or ends to fall into what
  /// is judged.
  struct Change {
    double moment_s = 0.0;
    std::size_t arrival = 0;
    double sign = 1.0;
  };

  std::vector<Arrival> arrivals_;
  std::vector<Change> changes_;  ///< latest first
  std::size_t most_turns_ = 0;
  double lead_s_, judged_s_;
};

}  // namespace kolsky
