#pragma once
/// Derivatives of a scene's results with respect to the densities of its cells (solver::Sensitivity) and the positions
/// of its joints, by the adjoint method. With L(z, lambda; p, theta) = Pi + lambda . g, stationary in z and lambda, and
/// [w, nu] = -[H A^T; A 0]^-1 [a; 0] for a functional's gradient a:
///   dL/dtheta = L_theta                          the potential at a given control
///   dR/dtheta = d(L_theta)/dp along the branch   the reaction R = dL/dp
///   dF/dtheta = w . r_theta + nu . g_theta    a functional with dF/dz = a, where r = dL/dz
/// Only g = C(X) z - D p - e depends on a joint's position X. The kernels are at most quadratic in X along each axis,
/// so that central differences of the rows of displaced joints are exact derivatives within a cell. On a face between
/// cells, where the linear kernel has a kink, they are the mean of both sides.
///
/// All values are of the problem. Those of the whole scene are multiplicity() times forces, energies and volumes.

#include <memory>
#include <vector>

#include "snapwing/scene/scene.h"
#include "snapwing/solver/equilibrium.h"

namespace snapwing::scene {

struct SceneSlope {
  Eigen::VectorXd density;  ///< with respect to each cell's density, (cells x 1) [unit of the result]
  /// With respect to x and y of each joint in joints(), (joints x 2) [unit of the result per m]; a mirror image moves
  /// with it. Empty with enforcement by `elimination`.
  Eigen::MatrixXd joint;
};

/// Derivatives at one equilibrium, with one factorisation for all results.
class SceneSensitivity {
 public:
  virtual ~SceneSensitivity() = default;
  /// Indices of the scene's joints with a position: lines and segments, not faces.
  virtual const std::vector<int>& joints() const = 0;
  virtual SceneSlope reaction() const = 0;    ///< of the reaction dL/dp [N]
  virtual SceneSlope potential() const = 0;   ///< of Pi: elastic energy less the work of loads [J]
  virtual SceneSlope compliance() const = 0;  ///< of (l + L p + weight) . u, the loads times the displacements [J]
  virtual SceneSlope volume() const = 0;      ///< of the material's volume, sum rho_c m_c [m3]
  virtual SceneSlope monitor(int number) const = 0;  ///< of a monitor: displacement [m] or rotation [rad]
};

}  // namespace snapwing::scene
