#pragma once
/// Derivatives of the elastic energy with respect to the shape of the bodies. A body's material may be an affine image
/// of its grid, X = A xi + b, in which A depends on parameters. mapRule() transforms a rule to the image. Then, for
/// each parameter with the rate Y = dA A^-1, at fixed nodal displacements u,
///   dF = -(F - I) Y,   d(grad N_a) = -Y^T grad N_a,   d(measure) = measure tr Y
///   dE = sum m w [W tr Y - P : (F - I) Y]
///   d(dE/du_a) = sum m w [tr Y P - C : ((F - I) Y) - P Y^T] grad N_a,   C = dP/dF

#include <vector>

#include "snapwing/mpm/discretisation.h"

namespace snapwing::mpm {

/// Transforms the gradients of a rule to the image of its grid: grad N = A^-T dN/dxi. The caller must multiply the
/// cells' measures by det A. @param map  A, det A > 0. @throws common::Error otherwise
template <int D>
void mapRule(const elasticity::Matrix<D>& map, QuadratureRule<D>* rule);

template <int D>
struct MapDerivative {
  Eigen::VectorXd energy;  ///< dE, (parameters x 1) [J per unit of the parameter]
  Eigen::MatrixXd force;   ///< d(dE/du), (dofs x parameters) [N per unit of the parameter]
};

/// @param rates  rates[body][parameter] = Y [1 per unit of the parameter], the same number for every body
/// @param u      nodal displacements in the axes of the image [m], (dofs x 1)
/// @throws common::Error for sizes that do not match, or an inverted element (det F <= 0)
template <int D>
MapDerivative<D> mapDerivative(const Discretisation<D>& solid, const Eigen::VectorXd& u,
                               const std::vector<std::vector<elasticity::Matrix<D>>>& rates);

}  // namespace snapwing::mpm
