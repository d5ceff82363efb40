#pragma once
/// Weight of a scene's bodies, which follows the densities of their cells (internal to the layer).

#include <memory>
#include <string>
#include <vector>

#include "scene_cells.h"
#include "snapwing/solver/term.h"

namespace snapwing::scene {

/// E = -l . y with nodal forces l_a = g sum_c rho_c m_ca of gravity g, where m_ca is the mass of cell c at density 1
/// that falls to its node a. Nodes of rigid bodies have weight as well.
template <int D>
class Weight : public solver::Term {
 public:
  Weight(const Scene& scene, const SceneCells<D>& cells);

  std::string name() const override { return "weight"; }
  Role role() const override { return Role::LOAD; }
  bool linearInStatics() const override { return true; }
  void evaluate(const solver::Point& at, solver::Order order, solver::Sum& sum) const override;
  void densityDerivative(const solver::Point& at, const Eigen::VectorXd* v, Eigen::VectorXd& by_cell) const override;

  /// l at the densities that the cells had at the last update, (dofs of the nodes x 1) [N]; zero without gravity.
  const Eigen::VectorXd& load() const { return load_; }
  /// For the owner of the densities, whenever they have changed.
  void update();

 private:
  /// d(l . v)/drho_c, (cells x 1). @param v  (dofs of the nodes x 1 or more); the result is in J for v in m
  Eigen::VectorXd densitySlope(const Eigen::VectorXd& v) const;

  std::shared_ptr<const mpm::Discretisation<D>> solid_;
  std::vector<mpm::Vector<D>> gravity_;                ///< in each body's axes
  std::vector<std::pair<int, mpm::Vector<D>>> given_;  ///< first coordinate and weight of bodies without cells
  std::vector<double> mass_;                           ///< cells x stencil [kg]; empty without gravity
  Eigen::VectorXd load_;
};

}  // namespace snapwing::scene
