#pragma once
/// An equilibrium problem: make the potential Pi(z; p) stationary in the free coordinates z at given controls p.

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "snapwing/elasticity/constitutive_model.h"
#include "snapwing/mpm/discretisation.h"
#include "snapwing/solver/reduction.h"
#include "snapwing/solver/sparse.h"

namespace snapwing::solver {

using elasticity::Order;

/// One evaluation of a problem; mutable work space. Valid as far as the order asked for.
struct Evaluation {
  double energy = 0;              ///< Pi [J]
  double elastic_energy = 0;      ///< [J]
  Eigen::VectorXd residual;       ///< dPi/dz [N]
  Eigen::VectorXd control_force;  ///< dPi/dp at fixed z: the multiplier of a driven displacement [N]
  std::vector<double> hessian;    ///< d2Pi/dz2 in the order of the pattern
  double force_scale = 0;         ///< [N] what a residual is measured against
  double min_det_f = 1;
  int min_det_f_cell = -1;
  bool finite = false;
  mpm::Assembly assembly;         ///< of solids
  Eigen::VectorXd displacements;  ///< of solids [m]
  Eigen::VectorXd coordinates;    ///< z, where a problem's coordinates are not linear in those of its solids
};

class TiedProblem;

class Problem {
 public:
  virtual ~Problem() = default;
  /// Itself, if some constraints are kept as equations; else null.
  virtual const TiedProblem* tied() const { return nullptr; }
  virtual int freeCount() const = 0;
  virtual int controlCount() const = 0;
  virtual const SparsePattern& pattern() const = 0;
  virtual void evaluate(const Eigen::VectorXd& z, const Eigen::VectorXd& p, Order order, Evaluation& out) const = 0;
  /// Second derivatives with the controls at an evaluation of order TANGENT: d2Pi/dz dp . dp and d2Pi/dp2 . dp.
  virtual void controlTangent(const Evaluation& at, const Eigen::VectorXd& dp, Eigen::VectorXd& free_part,
                              Eigen::VectorXd& control_part) const = 0;
  /// Smallest force that counts [N]: residuals below are zero.
  virtual double forceFloor() const = 0;
  /// Smaller changes of the energy are rounding [J]; 0: judged by the energies themselves.
  virtual double energyFloor() const { return 0; }
  /// Words for a place, e.g. "cell (3, 4) of body 0 at (...) m".
  virtual std::string describeCell(int cell) const = 0;
};

/// Solids under linear constraints and dead loads: Pi = E(u) - (l + L p)^T u, u = T z + B p + c. The reduction may hold
/// further dofs behind those of the solid's nodes.
template <int D>
class SolidProblem : public Problem {
 public:
  /// @param solid     shared, finished
  /// @param loads     L, nodal forces per unit of each control [N], (dofs x controls) or empty
  /// @param threads   for assembly
  /// @param floor     smallest force that counts [N]
  SolidProblem(std::shared_ptr<const mpm::Discretisation<D>> solid, Reduction reduction, Eigen::MatrixXd loads,
               int threads, double floor);

  /// Nodal forces that act whatever the controls are [N], (dofs of the solid x 1): Pi is less by l^T u.
  void setDeadLoad(Eigen::VectorXd load) { dead_load_ = std::move(load); }
  /// For stiff bodies that move far and store little: their cells' energies round at some 1e-15 E times the volume.
  void setEnergyFloor(double floor) { energy_floor_ = floor; }
  /// l + L p [N], (dofs of the solid x 1).
  Eigen::VectorXd loadAt(const Eigen::VectorXd& p) const;

  int freeCount() const override { return reduction_.freeCount(); }
  int controlCount() const override { return reduction_.controlCount(); }
  const SparsePattern& pattern() const override { return pattern_; }
  void evaluate(const Eigen::VectorXd& z, const Eigen::VectorXd& p, Order order, Evaluation& out) const override;
  void controlTangent(const Evaluation& at, const Eigen::VectorXd& dp, Eigen::VectorXd& free_part,
                      Eigen::VectorXd& control_part) const override;
  double forceFloor() const override { return floor_; }
  double energyFloor() const override { return energy_floor_; }
  std::string describeCell(int cell) const override;

  const mpm::Discretisation<D>& solid() const { return *solid_; }
  const Reduction& reduction() const { return reduction_; }

 private:
  void buildPattern();
  /// Nodal forces with zeros for dofs of the reduction that are no node's.
  Eigen::VectorXd padded(const Eigen::VectorXd& forces) const;
  void gatherHessian(const std::vector<double>& blocks, std::vector<double>& values) const;

  std::shared_ptr<const mpm::Discretisation<D>> solid_;
  Reduction reduction_;
  Eigen::MatrixXd loads_;
  Eigen::VectorXd dead_load_;  ///< or empty
  int threads_;
  double floor_;
  double energy_floor_ = 0;
  SparsePattern pattern_;
  /// Values of the reduced matrix: entry k is blocks[source_[k]] (or 0 if -1), then the few that mix are added.
  std::vector<int> source_;
  struct Mixed {
    int target, source;
    double factor;
  };
  std::vector<Mixed> mixed_;
};

}  // namespace snapwing::solver
