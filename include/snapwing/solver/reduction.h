#pragma once
/// Linear constraints on full coordinates u, enforced by elimination:
///   u = T z + B p + c,   z free coordinates, p controls (driven displacements or load factors)
/// Each equation sum_i a_i u_i = sum_k b_k p_k + d eliminates one coordinate. Redundant equations are dropped;
/// contradicting ones are refused.

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

namespace snapwing::solver {

struct Equation {
  std::vector<std::pair<int, double>> terms;    ///< (dof i, a_i [1])
  std::vector<std::pair<int, double>> control;  ///< (control k, b_k)
  double constant = 0;                          ///< d [m]
  std::string name;                             ///< of the support, port or joint, for messages
  bool keepable = false;                        ///< port or joint: may be kept as a constraint (Constraints)
};

class Reduction {
 public:
  /// @param kept_from  dofs from this number on are not eliminated; -1: all may be
  /// @throws common::Error naming the equation that contradicts earlier ones
  Reduction(int dofs, int controls, const std::vector<Equation>& equations, int kept_from = -1);

  int dofCount() const { return dofs_; }
  int freeCount() const { return static_cast<int>(dof_of_free_.size()); }
  int controlCount() const { return controls_; }
  /// Equations in which, after elimination, only dofs from kept_from on remain.
  const std::vector<Equation>& kept() const { return kept_; }
  /// Number of the dof that is free coordinate z.
  int dofOfFree(int z) const { return dof_of_free_[z]; }
  /// Names of the equations that eliminated nothing: redundant ones, and those of kept().
  const std::vector<std::string>& redundant() const { return redundant_; }
  const std::vector<int>& redundantNumbers() const { return redundant_numbers_; }  ///< their indices in `equations`

  /// u = T z + B p + c, (dofs x 1) [m]. @param z  (free x 1) [m]; @param p  (controls x 1)
  Eigen::VectorXd expand(const Eigen::VectorXd& z, const Eigen::VectorXd& p) const;
  /// T dz + B dp.
  Eigen::VectorXd expandDirection(const Eigen::VectorXd& dz, const Eigen::VectorXd& dp) const;
  Eigen::VectorXd restrictToFree(const Eigen::VectorXd& f) const;     ///< T^T f, (free x 1)
  Eigen::VectorXd restrictToControl(const Eigen::VectorXd& f) const;  ///< B^T f, (controls x 1)
  /// Free coordinates of a vector u that satisfies the constraints.
  Eigen::VectorXd freePart(const Eigen::VectorXd& u) const;

  /// Row of T of a dof: (free coordinate, coefficient [1]).
  const std::vector<std::pair<int, double>>& terms(int dof) const { return terms_[dof]; }

 private:
  int dofs_, controls_;
  std::vector<int> dof_of_free_;
  std::vector<std::vector<std::pair<int, double>>> terms_;
  std::vector<int> slaves_;
  std::vector<std::vector<std::pair<int, double>>> control_;  ///< per slave
  std::vector<double> constant_;                              ///< per slave
  std::vector<std::string> redundant_;
  std::vector<int> redundant_numbers_;
  std::vector<Equation> kept_;
};

}  // namespace snapwing::solver
