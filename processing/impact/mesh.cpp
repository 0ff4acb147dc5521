#include "processing/impact/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include "processing/base/error.hpp"
#include "processing/impact/element_kernel.hpp"

namespace kolsky::impact {
namespace {

constexpr double kBulge = 0.5;  // of the inner square: 0 straight sides, 1 a circle
constexpr double kMiddle = 0.5 * (std::numbers::sqrt2 / 2.0 + 1.0);  // of its side, by that bulge
constexpr double kPoleGrading =
    0.25;  // edges at the struck pole are this much shorter than the mean
constexpr std::size_t kLeastRings = 4;
constexpr std::size_t kLeastCoreRings = 2;

struct Point {
  double R;
  double Z;
};

// From the square [0, 1] x [-1, 1] to one with bulged sides inside the unit circle.
Point rounded(double x, double y) {
  const double straight = (1.0 - kBulge) / std::numbers::sqrt2;
  return {straight * x + kBulge * x * std::sqrt(1.0 - 0.5 * y * y),
          straight * y + kBulge * y * std::sqrt(1.0 - 0.5 * x * x)};
}

Block& add_block(Mesh& mesh, std::size_t columns, std::size_t rows) {
  const std::size_t gap = columns + 2 + kMostLanes;
  const std::size_t first = mesh.R_m.size() + gap;
  const Block block{first, columns, rows};
  mesh.R_m.resize(first + block.nodes() + gap, 0.0);
  mesh.Z_m.resize(mesh.R_m.size(), 0.0);
  return mesh.blocks.emplace_back(block);
}

void place(Mesh& mesh, std::size_t node, Point point) {
  mesh.R_m[node] = point.R;
  mesh.Z_m[node] = point.Z;
}

// How many rings each layer has.
struct Pattern {
  std::size_t n = 0;
  std::vector<std::size_t> rings;
};

// Of the inner square, n x 2n.
std::size_t square_for(std::size_t elements) {
  const auto n =
      static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(elements) / 8.0)));
  return std::max<std::size_t>(n, 2);
}

std::size_t rings_for(std::size_t elements) {
  const std::size_t n = square_for(elements);
  return (elements - std::min(2 * n * n, elements)) / (4 * n);
}

std::size_t least_rings(std::size_t layers) {
  return kLeastCoreRings + kLeastRings * (layers - 1);
}

Pattern pattern_for(std::span<const double> diameters_m, std::size_t elements) {
  Pattern pattern;
  pattern.n = square_for(elements);
  const std::size_t all = rings_for(elements);
  if (all < least_rings(diameters_m.size())) {
    throw InputError("elements", std::to_string(elements) + " are too few for the ball's layers",
                     "give at least " + std::to_string(least_elements(diameters_m.size())) +
                         ": every shell needs four rings");
  }
  std::size_t left = all;
  pattern.rings.resize(diameters_m.size());
  for (std::size_t layer = diameters_m.size(); layer-- > 1;) {
    const double share =
        (diameters_m[layer] - diameters_m[layer - 1]) / (0.72 * diameters_m.back());
    const auto wanted = static_cast<std::size_t>(std::lround(share * static_cast<double>(all)));
    const std::size_t keep = least_rings(layer);
    pattern.rings[layer] = std::clamp(wanted, kLeastRings, left - keep);
    left -= pattern.rings[layer];
  }
  pattern.rings[0] = left;
  return pattern;
}

// Direction from the centre of the k-th spoke of 4n, shorter steps at the struck pole.
double spoke_angle(std::size_t k, std::size_t n) {
  const double t = static_cast<double>(k) / static_cast<double>(4 * n);
  return std::numbers::pi * t -
         kPoleGrading * std::numbers::pi * std::sin(std::numbers::pi * t) / std::numbers::pi;
}

// Place on the square's outline where the k-th spoke begins: (i, j) in its block.
std::pair<std::size_t, std::size_t> outline(std::size_t k, std::size_t n) {
  if (k <= n) {
    return {k, 0};
  }
  return k <= 3 * n ? std::pair{n, k - n} : std::pair{4 * n - k, 2 * n};
}

void fill_square(Mesh& mesh, const Block& block, double scale_m, double radius_m) {
  const std::size_t n = block.columns;
  for (std::size_t j = 0; j <= block.rows; ++j) {
    for (std::size_t i = 0; i <= n; ++i) {
      const Point p = rounded(static_cast<double>(i) / static_cast<double>(n),
                              static_cast<double>(j) / static_cast<double>(n) - 1.0);
      place(mesh, block.node(i, j), {scale_m * p.R, radius_m + scale_m * p.Z});
    }
    mesh.axis.push_back(block.node(0, j));
  }
}

void fill_rings(Mesh& mesh, const Block& square, const Block& ring, const Pattern& pattern,
                std::span<const double> diameters_m) {
  const double radius_m = 0.5 * diameters_m.back();
  for (std::size_t k = 0; k <= ring.columns; ++k) {
    const auto [i, j] = outline(k, pattern.n);
    const std::size_t foot = square.node(i, j);
    const double angle = spoke_angle(k, pattern.n);
    const bool on_axis = k == 0 || k == ring.columns;
    const Point direction{on_axis ? 0.0 : std::sin(angle), -std::cos(angle)};
    Point from{mesh.R_m[foot], mesh.Z_m[foot]};
    std::size_t row = 0;
    for (std::size_t layer = 0; layer < diameters_m.size(); ++layer) {
      const double outer_m = 0.5 * diameters_m[layer];
      const Point to{outer_m * direction.R, radius_m + outer_m * direction.Z};
      const std::size_t rings = pattern.rings[layer];
      for (std::size_t s = 0; s <= rings; ++s) {
        const double t = static_cast<double>(s) / static_cast<double>(rings);
        place(mesh, ring.node(k, row + s),
              {from.R + t * (to.R - from.R), from.Z + t * (to.Z - from.Z)});
      }
      row += rings;
      from = to;
    }
    mesh.ties.push_back({foot, ring.node(k, 0)});
    mesh.surface.push_back(ring.node(k, ring.rows));
  }
  for (std::size_t j = 0; j <= ring.rows; ++j) {
    mesh.axis.push_back(ring.node(0, j));
    mesh.axis.push_back(ring.node(ring.columns, j));
  }
}

// Of the body of revolution inside the outline.
double volume_inside(const Mesh& mesh) {
  double volume = 0.0;
  for (std::size_t k = 0; k + 1 < mesh.surface.size(); ++k) {
    const double a = mesh.R_m[mesh.surface[k]];
    const double b = mesh.R_m[mesh.surface[k + 1]];
    volume += std::numbers::pi / 3.0 * (a * a + a * b + b * b) *
              (mesh.Z_m[mesh.surface[k + 1]] - mesh.Z_m[mesh.surface[k]]);
  }
  return volume;
}

// Straight edges cut the sphere's volume; the mesh is as much larger as gives it back.
void restore_volume(Mesh& mesh, double diameter_m) {
  const double wanted = std::numbers::pi / 6.0 * diameter_m * diameter_m * diameter_m;
  const double scale = std::cbrt(wanted / volume_inside(mesh));
  for (std::vector<double>* coordinate : {&mesh.R_m, &mesh.Z_m}) {
    for (double& value : *coordinate) {
      value *= scale;
    }
  }
}

}  // namespace

std::size_t Mesh::elements() const {
  std::size_t count = 0;
  for (const Block& block : blocks) {
    count += block.columns * block.rows;
  }
  return count;
}

std::size_t least_elements(std::size_t layers) {
  // Not one by one: as the square grows by a row, a ring may go. With so many, none is missing.
  const std::size_t least = least_rings(layers);
  std::size_t enough = 8 * least * least;
  while (rings_for(enough - 1) >= least) {
    --enough;
  }
  return enough;
}

Mesh ball_mesh(std::span<const double> outer_diameters_m, std::size_t elements) {
  const Pattern pattern = pattern_for(outer_diameters_m, elements);
  const std::size_t n = pattern.n;
  const std::size_t rings =
      std::accumulate(pattern.rings.begin(), pattern.rings.end(), std::size_t{0});
  Mesh mesh;
  add_block(mesh, n, 2 * n);
  add_block(mesh, 4 * n, rings);
  // The square is as large as makes its elements as thick as the core's rings.
  const double core_m = 0.5 * outer_diameters_m.front();
  const double share = 1.0 / (1.0 + static_cast<double>(pattern.rings[0]) / static_cast<double>(n));
  fill_square(mesh, mesh.blocks[0], core_m * share / kMiddle, 0.5 * outer_diameters_m.back());
  fill_rings(mesh, mesh.blocks[0], mesh.blocks[1], pattern, outer_diameters_m);
  restore_volume(mesh, outer_diameters_m.back());
  mesh.regions.push_back({0, 0, 2 * n, 0});
  std::size_t row = 0;
  for (std::size_t layer = 0; layer < pattern.rings.size(); ++layer) {
    mesh.regions.push_back({1, row, pattern.rings[layer], layer});
    row += pattern.rings[layer];
  }
  return mesh;
}

Mesh bar_mesh(double diameter_m, double length_m, std::size_t radial, std::size_t axial) {
  Mesh mesh;
  const Block block = add_block(mesh, radial, axial);
  for (std::size_t j = 0; j <= axial; ++j) {
    for (std::size_t i = 0; i <= radial; ++i) {
      place(mesh, block.node(i, j),
            {0.5 * diameter_m * static_cast<double>(i) / static_cast<double>(radial),
             -length_m * static_cast<double>(axial - j) / static_cast<double>(axial)});
    }
    mesh.axis.push_back(block.node(0, j));
  }
  for (std::size_t i = 0; i <= radial; ++i) {
    mesh.surface.push_back(block.node(i, axial));
  }
  mesh.regions.push_back({0, 0, axial, 0});
  return mesh;
}

}  // namespace kolsky::impact
