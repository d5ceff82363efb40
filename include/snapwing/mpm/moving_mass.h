#pragma once
/// Mass of solids that follow one control along their equilibria, as a moving body sees it.

#include <Eigen/Core>
#include <vector>

#include "snapwing/mpm/discretisation.h"

namespace snapwing::mpm {

/// With the frame at z along an axis and the control at p,  T = m z'^2 / 2 + S z' p' + K p'^2 / 2.
struct MovingMass {
  double mass = 0;     ///< m, of the filled material [kg]
  double kinetic = 0;  ///< K = sum m |du/dp|^2 [kg]
  double coupled = 0;  ///< S = sum m axis . du/dp [kg]
};

/// @param mass_density  of each body at full density [kg/m3]; a cell has it times its density
/// @param rate          nodal displacements per control, du/dp [1], (dofCount x 1)
/// @param axis          unit vector
/// @param rules         number of each cell's quadrature rule; empty: the finest of its terms, which cells without a
///                      constitutive law (rigid bodies) do not have
template <int D>
MovingMass movingMass(const mpm::Discretisation<D>& solid, const std::vector<double>& mass_density,
                      const Eigen::VectorXd& rate, const mpm::Vector<D>& axis, const std::vector<int>& rules = {});

}  // namespace snapwing::mpm
