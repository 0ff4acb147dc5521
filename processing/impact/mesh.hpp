#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace kolsky::impact {

/// A structured patch of quadrilaterals; node (i, j) has the number first_node + j (columns + 1) +
/// i.
struct Block {
  std::size_t first_node = 0;
  std::size_t columns = 0;
  std::size_t rows = 0;

  [[nodiscard]] std::size_t stride() const { return columns + 1; }
  [[nodiscard]] std::size_t nodes() const { return stride() * (rows + 1); }
  [[nodiscard]] std::size_t node(std::size_t i, std::size_t j) const {
    return first_node + j * stride() + i;
  }
};

/// Rows of a block that are of one solid.
struct Region {
  std::size_t block = 0;
  std::size_t first_row = 0;
  std::size_t rows = 0;
  std::size_t solid = 0;  ///< layer, from the inside
};

/// Two nodes at the same place in different blocks, which move as one.
struct Tie {
  std::size_t a = 0;
  std::size_t b = 0;
};

/// Axisymmetric mesh about R = 0. Between blocks the node numbers have gaps, so that a loop over a
/// block may reach a little past its ends.
struct Mesh {
  std::vector<double> R_m;  ///< of all nodes, gaps included
  std::vector<double> Z_m;
  std::vector<Block> blocks;
  std::vector<Region> regions;  ///< of each block in the order of its rows
  std::vector<Tie> ties;
  std::vector<std::size_t> axis;     ///< nodes on R = 0
  std::vector<std::size_t> surface;  ///< ball: from the struck pole round to the other; bar: face

  [[nodiscard]] std::size_t elements() const;
};

/// From this number of elements on, every one meshes a ball of so many layers.
[[nodiscard]] std::size_t least_elements(std::size_t layers);

/// A ball whose struck pole is at the origin and whose centre is at Z = +radius: a rounded square
/// of n x 2n inside, rings of 4n elements round it, at least four rings in every layer outside the
/// core.
/// @param outer_diameters_m  of the layers from the inside, growing
/// @param elements  about so many; what comes out is the nearest number the pattern gives
/// @throws InputError "elements": too few for the layers
[[nodiscard]] Mesh ball_mesh(std::span<const double> outer_diameters_m, std::size_t elements);

/// A bar that is struck at Z = 0 and lies along -Z. Rows run from the far end; `surface` is the
/// struck face, from the axis outwards.
[[nodiscard]] Mesh bar_mesh(double diameter_m, double length_m, std::size_t radial,
                            std::size_t axial);

}  // namespace kolsky::impact
