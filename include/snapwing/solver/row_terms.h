#pragma once
/// Terms of one linear function of the full coordinates, g = row . y [m], for bodies on an axis, joints and stops. Each
/// term couples only the coordinates of its row. Index 0: at the step's start; h [s]: length of the step.

#include <string>

#include "snapwing/solver/row.h"
#include "snapwing/solver/term.h"

namespace snapwing::solver {

/// Base of the terms of one row.
class RowTerm : public Term {
 public:
  RowTerm(std::string name, Role role, Row row) : name_(std::move(name)), role_(role), row_(std::move(row)) {}
  std::string name() const override { return name_; }
  Role role() const override { return role_; }
  std::vector<std::vector<int>> couples() const override { return {row_.coordinates()}; }
  const Row& row() const { return row_; }

 protected:
  /// Adds an energy [J], its slope [N] and curvature [N/m] by g.
  void add(const Point& at, double energy, double slope, double curvature, Order order, Sum& sum) const;

  std::string name_;
  Role role_;
  Row row_;
};

/// Inertia of a mass m whose displacement is g: kappa/2 m (g - g0 - h g0')^2, kappa as in Step. Zero in statics.
class RowInertia : public RowTerm {
 public:
  /// @param mass  [kg] >= 0. @throws common::Error
  RowInertia(std::string name, Row row, double mass);
  void evaluate(const Point& at, Order order, Sum& sum) const override;

 private:
  double mass_;
};

/// Linear spring of stiffness k, unloaded at g = 0: k g^2 / 2.
class RowSpring : public RowTerm {
 public:
  /// @param stiffness  [N/m] >= 0. @throws common::Error
  RowSpring(std::string name, Row row, double stiffness);
  bool linearInStatics() const override { return true; }
  void evaluate(const Point& at, Order order, Sum& sum) const override;

 private:
  double stiffness_;
};

/// Viscous damper: h c/2 v^2, v = (g - g0) / h. Zero in statics.
class RowDamper : public RowTerm {
 public:
  /// @param damping  c [N s/m] >= 0. @throws common::Error
  RowDamper(std::string name, Row row, double damping);
  void evaluate(const Point& at, Order order, Sum& sum) const override;

 private:
  double damping_;
};

/// Quadratic drag, force k |w| w at the relative speed w = (g - g0) / h - wind: h k/3 |w|^3. Zero in statics.
class RowDrag : public RowTerm {
 public:
  /// @param coefficient  k = rho CdA / 2 [N s2/m2] >= 0; @param wind  along the row [m/s]. @throws common::Error
  RowDrag(std::string name, Row row, double coefficient, double wind = 0);
  void evaluate(const Point& at, Order order, Sum& sum) const override;

 private:
  double coefficient_, wind_;
};

/// Coulomb friction, regularised below the speed v_0: h f (sqrt(v^2 + v_0^2) - v_0), v = (g - g0) / h. Its force is
/// f v / sqrt(v^2 + v_0^2). Zero in statics.
class RowFriction : public RowTerm {
 public:
  /// @param force  f [N] >= 0; @param speed  v_0 [m/s] > 0. @throws common::Error
  RowFriction(std::string name, Row row, double force, double speed);
  void evaluate(const Point& at, Order order, Sum& sum) const override;

 private:
  double force_, speed_;
};

/// Unilateral stop: k/2 (gap - g)^2 where g < gap, else 0.
class RowStop : public RowTerm {
 public:
  /// @param gap  of g at contact [m], finite; @param stiffness  k [N/m] > 0. @throws common::Error
  RowStop(std::string name, Row row, double gap, double stiffness);
  void evaluate(const Point& at, Order order, Sum& sum) const override;

 private:
  double gap_, stiffness_;
};

/// Damping [N s/m] in parallel with a stop of stiffness k from which a mass m rebounds at `restitution` times its
/// speed: c = 2 zeta sqrt(k m), zeta = -ln e / sqrt(pi^2 + ln^2 e), the half period of a damped oscillator.
/// @param term  name in messages; @param stiffness  k [N/m] > 0; @param mass  m [kg] > 0
/// @param restitution  e in (0, 1]. @throws common::Error naming the term
double stopDamping(const std::string& term, double stiffness, double mass, double restitution);

/// Loss of a stop: h c/2 v^2, v = (g - g0) / h, in steps that begin in contact (g0 < gap). Zero in statics.
class RowStopLoss : public RowTerm {
 public:
  /// c = stopDamping(name, stiffness, mass, restitution). @param gap  of g at contact [m]. @throws common::Error
  RowStopLoss(std::string name, Row row, double gap, double stiffness, double mass, double restitution);
  void evaluate(const Point& at, Order order, Sum& sum) const override;
  double damping() const { return damping_; }  ///< c [N s/m]

 private:
  double gap_, damping_ = 0;
};

}  // namespace snapwing::solver
