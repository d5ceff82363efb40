#pragma once
/// An equilibrium problem: dPi/dz = 0 for a potential Pi(z; p) of free coordinates z at given controls p.

#include <Eigen/Core>
#include <array>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "snapwing/common/loan.h"
#include "snapwing/solver/constraints.h"
#include "snapwing/solver/coordinates.h"
#include "snapwing/solver/residual_series.h"
#include "snapwing/solver/sparse.h"
#include "snapwing/solver/term.h"

namespace snapwing::solver {

/// One evaluation of a problem; mutable work space. The order says which members are valid: ENERGY the energies, det F
/// and constraint residual; STRESS also residual and forces; TANGENT and above also the Hessian and `rows`.
struct Evaluation {
  double energy = 0;              ///< Pi [J]
  double elastic_energy = 0;      ///< [J]
  Eigen::VectorXd residual;       ///< dPi/dz [N], (free x 1)
  Eigen::VectorXd control_force;  ///< dPi/dp at fixed z, (controls x 1): reaction [N] of a driven displacement
  std::vector<double> hessian;    ///< d2Pi/dz2 [N/m] in the order of the pattern
  double force_scale = 0;         ///< [N] largest force before terms cancel: scale of the residual's tolerance
  double rounding = 0;            ///< [N] rounding error of a force, as reported by the terms (Sum::rounding)
  double min_det_f = 1;           ///< smallest over the particles [1]
  int min_det_f_cell = -1;        ///< number of its cell
  bool finite = false;            ///< false: inverted element, or NaN
  bool potential = true;       ///< the residual is the gradient of the energy; if not, steps must decrease the residual
  Coordinates::Place place;    ///< full coordinates; TermProblem only
  Eigen::VectorXd control;     ///< p; TermProblem only
  Sum sum;                     ///< sum of the terms; TermProblem only
  std::vector<Sum> along;      ///< work space for a step's path
  const Step* step = nullptr;  ///< null in statics
  Eigen::VectorXd constraint_residual;         ///< g of the constraints [m]; empty without
  std::shared_ptr<const ConstraintRows> rows;  ///< dg/dz at z, of order TANGENT; null without
};

/// A node of a solid: its displacements among the free coordinates, and how far the solid has turned there.
struct NodeRotation {
  std::array<int, 3> free;   ///< numbers of free coordinates; -1: eliminated, or none
  Eigen::Matrix3d rotation;  ///< [1]
};

class Problem : public common::Lender {
 public:
  virtual ~Problem() = default;
  /// Constraints kept as equations; null if there are none. With constraints the Lagrangian is evaluated in place of
  /// Pi.
  virtual const Constraints* constraints() const { return nullptr; }
  /// True if their rows dg/dz depend on z: joints of rigid bodies that rotate.
  virtual bool curvedConstraints() const { return false; }
  virtual int freeCount() const = 0;
  virtual int controlCount() const = 0;
  virtual const SparsePattern& pattern() const = 0;
  /// @param z  (free x 1) [m]; @param p  (controls x 1); @param out  see Evaluation for units
  virtual void evaluate(const Eigen::VectorXd& z, const Eigen::VectorXd& p, Order order, Evaluation& out) const = 0;
  /// As evaluate(), which takes zero multipliers, with these multipliers of the constraints [N].
  virtual void evaluateLagrangian(const Eigen::VectorXd& z, const Eigen::VectorXd& p,
                                  const Eigen::VectorXd& multipliers, Order order, Evaluation& out) const;
  /// At an evaluation of order TANGENT: (d2Pi/dz dp) dp, (free x 1), and (d2Pi/dp2) dp, (controls x 1).
  virtual void controlTangent(const Evaluation& at, const Eigen::VectorXd& dp, Eigen::VectorXd& free_part,
                              Eigen::VectorXd& control_part) const = 0;
  /// Rotations of the solids' nodes at an evaluation: a factor made elsewhere can be turned by them (Newton).
  virtual std::vector<NodeRotation> nodeRotations(const Evaluation& /*at*/) const { return {}; }
  /// Power series of the residual up to an order; null if it has none, and `why` then says what lacks one.
  virtual std::unique_ptr<ResidualSeries> series(int /*order*/, std::string& why) const {
    why = "the problem";
    return nullptr;
  }
  /// Absolute tolerance of the residual [N].
  virtual double forceFloor() const = 0;
  /// Changes of the energy below this count as rounding in the line search [J]; 0: only 1e-10 of the energies.
  virtual double energyFloor() const { return 0; }
  /// Text for messages, e.g. "cell 12 of body 0 at (...) m".
  virtual std::string describeCell(int cell) const = 0;
};

/// Mean diagonal entry of the Hessian at rest over the coordinates with stiffness [N/m]: scale for a penalty.
double meanStiffness(const Problem& problem);

}  // namespace snapwing::solver
