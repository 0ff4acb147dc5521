#include "processing/models/material_effects.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "processing/algebra/algebra.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

constexpr const char* kAnother =
    "give a file of three-element or two-kelvin, as `kolsky identify --solid` writes it";

std::vector<Eigen::Index> other_places(SolidKind solid) {
  const auto own = three_element_places(solid);
  std::vector<Eigen::Index> others;
  for (std::size_t i = 0; i < parameters_of(solid).size(); ++i) {
    if (std::find(own.begin(), own.end(), i) == own.end()) {
      others.push_back(static_cast<Eigen::Index>(i));
    }
  }
  return others;
}

/// A covariance in shares of the numbers, without which sizes of pascals and exponents would meet.
Eigen::MatrixXd relative_covariance(const Material& material) {
  const auto count = static_cast<Eigen::Index>(material.parameters.size());
  Eigen::MatrixXd relative(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < count; ++j) {
      relative(i, j) = (*material.covariance)[static_cast<std::size_t>(i * count + j)] /
                       (material.parameters[static_cast<std::size_t>(i)] *
                        material.parameters[static_cast<std::size_t>(j)]);
    }
  }
  return relative;
}

/// Of the three elements, the others being known: S11 - S12 S22^-1 S21.
Eigen::Matrix3d left_of_covariance(const Material& material) {
  const Eigen::MatrixXd all = relative_covariance(material);
  const auto places = three_element_places(material.solid);
  const std::vector<Eigen::Index> own(places.begin(), places.end());
  const std::vector<Eigen::Index> others = other_places(material.solid);
  const Eigen::MatrixXd across = all(others, own);
  return all(own, own) - across.transpose() * symmetric_inverse(all(others, others)) * across;
}

EffectUse held(const std::string& id, const std::vector<double>& values) {
  EffectUse use = use_named(id);
  const auto& parameters = use.effect->about().parameters;
  for (std::size_t p = 0; p < values.size(); ++p) {
    use.values[p].value = values[p];
    use.values[p].free = false;
    if (values[p] < parameters[p].lower || values[p] > parameters[p].upper) {
      throw InputError("solid",
                       "has a branch that " + id + " does not take: its " + parameters[p].name +
                           " would be out of bounds",
                       kAnother);
    }
  }
  return use;
}

}  // namespace

std::array<std::size_t, 3> three_element_places(SolidKind solid) {
  // A fluid's second number is the dashpot in line.
  return solid == SolidKind::four_element_fluid ? std::array<std::size_t, 3>{0, 2, 3}
                                                : std::array<std::size_t, 3>{0, 1, 2};
}

Material three_elements_of(const Material& material) {
  if (material.solid == SolidKind::three_element) {
    return material;
  }
  Material three = material;
  three.solid = SolidKind::three_element;
  three.parameters.clear();
  for (const std::size_t place : three_element_places(material.solid)) {
    three.parameters.push_back(material.parameters[place]);
  }
  if (!material.covariance) {
    return three;
  }
  const Eigen::Matrix3d left = left_of_covariance(material);
  three.covariance.emplace();
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Eigen::Index j = 0; j < 3; ++j) {
      three.covariance->push_back(left(i, j) * three.parameters[static_cast<std::size_t>(i)] *
                                  three.parameters[static_cast<std::size_t>(j)]);
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    three.parameters[i].sd = std::sqrt((*three.covariance)[4 * i]);
  }
  return three;
}

std::optional<EffectUse> further_effect(const Material& material, const std::string& part) {
  const std::vector<double> p = values_of(material.parameters);
  switch (material.solid) {
    case SolidKind::three_element:
      return std::nullopt;
    case SolidKind::two_kelvin:
      return held(part + "second-relaxation", {1.0 / p[3], p[4] / p[3]});
    case SolidKind::four_element_fluid:
      if (part.empty()) {
        return held("series-dashpot", {1.0 / p[1]});
      }
      break;
    case SolidKind::fractional:
      if (part.empty()) {
        return held("fractional-damping", {p[3]});
      }
      break;
    case SolidKind::three_kelvin:
    case SolidKind::four_kelvin:
      break;
  }
  throw InputError(
      "solid",
      "is " + name_of(material.solid) + ", and no effect is what that has more than three elements",
      kAnother);
}

void add_behind(const std::string& base, EffectUse further, Model& model) {
  const auto own = std::ranges::find_if(
      model.effects, [&](const EffectUse& use) { return use.effect->about().id == base; });
  model.effects.insert(own == model.effects.end() ? own : own + 1, std::move(further));
}

void require_for_all_bars(const EffectUse& further, const Material& material, const Bench& bench) {
  // A fractional branch is none where there is no branch.
  const bool on_elastic_bars = further.effect->about().id != "fractional-damping";
  const bool one_elastic = bench.output && bench.input.youngs_modulus_Pa.has_value() !=
                                               bench.output->youngs_modulus_Pa.has_value();
  if (on_elastic_bars && one_elastic) {
    throw InputError("solid",
                     "is " + name_of(material.solid) + ", and " + further.effect->about().id +
                         " would act on the bench's elastic bar, too",
                     "give a file of three elements");
  }
}

}  // namespace kolsky
