#pragma once
/// Linear constraints on nodal displacements, satisfied exactly by elimination:
///   u = T z + B p + c,   z free coordinates, p controls (driven displacements or load factors)
/// Each equation sum_i a_i u_i = sum_k b_k p_k + d eliminates one displacement. Repeated equations are dropped;
/// contradicting ones are an error.

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

namespace snapwing::solver {

struct Equation {
  std::vector<std::pair<int, double>> terms;    ///< (dof, coefficient)
  std::vector<std::pair<int, double>> control;  ///< (control, coefficient)
  double constant = 0;                          ///< [m]
  std::string name;                             ///< support, port or joint that asks for it, for messages
  bool keepable = false;                        ///< port or joint: may be kept as an equation
};

class Reduction {
 public:
  /// @throws common::Error naming the equation that contradicts earlier ones
  /// @param kept_from  dofs from here on are never eliminated; -1: there are none such
  Reduction(int dofs, int controls, const std::vector<Equation>& equations, int kept_from = -1);

  int dofCount() const { return dofs_; }
  int freeCount() const { return static_cast<int>(dof_of_free_.size()); }
  int controlCount() const { return controls_; }
  /// What is left of equations in which nothing but kept dofs remained.
  const std::vector<Equation>& kept() const { return kept_; }
  /// Dof that a free coordinate is.
  int dofOfFree(int z) const { return dof_of_free_[z]; }
  /// Equations that followed from others.
  const std::vector<std::string>& redundant() const { return redundant_; }
  const std::vector<int>& redundantNumbers() const { return redundant_numbers_; }  ///< in the list given

  /// u = T z + B p + c, (dofs x 1). @param z  (free x 1); @param p  (controls x 1)
  Eigen::VectorXd expand(const Eigen::VectorXd& z, const Eigen::VectorXd& p) const;
  /// Directions: without the constants.
  Eigen::VectorXd expandDirection(const Eigen::VectorXd& dz, const Eigen::VectorXd& dp) const;
  Eigen::VectorXd restrictToFree(const Eigen::VectorXd& f) const;     ///< T^T f
  Eigen::VectorXd restrictToControl(const Eigen::VectorXd& f) const;  ///< B^T f
  /// Free coordinates of a displacement vector that satisfies the constraints.
  Eigen::VectorXd freePart(const Eigen::VectorXd& u) const;

  /// Terms (free coordinate, coefficient) of a displacement; a free one has itself with 1.
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
