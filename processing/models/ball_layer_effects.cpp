#include "processing/models/ball_layer_effects.hpp"

namespace kolsky {

ThreeElementLayer::ThreeElementLayer(const std::string& name, BallLayer BallScene::*layer,
                                     const LayerMaterial& paper)
    : LayerEffect(
          {
              .id = "three-element-" + name,
              .stage = Stage::specimen,
              .definition = "the ball's " + name + ": J = 1/E1 + 1/(E2 + s eta2), rho, nu",
              .reference = "paper, Table 3",
              .kinds = {BenchKind::impact},
              .parameters = {{"E1_Pa", "Pa", paper.E1_Pa, 1e4, 1e13, 1e6, {}},
                             {"E2_Pa", "Pa", paper.E2_Pa, 1e4, 1e14, 1e6, {}},
                             {"eta2_Pa_s", "Pa s", paper.eta2_Pa_s, 1e-3, 1e12, 30.0, {}},
                             {"density_kg_m3", "kg/m3", paper.density_kg_m3, 50.0, 2.5e4, 1.0, {}},
                             {"poisson_ratio", "-", paper.poisson_ratio, 0.0, 0.499, 1e-3, {}}},
              .base = true,
          },
          layer) {}

void ThreeElementLayer::apply(Scene& scene, std::span<const double> values,
                              std::size_t /*gauge*/) const {
  BallLayer& layer = layer_of(scene);
  layer.solid.E1_Pa = values[0];
  layer.solid.E2_Pa = values[1];
  layer.solid.eta2_Pa_s = values[2];
  layer.density_kg_m3 = values[3];
  layer.poisson_ratio = values[4];
}

LayerNonlinearity::LayerNonlinearity(const std::string& name, BallLayer BallScene::*layer)
    : LayerEffect(
          {
              .id = name + "-nonlinearity",
              .stage = Stage::specimen,
              .definition =
                  "instantaneous deviatoric stress x (1 + b strain), equivalent Hencky strain",
              .reference = "docs/methods/effects.md; docs/impact.md",
              .kinds = {BenchKind::impact},
              .parameters = {{"b", "-", 0.0, -2.0, 20.0, 0.1, {}, false, 0.5}},
          },
          layer) {}

void LayerNonlinearity::apply(Scene& scene, std::span<const double> values,
                              std::size_t /*gauge*/) const {
  layer_of(scene).nonlinearity = values[0];
}

LayerSecondRelaxation::LayerSecondRelaxation(const std::string& name, BallLayer BallScene::*layer,
                                             double typical_per_Pa)
    : LayerEffect(
          {
              .id = name + "-second-relaxation",
              .stage = Stage::specimen,
              .definition = "uniaxial J += D / (1 + s tau), in the chosen reading",
              .reference = "docs/methods/effects.md; docs/impact.md",
              .kinds = {BenchKind::impact},
              .parameters = {{"D", "1/Pa", 0.0, 0.0, 1e-6, typical_per_Pa, {}, false, 0.5},
                             {"tau", "s", 0.0, 1e-6, 2e-2, 2e-5, {5e-6, 2e-5, 6e-5, 2e-4, 6e-4}}},
          },
          layer) {}

void LayerSecondRelaxation::apply(Scene& scene, std::span<const double> values,
                                  std::size_t /*gauge*/) const {
  layer_of(scene).solid.relaxations.push_back({values[0], values[1]});
}

}  // namespace kolsky
