#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace kolsky::testing {

/// Lagrange's polynomial through eight neighbouring nodes.
struct Stencil {
  static constexpr std::size_t kPoints = 8;
  std::size_t first = 0;
  std::array<double, kPoints> weight{};
};

/// For a place given in nodes, 0 <= place <= nodes - 1. @pre at least eight nodes
[[nodiscard]] Stencil lagrange_stencil(double place, std::size_t nodes);

/// A history sampled from time 0 on at equal steps, zero before and continued by its last value.
[[nodiscard]] double sample_at(std::span<const double> history, double place);

/// Gauss-Legendre rule with five points over [-1/2, 1/2].
struct GaussRule {
  std::array<double, 5> place;
  std::array<double, 5> weight;
};
[[nodiscard]] const GaussRule& gauss_five();

}  // namespace kolsky::testing
