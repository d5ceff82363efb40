#pragma once
/// Terms with internal variables that outlive a step, and the material's memory as one.

#include <memory>

#include "snapwing/elasticity/prony_series.h"
#include "snapwing/solver/green_particles.h"

namespace snapwing::solver {

/// A term of a step whose internal variables belong to the state of motion, zero in what has rested for long.
class HistoryTerm : public Term {
 public:
  /// What a step does to the variables.
  struct Passed {
    Eigen::VectorXd history;  ///< at the end
    double stored = 0;        ///< energy in them at the end [J]
    double loss = 0;          ///< [J] >= 0
  };
  Role role() const override { return Role::DISSIPATION; }
  virtual int historyCount() const = 0;
  /// In the place of keep(), which knows no history. @param history  (historyCount() x 1)
  virtual std::shared_ptr<const Memory> keepWith(const Point& start, const Eigen::VectorXd& history) const = 0;
  /// @param end  of a step, with what was kept of its start
  virtual Passed pass(const Point& end) const = 0;
  virtual double storedIn(const Eigen::VectorXd& history) const = 0;  ///< [J]
};

/// Finite viscoelasticity as branches in parallel with the solid's own law, each a spring and a dashpot in series that
/// are linear in Green's strain G:
///   S = S_law(F) + sum_k w_k C q_k,   dq_k/dt = dG/dt - q_k / time_k,   w_k = share_k / slow,
/// with C the law's moduli at rest. The solid's law is the slow one. Energy sum w/2 q:C:q, loss sum w/time q:C:q >= 0
/// at any strain; rigid motions cost nothing.
///
/// A step takes the strain as growing evenly. At one point of the path (s, 1) the stress is the mean over the step for
/// a growth of (G_s - G_0)/s, at more points and without a path that at the point's own time. Each has a potential in
/// G_s with a symmetric Hessian; midpoint and average force are of second order. pass() integrates the branches for the
/// true growth G_1 - G_0; the difference in work is the scheme's, of third order a step.
template <int D>
class PronyTerm : public HistoryTerm {
 public:
  /// @param solid  finished, with the slow law. @throws common::Error for the series
  PronyTerm(std::shared_ptr<const mpm::Discretisation<D>> solid, elasticity::PronySeries series, int region = 0,
            int first = 0);

  std::string name() const override { return "memory of the material"; }
  int region() const override { return particles_.region(); }
  /// Components xx, yy (zz), xy (yz, xz) of q, by particle and branch.
  int historyCount() const override;
  std::shared_ptr<const Memory> keepWith(const Point& start, const Eigen::VectorXd& history) const override;
  Passed pass(const Point& end) const override;
  double storedIn(const Eigen::VectorXd& history) const override;
  void evaluate(const Point& at, Order order, Sum& sum) const override;

 private:
  static constexpr int COMPONENTS = D * (D + 1) / 2;
  struct Start;
  int branches() const { return static_cast<int>(series_.branches.size()); }
  int place(std::size_t particle, int branch) const {
    return (static_cast<int>(particle) * branches() + branch) * COMPONENTS;
  }
  double weightOf(int branch) const { return series_.branches[branch].share / series_.slow(); }
  /// @param share, weight  of a point of the path; @param past, now  by branch: factors of q_k and of G_s - G_0
  void evaluateAt(const Eigen::VectorXd& y, const Start& start, double share, double weight,
                  const Eigen::VectorXd& past, double now, Order order, Sum& sum) const;

  GreenParticles<D> particles_;
  elasticity::PronySeries series_;
};

}  // namespace snapwing::solver
