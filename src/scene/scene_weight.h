#pragma once
/// Weight of a scene's bodies, which follows the densities of their cells (internal to the statics floor).

#include <memory>
#include <vector>

#include "scene_cells.h"

namespace snapwing::scene {

/// Nodal forces l_a = g sum_c rho_c m_ca of gravity g, where m_ca is the mass of cell c at density 1 that falls to its
/// node a.
template <int D>
class Weight {
 public:
  Weight(const Scene& scene, const SceneCells<D>& cells);

  /// Adds the forces at the densities that the cells have now. @param force  (dofs of the nodes x 1) [N]
  void addTo(Eigen::VectorXd& force) const;
  /// d(l . v)/drho_c, (cells x 1). @param v  (dofs of the nodes x 1); the result is in J for v in m
  Eigen::VectorXd densitySlope(const Eigen::VectorXd& v) const;

 private:
  std::shared_ptr<const mpm::Discretisation<D>> solid_;
  mpm::Vector<D> gravity_;
  std::vector<double> mass_;  ///< cells x stencil [kg]; empty without gravity
};

}  // namespace snapwing::scene
