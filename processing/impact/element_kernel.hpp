#pragma once

#include <cstddef>

namespace kolsky::impact {

/// What elements are reckoned in. Displacements are double: only what nodes are apart is rounded.
using Real = float;

inline constexpr int kMostBranches = 6;
inline constexpr std::size_t kMostLanes = 16;  ///< of any kernel; arrays are padded to it

/// Arrays of one element, each `pitch` long, in this order: for each of the four points the inverse
/// of the reference Jacobian (dxi/dR, dxi/dZ, deta/dR, deta/dZ), its share of the element's volume
/// and 1/R; then the element's reference volume over the full circle.
inline constexpr std::size_t kGeometryPerPoint = 6;
inline constexpr std::size_t kGeometryArrays = 4 * kGeometryPerPoint + 1;

/// Contributions to the internal forces: radial, then axial, of the element's four nodes.
inline constexpr std::size_t kForceArrays = 8;

/// State of one branch: three deviatoric numbers in each of four points, and the volume's.
inline constexpr std::size_t kStatePerBranch = 13;

/// One Maxwell arm over a step. With strain linear in time over each step, its dashpot's strain is
/// a = kept + weight_now x; kept' = (1 - loss) a + weight_next x.
struct BranchStep {
  Real shear_Pa = 0.0F;  ///< 2 G of the arm
  Real bulk_Pa = 0.0F;   ///< K of the arm
  Real rate_per_s = 0.0F;
  Real weight_now = 0.0F;
  Real loss = 1.0F;
  Real weight_next = 0.0F;
};

/// Elements of one material that follow one another in a structured block. Element e of the range
/// has the nodes e, e + 1, e + stride and e + stride + 1 of the block; the last of each row is an
/// empty one (volume 0), so that the range is one flat loop.
struct ElementRange {
  std::size_t count = 0;
  std::size_t stride = 0;
  std::size_t pitch = 0;           ///< of geometry and state; a multiple of kMostLanes
  std::size_t force_pitch = 0;     ///< of the force arrays
  const double* radial = nullptr;  ///< displacements, at the range's first node
  const double* axial = nullptr;
  const Real* geometry = nullptr;
  Real* state = nullptr;
  Real* force = nullptr;  ///< the arrays begin at the range's first element

  Real shear_Pa = 0.0F;  ///< 2 G, fully relaxed
  Real bulk_Pa = 0.0F;   ///< K, fully relaxed
  Real nonlinearity = 0.0F;
  Real cauchy = 0.0F;  ///< 1: the law's stress is per deformed area, 0: per undeformed
  int branches = 0;
  BranchStep branch[kMostBranches];
};

/// Sums over a range. The second half is filled by `survey` alone.
struct ElementSums {
  double dissipated_W = 0.0;
  double least_area_ratio = 1.0;  ///< least determinant of the in-plane deformation
  double stored_J = 0.0;
  double steepest_per_m2 = 0.0;  ///< largest squared gradient of an element's own coordinates
};

/// A block's nodes, as `ElementRange` numbers them, and what the elements put on them.
struct NodeRange {
  std::size_t count = 0;
  std::size_t stride = 0;
  const Real* contributions = nullptr;  ///< of one direction, at the block's first node
  std::size_t pitch = 0;                ///< of the four contributions
  double* force = nullptr;              ///< at the block's first node
};

/// One component of the nodes' motion.
struct NodeMotion {
  std::size_t count = 0;
  const double* force = nullptr;
  const double* by_mass = nullptr;
  double* velocity = nullptr;
  double* displacement = nullptr;
};

/// Internal forces of axisymmetric four-node quadrilaterals, 2 x 2 points, dilatation averaged over
/// the element, for stress that is linear viscoelastic in Hencky's strain (docs/impact.md).
struct ElementKernel {
  const char* name;
  int lanes;
  void (*advance)(const ElementRange&, ElementSums&);
  void (*survey)(const ElementRange&, ElementSums&);  ///< the same, and what the ledger asks for
  void (*gather)(const NodeRange&);                   ///< the force that resists, node by node
  /// Velocities by so much of the acceleration, displacements by so much of the velocity.
  void (*move)(const NodeMotion&, double velocity_step_s, double step_s);
};

/// The fastest kernel that this processor runs.
[[nodiscard]] const ElementKernel& element_kernel();

/// Every kernel that this processor runs, slowest first: tests compare them.
[[nodiscard]] const ElementKernel* const* runnable_kernels(std::size_t& count);

}  // namespace kolsky::impact
