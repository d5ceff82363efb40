#pragma once
/// An equilibrium problem: make the potential Pi(z; p) stationary in the free coordinates z at given controls p.

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "snapwing/common/loan.h"
#include "snapwing/solver/constraints.h"
#include "snapwing/solver/coordinates.h"
#include "snapwing/solver/sparse.h"
#include "snapwing/solver/term.h"

namespace snapwing::solver {

/// One evaluation of a problem; mutable work space. Valid as far as the order asked for.
struct Evaluation {
  double energy = 0;              ///< Pi [J]
  double elastic_energy = 0;      ///< [J]
  Eigen::VectorXd residual;       ///< dPi/dz [N]
  Eigen::VectorXd control_force;  ///< dPi/dp at fixed z: the multiplier of a driven displacement [N]
  std::vector<double> hessian;    ///< d2Pi/dz2 in the order of the pattern
  double force_scale = 0;         ///< [N] what a residual is measured against
  double rounding = 0;            ///< [N] what rounding leaves of it: zero in statics
  double min_det_f = 1;
  int min_det_f_cell = -1;
  bool finite = false;
  bool potential = true;     ///< the residual is the slope of the energy; else a step is good if it lowers the residual
  Coordinates::Place place;  ///< full coordinates, of problems that are sums of terms
  Eigen::VectorXd control;   ///< p, same
  Sum sum;                   ///< what the terms added up to, same
  std::vector<Sum> along;    ///< work space of a step's path
  const Step* step = nullptr;                  ///< null in statics
  Eigen::VectorXd constraint_residual;         ///< g of the constraints [m]; empty without
  std::shared_ptr<const ConstraintRows> rows;  ///< dg/dz at z, of order TANGENT; null without
};

class Problem : public common::Lender {
 public:
  virtual ~Problem() = default;
  /// Constraints that are kept as equations; null if there are none. What is evaluated is then the Lagrangian.
  virtual const Constraints* constraints() const { return nullptr; }
  /// True if their rows change with z: joints between bodies that turn.
  virtual bool curvedConstraints() const { return false; }
  virtual int freeCount() const = 0;
  virtual int controlCount() const = 0;
  virtual const SparsePattern& pattern() const = 0;
  /// @param z  free coordinates, (free x 1); @param p  controls, (controls x 1); @param out  see Evaluation for units
  virtual void evaluate(const Eigen::VectorXd& z, const Eigen::VectorXd& p, Order order, Evaluation& out) const = 0;
  /// The same at multipliers of the constraints [N], which `evaluate` takes for zero.
  virtual void evaluateLagrangian(const Eigen::VectorXd& z, const Eigen::VectorXd& p,
                                  const Eigen::VectorXd& multipliers, Order order, Evaluation& out) const;
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

/// Mean diagonal of the Hessian at rest over the coordinates with stiffness [N/m]: what a penalty is measured against.
double meanStiffness(const Problem& problem);

}  // namespace snapwing::solver
