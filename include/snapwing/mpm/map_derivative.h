#pragma once
/// Derivatives of the elastic energy by the shape of the bodies: a body's material may be an affine image of its grid,
/// X = A xi + b, and A may depend on parameters. A rule is brought to the image once (mapRule); then, per parameter,
/// with the rate Y = dA A^-1 at fixed nodal displacements u,
///   dF = -(F - I) Y,   d(grad N_a) = -Y^T grad N_a,   d(measure) = measure tr Y
///   dE = sum m w [W tr Y - P : (F - I) Y]
///   d(dE/du_a) = sum m w [tr Y P - C : ((F - I) Y) - P Y^T] grad N_a,   C = dP/dF

#include <vector>

#include "snapwing/mpm/discretisation.h"

namespace snapwing::mpm {

/// Gradients of a rule brought to the image of its grid: grad N = A^-T dN/dxi. The cells' measures must be scaled by
/// det A, which is left to the caller. @param map  A, det A > 0. @throws common::Error if it is not
template <int D>
void mapRule(const elasticity::Matrix<D>& map, QuadratureRule<D>* rule);

template <int D>
struct MapDerivative {
  Eigen::VectorXd energy;  ///< dE by each parameter at fixed u [J per unit of the parameter]
  Eigen::MatrixXd force;   ///< d(dE/du), (dofs x parameters) [N per unit]
};

/// @param rates  rates[body][parameter] = Y [1 per unit of the parameter], the same count for every body
/// @param u      nodal displacements in the axes of the image [m]; det F > 0 at each particle
/// @throws common::Error for sizes that do not match or an energy that is not finite
template <int D>
MapDerivative<D> mapDerivative(const Discretisation<D>& solid, const Eigen::VectorXd& u,
                               const std::vector<std::vector<elasticity::Matrix<D>>>& rates);

}  // namespace snapwing::mpm
