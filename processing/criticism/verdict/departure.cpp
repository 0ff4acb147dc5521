#include "processing/criticism/verdict/departure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "processing/models/scene.hpp"

namespace kolsky {

namespace {

/// Where strains that go with strain or stress level off, of the campaign's largest.
constexpr std::array kLevels{0.05, 0.3};
constexpr std::size_t kFunctions = 2 * (kLevels.size() + 2);
constexpr std::array kRelaxations_s{1e-5, 5e-5, 3e-4};

std::vector<EffectParameter> strengths() {
  std::vector<EffectParameter> list;
  for (std::size_t i = 0; i < kFunctions + kRelaxations_s.size(); ++i) {
    list.push_back({"c" + std::to_string(i), "-", 0.0, -1.0, 1.0, 0.1, {}});
  }
  return list;
}

/// @param x     strain or stress, in strain
/// @param most  largest of the campaign
void add_functions(const std::vector<double>& x, double most,
                   std::vector<std::vector<double>>& functions) {
  std::vector<double> own(x.size());
  for (const double level : kLevels) {
    std::ranges::transform(
        x, own.begin(), [&](double now) { return now / (1.0 + std::abs(now) / (level * most)); });
    functions.push_back(own);
  }
  std::ranges::transform(x, own.begin(), [&](double now) { return now * std::abs(now) / most; });
  functions.push_back(own);
  double so_far = 0.0;
  std::ranges::transform(x, own.begin(), [&](double now) {
    so_far = std::max(so_far, now);
    return so_far - now;
  });
  functions.push_back(own);
}

}  // namespace

Departure::Departure(Study& study, const Studied& studied)
    : Effect({
          .id = "departure",
          .stage = Stage::specimen,
          .definition = "strain += sum of functions of strain and of stress, and relaxations",
          .reference = "",
          .kinds = {BenchKind::shpb},
          .parameters = strengths(),
          .shot_facts = true,
          .base = true,
      }) {
  std::vector<SpecimenHistories> shots;
  double most_strain = std::numeric_limits<double>::min();
  double most_stress_Pa = std::numeric_limits<double>::min();
  for (std::size_t n = 0; n < study.campaign().shots.size(); ++n) {
    shots.push_back(
        study.residuals().specimen_histories(studied.composition, studied.fit.theta, n));
    most_strain = std::max(most_strain, std::ranges::max(shots.back().strain));
    most_stress_Pa = std::max(most_stress_Pa, std::ranges::max(shots.back().stress_Pa));
  }
  for (SpecimenHistories& shot : shots) {
    for (double& stress : shot.stress_Pa) {
      stress *= most_strain / most_stress_Pa;
    }
    strains_.emplace_back();
    add_functions(shot.strain, most_strain, strains_.back());
    add_functions(shot.stress_Pa, most_strain, strains_.back());
  }
}

void Departure::apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const {
  SpecimenScene& specimen = *scene.specimen;
  const std::vector<History>& strains = strains_[scene.facts->shot];
  specimen.further_strain.assign(strains.front().size(), 0.0);
  for (std::size_t i = 0; i < strains.size(); ++i) {
    for (std::size_t n = 0; values[i] != 0.0 && n < strains[i].size(); ++n) {
      specimen.further_strain[n] += values[i] * strains[i][n];
    }
  }
  for (std::size_t i = 0; i < kRelaxations_s.size(); ++i) {
    specimen.solid.relaxations.push_back(
        {values[kFunctions + i] / specimen.solid.E1_Pa, kRelaxations_s[i]});
  }
}

}  // namespace kolsky
