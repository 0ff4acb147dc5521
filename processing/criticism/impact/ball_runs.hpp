#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "processing/base/bench.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {

/// What an impact gives, as the comparison needs it.
struct BallRun {
  std::vector<double> force_N;  ///< from first touch, kRunStep_s apart, to the end of the contact
  double rebound_m_per_s = 0.0;
  double strained_share = 0.0;  ///< of the core: beyond a strain of 0.1 at the turn
  double falling_share = 0.0;   ///< of the core or the cover: where its law's stress falls
};

constexpr double kRunStep_s = 1e-6;

/// Meshes of the ball [elements, about]: derivatives cost the coarse one, the model stands on the
/// fine one, and the middle one shows what the fine one may still be off by.
struct BallMeshes {
  std::size_t coarse = 512;
  std::size_t middle = 2048;
  std::size_t fine = 8192;
};

/// Of the law at finite strain: a mixture of the two is made of impacts with either.
enum class LawForm { kirchhoff, cauchy };

/// Impacts on one bench, each calculated once: a fit comes back to the same numbers, and effects of
/// the sensors leave the ball alone. May be asked by several workers at once.
class BallRuns {
 public:
  /// @param bench  outlives this
  explicit BallRuns(const Bench& bench) : bench_(bench) {}

  /// @param form  the scene's share of it is not looked at
  /// @throws InputError what the solver refuses, place the effect, with the speed
  [[nodiscard]] std::shared_ptr<const BallRun> run(const BallScene& ball, double speed_m_per_s,
                                                   std::size_t elements,
                                                   LawForm form = LawForm::kirchhoff);

 private:
  const Bench& bench_;
  std::mutex lock_;
  std::map<std::vector<double>, std::shared_ptr<const BallRun>> known_;
};

/// a + share b, ended where the longer one ends.
[[nodiscard]] BallRun sum_of(const BallRun& a, double share, const BallRun& b);

}  // namespace kolsky
