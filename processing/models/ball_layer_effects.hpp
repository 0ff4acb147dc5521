#pragma once

#include <span>
#include <string>
#include <utility>

#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {

/// What a layer of a ball is made of.
struct LayerMaterial {
  double E1_Pa;
  double E2_Pa;
  double eta2_Pa_s;
  double density_kg_m3;
  double poisson_ratio;
};

/// An effect on one layer of the ball, the core or the cover.
class LayerEffect : public Effect {
 public:
  LayerEffect(EffectAbout about, BallLayer BallScene::*layer)
      : Effect(std::move(about)), layer_(layer) {}

 protected:
  [[nodiscard]] BallLayer& layer_of(Scene& scene) const { return *scene.ball.*layer_; }

 private:
  BallLayer BallScene::*layer_;
};

class ThreeElementLayer final : public LayerEffect {
 public:
  /// @param paper  where a model begins
  ThreeElementLayer(const std::string& name, BallLayer BallScene::*layer,
                    const LayerMaterial& paper);
  void apply(Scene& scene, std::span<const double> values, std::size_t gauge) const override;
};

class LayerNonlinearity final : public LayerEffect {
 public:
  LayerNonlinearity(const std::string& name, BallLayer BallScene::*layer);
  void apply(Scene& scene, std::span<const double> values, std::size_t gauge) const override;
};

class LayerSecondRelaxation final : public LayerEffect {
 public:
  /// @param typical_per_Pa  a tenth or so of the layer's own compliance
  LayerSecondRelaxation(const std::string& name, BallLayer BallScene::*layer,
                        double typical_per_Pa);
  void apply(Scene& scene, std::span<const double> values, std::size_t gauge) const override;
};

}  // namespace kolsky
