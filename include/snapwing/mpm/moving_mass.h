#pragma once
/// Inertia of solids that move quasi-statically with one control, in a frame that moves along an axis.

#include <Eigen/Core>
#include <vector>

#include "snapwing/mpm/discretisation.h"

namespace snapwing::mpm {

/// Kinetic energy T = m z'^2 / 2 + S z' p' + K p'^2 / 2, z: position of the frame along the axis, p: the control.
struct MovingMass {
  double mass = 0;     ///< m [kg]
  double kinetic = 0;  ///< K = sum m |du/dp|^2 [kg]
  double coupled = 0;  ///< S = sum m axis . du/dp [kg]
};

/// @param mass_density  of each body at rho = 1 [kg/m3]; a cell has rho times it
/// @param rate          du/dp of the nodes along the path [1], (dofCount x 1)
/// @param axis          unit vector, in the axes of `rate`
/// @param rules         as of Mass
template <int D>
MovingMass movingMass(const mpm::Discretisation<D>& solid, const std::vector<double>& mass_density,
                      const Eigen::VectorXd& rate, const mpm::Vector<D>& axis, const std::vector<int>& rules = {});

}  // namespace snapwing::mpm
