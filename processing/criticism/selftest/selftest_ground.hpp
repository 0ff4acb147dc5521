#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/criticism/impact/ball_runs.hpp"
#include "processing/criticism/verdict/diagnosis.hpp"

namespace kolsky {

/// What a selftest stands on: measured shots, a model fitted to them, and what plants into them.
/// May be asked by several workers at once, each under its own index.
class SelftestGround {
 public:
  SelftestGround() = default;
  virtual ~SelftestGround() = default;
  SelftestGround(const SelftestGround&) = delete;
  SelftestGround& operator=(const SelftestGround&) = delete;

  /// The shots as they are, by all workers.
  [[nodiscard]] virtual Diagnosis untouched() const = 0;
  /// Other shots of the same bench, by one worker.
  [[nodiscard]] virtual Diagnosis diagnosed(const std::vector<Shot>& shots) const = 0;
  /// Why an effect cannot be planted; empty where it can.
  [[nodiscard]] virtual std::string impossible_because(const EffectUse& use) const = 0;
  [[nodiscard]] virtual std::vector<Shot> planted(const EffectUse& use,
                                                  std::size_t worker) const = 0;
  /// Nothing planted, the noise drawn anew.
  [[nodiscard]] virtual std::vector<Shot> drawn_anew(std::uint64_t seed,
                                                     std::size_t worker) const = 0;
};

/// @param shots, model, workers  outlive it
/// @param meshes  of a ball
/// @throws InputError as read_campaign
[[nodiscard]] std::unique_ptr<SelftestGround> ground_of(const std::vector<Shot>& shots,
                                                        const Model& model, double band_limit_Hz,
                                                        const BallMeshes& meshes,
                                                        const Workers& workers);

}  // namespace kolsky
