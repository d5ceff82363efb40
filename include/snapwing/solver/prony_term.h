#pragma once
/// Terms with internal variables that persist between steps, and finite viscoelasticity as such a term.

#include <memory>

#include "snapwing/elasticity/prony_series.h"
#include "snapwing/solver/green_particles.h"

namespace snapwing::solver {

/// A term of a step whose internal variables belong to the state of motion. They are zero after a long rest.
class HistoryTerm : public Term {
 public:
  /// Internal variables after a step.
  struct Passed {
    Eigen::VectorXd history;  ///< at the end, (historyCount() x 1)
    double stored = 0;        ///< their energy at the end [J]
    double loss = 0;          ///< dissipated in the step [J] >= 0
  };
  Role role() const override { return Role::DISSIPATION; }
  virtual int historyCount() const = 0;
  /// Called instead of keep(), with the internal variables at the step's start. @param history  (historyCount() x 1)
  virtual std::shared_ptr<const Memory> keepWith(const Point& start, const Eigen::VectorXd& history) const = 0;
  /// Integrates the internal variables over a step. @param end  of the step, with Point::kept
  virtual Passed pass(const Point& end) const = 0;
  virtual double storedIn(const Eigen::VectorXd& history) const = 0;  ///< [J]
};

/// Finite viscoelasticity: Maxwell branches (a spring and a dashpot in series) in parallel with the solid's elastic
/// law, linear in Green's strain G:
///   S = S_law(F) + sum_k w_k C q_k,   dq_k/dt = dG/dt - q_k / time_k,   w_k = share_k / slow,
/// C: moduli of the elastic law at rest. The solid's law has the slow modulus. Stored energy sum w/2 q:C:q, power lost
/// sum w/time q:C:q >= 0 at any strain, per volume. Rigid motions are not affected.
///
/// In a step the strain is taken to grow linearly in time. With one point (s, 1) in Step::path the stress is the mean
/// over the step for a growth of (G_s - G_0)/s. With several points, or none, it is the stress at the time of each
/// point. Each has a potential in G_s with a symmetric Hessian; midpoint and average force are of second order. pass()
/// integrates the branches for the actual growth G_1 - G_0; the difference in work is an error of the scheme, of third
/// order in a step.
template <int D>
class PronyTerm : public HistoryTerm {
 public:
  /// @param solid  finished, with the slow law; @param region, first  as of ElasticTerm
  /// @throws common::Error for an invalid series
  PronyTerm(std::shared_ptr<const mpm::Discretisation<D>> solid, elasticity::PronySeries series, int region = 0,
            int first = 0);

  std::string name() const override { return "memory of the material"; }
  int region() const override { return particles_.region(); }
  /// Number of components xx, yy (zz), xy (yz, xz) of q, stored by particle and branch.
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
  /// @param share, weight  of a point of the path; @param past  factor of q_k by branch; @param now  factor of G_s -
  /// G_0
  void evaluateAt(const Eigen::VectorXd& y, const Start& start, double share, double weight,
                  const Eigen::VectorXd& past, double now, Order order, Sum& sum) const;

  GreenParticles<D> particles_;
  elasticity::PronySeries series_;
};

}  // namespace snapwing::solver
