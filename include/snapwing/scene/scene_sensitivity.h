#pragma once
/// Derivatives of a scene's results by the densities of its cells (solver::Sensitivity) and by the places of its
/// joints, by the adjoint method. With L(z, lambda; p, theta) = Pi + lambda . g, stationary in z and lambda, and [w,
/// nu] = -[H A^T; A 0]^-1 [a, 0] of a functional's gradient a:
///   dL/dtheta = L_theta                          the potential at a given control
///   dR/dtheta = d(L_theta)/dp along the branch   the reaction R = dL/dp
///   dF/dtheta = w . r_theta + nu . g_theta    a functional with dF/dz = a, where r = dL/dz
/// A joint's place X stands in g = C(X) z - D p - e alone. The kernels are at most quadratic in X along each axis, so
/// that central differences of the rows of displaced joints are their exact derivatives within a cell; on a face
/// between cells, where the linear kernel has a kink, they are the mean of both sides.
///
/// All values are of the problem: results of the whole are `multiplicity()` times forces and energies.

#include <memory>
#include <vector>

#include "snapwing/scene/scene.h"
#include "snapwing/solver/equilibrium.h"

namespace snapwing::scene {

struct SceneSlope {
  Eigen::VectorXd density;  ///< by each cell's density, (cells x 1) [unit of the result]
  /// By x and y of each joint in joints(), (joints x 2) [unit of the result per m]; an image beyond a mirror plane
  /// moves along. Empty with enforcement by `elimination`.
  Eigen::MatrixXd joint;
};

/// At one equilibrium; one factorization serves all results.
class SceneSensitivity {
 public:
  virtual ~SceneSensitivity() = default;
  /// Numbers of the scene's joints that have a place: lines and segments, no faces.
  virtual const std::vector<int>& joints() const = 0;
  virtual SceneSlope reaction() const = 0;    ///< of dPi/dp [N]
  virtual SceneSlope potential() const = 0;   ///< of Pi: elastic energy less the work of loads [J]
  virtual SceneSlope compliance() const = 0;  ///< of (l + L p) . u, the work that loads would do at full size [J]
  virtual SceneSlope volume() const = 0;      ///< of the material's volume, sum rho_c m_c [m3]
  virtual SceneSlope monitor(int number) const = 0;  ///< of a displacement [m] or a rotation [rad]
};

}  // namespace snapwing::scene
