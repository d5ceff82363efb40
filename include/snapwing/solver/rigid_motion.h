#pragma once
/// Exact rigid motion of groups of nodes at finite rotation.
///
/// A rigid node moves by u_i = c + E (X_i - X_c) / L with E = L (R - I), R a rotation. That is linear in c and in the
/// entries of E, so every support, port and joint of a rigid body stays a linear equation (Reduction), as long as none
/// of them eliminates an entry of E. What is left nonlinear is E(s), s = L theta, and TurningProblem differentiates it
/// twice: R = I + a K + b (theta theta^T - |theta|^2 I), a = sin t / t, b = (1 - cos t) / t^2 (Rodrigues).

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "snapwing/solver/problem.h"

namespace snapwing::solver {

/// How a rigid group may turn: not at all, about one axis that is fixed in space, or freely.
struct Turning {
  int first = 0;      ///< dof of E_00; E_ij is dof first + i + D j
  double length = 1;  ///< L [m]
  /// None: E = 0. One: its unit vector. Three (volumetric): free; the rotation vector then must stay below 2 pi.
  std::vector<Eigen::Vector3d> axes;
};

/// E and its derivatives by s; entries in the order i + D j.
struct TurningValue {
  Eigen::VectorXd value;                ///< E [m], (D D)
  Eigen::MatrixXd slope;                ///< dE/ds [1], (D D x params)
  std::vector<Eigen::MatrixXd> second;  ///< d2E/ds2 [1/m], per entry (params x params)
};

/// @param s  L times the angles about the axes [m], one per axis
template <int D>
TurningValue turn(const Turning& turning, const Eigen::VectorXd& s);

/// Ways of turning that linear equations in the entries of E leave open.
/// @param name       of the rigid group, for messages
/// @param equations  homogeneous, in dofs first .. first + D D - 1 only
/// @param allowed    axes to choose from: all (the unit vectors), or one
/// @throws common::Error if they ask for a motion that is neither blocked, about one axis, nor free
template <int D>
std::vector<Eigen::Vector3d> openAxes(const Turning& turning, const std::vector<Equation>& equations,
                                      std::vector<Eigen::Vector3d> allowed, const std::string& name);

/// A solid problem whose reduction holds entries of E among its coordinates, in the coordinates that can be chosen
/// freely: those of the inner problem without E, then s of each turning group in order.
template <int D>
class TurningProblem : public Problem {
 public:
  /// @param inner  its reduction keeps all dofs of the turnings free
  TurningProblem(std::shared_ptr<const SolidProblem<D>> inner, std::vector<Turning> turnings);

  int freeCount() const override { return free_; }
  int controlCount() const override { return inner_->controlCount(); }
  const SparsePattern& pattern() const override { return pattern_; }
  void evaluate(const Eigen::VectorXd& z, const Eigen::VectorXd& p, Order order, Evaluation& out) const override;
  void controlTangent(const Evaluation& at, const Eigen::VectorXd& dp, Eigen::VectorXd& free_part,
                      Eigen::VectorXd& control_part) const override;
  double forceFloor() const override { return inner_->forceFloor(); }
  std::string describeCell(int cell) const override { return inner_->describeCell(cell); }

  /// Coordinates of the inner problem.
  Eigen::VectorXd innerCoordinates(const Eigen::VectorXd& z) const;

 private:
  struct Group {
    Turning turning;
    std::vector<int> inner;  ///< coordinate of the inner problem of each entry of E
    int first = 0;           ///< first own coordinate
    int jacobian = 0;        ///< place of dE/ds in the flat list of derivatives
    int params() const { return static_cast<int>(turning.axes.size()); }
  };
  /// values[target] += times * jacobian[row] * jacobian[column] * inner[source]
  struct Item {
    int target, source, row, column;
    double times;
  };
  /// Own coordinates that an inner coordinate depends on: (coordinate, place of the derivative).
  using Users = std::vector<std::vector<std::pair<int, int>>>;

  Users users() const;
  void buildPattern();
  std::vector<TurningValue> turnAll(const Eigen::VectorXd& z) const;
  std::vector<double> jacobian(const std::vector<TurningValue>& values) const;
  Eigen::VectorXd pullBack(const Eigen::VectorXd& inner, const std::vector<TurningValue>& values) const;
  void pullBackHessian(const Eigen::VectorXd& inner_residual, const std::vector<TurningValue>& values, bool projected,
                       std::vector<double>& hessian) const;

  std::shared_ptr<const SolidProblem<D>> inner_;
  std::vector<Group> groups_;
  std::vector<int> plain_;  ///< inner coordinate -> own, or -1 for entries of E
  int free_ = 0, jacobian_size_ = 1;
  SparsePattern pattern_;
  std::vector<Item> items_;
};

}  // namespace snapwing::solver
