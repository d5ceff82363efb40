#pragma once
/// The wing's linkage as solids on the mpm layer: the paper's model.
///
/// Four straight bars - arm (port P through the axle A to X1), coupler (X1 to X2), leading edge (X2 to tip), rocker
/// (auxiliary B to X2) - each embedded in a background grid of its own that is aligned with the bar. The grid is mapped
/// to the bar by an affine map that follows the joints: X(xi) = a + t(xi_1) (b - a) + y(xi_2) n. So the material domain
/// follows X smoothly, no cell is ever cut, and joints keep their place within their cells. Displacements are in common
/// axes. Joints are rows of H u = h(theta):
///   arm at A: u = 0;   arm at P = -driver X1: u = (R(theta) - 1) P;   arm = coupler at X1;   coupler = rocker at X2;
///   rocker at B: u = 0;   weld of coupler and edge at X2: equal displacement and, as complex numbers,
///   Du_coupler / d_coupler = Du_edge / d_edge, with Du the difference of displacement over a short piece d of the bar.
/// The weld's rows depend on X; the others do not. In three dimensions joints are segments through the thickness: rows
/// at two levels, and one row that holds the slide along the segment.
/// Friction of a pin is a pair of couples of dead forces that turn with the rigid rung's bars.

#include <memory>

#include "snapwing/design/wing/linkage_model.h"
#include "snapwing/mpm/grid.h"

namespace snapwing::design {

struct SolidSettings {
  int dimension = 2;                            ///< 2: plane stress; 3: bars extruded, joints as segments
  int cells_along = 12;                         ///< of each bar, 1 .. 400
  int cells_across = 3;                         ///< 1 .. 100
  int cells_through = 2;                        ///< in three dimensions, 1 .. 40
  mpm::Kernel kernel = mpm::Kernel::QUADRATIC;  ///< linear cells lock in bending; for comparison only
  double overhang = 0.08;                       ///< bars reach beyond a joint by this share of their length, > 0
  double driver = 0.8;                          ///< P lies this share of |X1| beyond the axle, > 0
  double grip = 0.06;                           ///< half length of d and of a friction couple, share of the bar
  JointSolver solver = JointSolver::MULTIPLIERS;
  int max_iterations = 60;
  int threads = 1;
  std::vector<GroundPin> ground_pins;  ///< bars: arm {0, 0}, coupler {1, 0}, edge {1, 1}, rocker {2, 0}
  /// @throws common::SettingError naming the key
  void validate() const;
};

/// @throws common::Error for a linkage, bars or settings that make no sense
std::unique_ptr<LinkageModel> makeSolidLinkage(const FourBar& layout, const WingBars& bars,
                                               const SolidSettings& settings = {});

}  // namespace snapwing::design
