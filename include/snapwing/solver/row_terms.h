#pragma once
/// Terms of one linear function of the coordinates, g = row . y [m]: what bodies on an axis, joints and stops need
/// beside the solids. Each couples the coordinates of its row and nothing else.

#include <string>

#include "snapwing/solver/row.h"
#include "snapwing/solver/term.h"

namespace snapwing::solver {

/// What the terms of a row share.
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

/// Inertia of a mass that moves by g: kappa/2 m (g - g0 - h g0')^2.
class RowInertia : public RowTerm {
 public:
  /// @param mass  [kg] >= 0. @throws common::Error
  RowInertia(std::string name, Row row, double mass);
  void evaluate(const Point& at, Order order, Sum& sum) const override;

 private:
  double mass_;
};

/// Spring of a stiffness k that is at rest where g = 0: k g^2 / 2.
class RowSpring : public RowTerm {
 public:
  /// @param stiffness  [N/m] >= 0. @throws common::Error
  RowSpring(std::string name, Row row, double stiffness);
  void evaluate(const Point& at, Order order, Sum& sum) const override;

 private:
  double stiffness_;
};

/// Viscous: h c/2 v^2, v = (g - g0) / h.
class RowDamper : public RowTerm {
 public:
  /// @param damping  c [N s/m] >= 0. @throws common::Error
  RowDamper(std::string name, Row row, double damping);
  void evaluate(const Point& at, Order order, Sum& sum) const override;

 private:
  double damping_;
};

/// Drag k |w| w against w = v - wind, v the step's mean speed: h k/3 |w|^3.
class RowDrag : public RowTerm {
 public:
  /// @param coefficient  k = rho CdA / 2 [N s2/m2] >= 0; @param wind  along the row [m/s]. @throws common::Error
  RowDrag(std::string name, Row row, double coefficient, double wind = 0);
  void evaluate(const Point& at, Order order, Sum& sum) const override;

 private:
  double coefficient_, wind_;
};

/// Coulomb friction, smooth within a speed: h f (sqrt(v^2 + v_0^2) - v_0), whose force is f v / sqrt(v^2 + v_0^2).
class RowFriction : public RowTerm {
 public:
  /// @param force  f [N] >= 0; @param speed  v_0 [m/s] > 0. @throws common::Error
  RowFriction(std::string name, Row row, double force, double speed);
  void evaluate(const Point& at, Order order, Sum& sum) const override;

 private:
  double force_, speed_;
};

/// A stop that holds g up: k/2 (gap - g)^2 where g < gap.
class RowStop : public RowTerm {
 public:
  /// @param stiffness  k [N/m] > 0. @throws common::Error
  RowStop(std::string name, Row row, double gap, double stiffness);
  void evaluate(const Point& at, Order order, Sum& sum) const override;

 private:
  double gap_, stiffness_;
};

/// Dashpot beside a stop of stiffness k that lets a mass m bounce off with `restitution` times its speed [N s/m]:
/// c = 2 zeta sqrt(k m), zeta = -ln e / sqrt(pi^2 + ln^2 e).
/// @param restitution  e in (0, 1]. @throws common::Error naming the term
double stopDamping(const std::string& term, double stiffness, double mass, double restitution);

/// Loss of a stop: h c/2 v^2 while the step begins behind the gap.
class RowStopLoss : public RowTerm {
 public:
  /// c is stopDamping. @param restitution  e in (0, 1]; @param mass  that bounces [kg] > 0. @throws common::Error
  RowStopLoss(std::string name, Row row, double gap, double stiffness, double mass, double restitution);
  void evaluate(const Point& at, Order order, Sum& sum) const override;
  double damping() const { return damping_; }  ///< c [N s/m]

 private:
  double gap_, damping_ = 0;
};

}  // namespace snapwing::solver
