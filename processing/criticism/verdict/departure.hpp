#pragma once

#include <vector>

#include "processing/criticism/fitting/study.hpp"
#include "processing/models/effect.hpp"

namespace kolsky {

/// Departures of a specimen from its law that fit nearly any and name none: strains beside the
/// model's that go with strain and stress, straight at first and then less so or ever more, that
/// stay when either is taken back, and slower relaxations. Like the sensors' distortions
/// (distortion.hpp) they show that something is missing, not what.
class Departure final : public Effect {
 public:
  /// @param studied  fitted last, to split bars
  Departure(Study& study, const Studied& studied);

  void apply(Scene& scene, std::span<const double> values, std::size_t gauge) const override;

 private:
  using History = std::vector<double>;
  std::vector<std::vector<History>> strains_;  ///< by shot and function
};

}  // namespace kolsky
