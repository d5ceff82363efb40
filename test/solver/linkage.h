#pragma once
/// Rigid bodies in the plane, pinned to each other and to the ground, with weight along -y: a problem of terms.

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "snapwing/solver/equilibrium.h"
#include "snapwing/solver/rigid_inertia_term.h"
#include "snapwing/solver/term_problem.h"

namespace snapwing::solver::testing_linkages {

constexpr double GRAVITY = 9.81, LENGTH = 0.05;  // [m/s2], [m]

struct Bar {
  Eigen::Vector2d from, to;  ///< rest [m]; centre in the middle
  double mass = 0.1;         ///< [kg]
  Eigen::Vector2d centre() const { return 0.5 * (from + to); }
  double inertia() const { return mass * (to - from).squaredNorm() / 12; }  ///< about the centre [kg m2]
};
/// The same point of two bars at rest; second -1: of the ground.
struct Pin {
  std::string name;
  int first, second;
  Eigen::Vector2d at;
};

/// Weight of all bars: linear in c and E.
class Weights : public Term {
 public:
  explicit Weights(const std::vector<Bar>& bars) : load_(Eigen::VectorXd::Zero(6 * bars.size())) {
    const auto count = static_cast<int>(bars.size());
    for (int k = 0; k < count; ++k) {
      load_(2 * k + 1) = bars[k].mass * GRAVITY;
      for (int j = 0; j < 2; ++j)
        load_(2 * count + 4 * k + 1 + 2 * j) = bars[k].mass * GRAVITY * bars[k].centre()(j) / LENGTH;
    }
  }
  std::string name() const override { return "weights"; }
  Role role() const override { return Role::LOAD; }
  void evaluate(const Point& at, Order order, Sum& sum) const override {
    sum.energy += load_.dot(at.y);
    if (order == Order::ENERGY) return;
    sum.gradient += load_;
    sum.noteForce(load_.norm());
  }
  double energy(const Eigen::VectorXd& y) const { return load_.dot(y); }

 private:
  Eigen::VectorXd load_;
};

struct Linkage {
  std::vector<std::shared_ptr<const RigidInertiaTerm>> inertia;
  std::shared_ptr<const Weights> weights;
  std::shared_ptr<const TermProblem> problem;
  int redundant = 0;

  /// Rotation of a bar [rad] in (-pi, pi].
  double angle(const Eigen::VectorXd& y, int bar) const {
    const int first = 2 * static_cast<int>(inertia.size()) + 4 * bar;
    return std::atan2(y(first + 1), LENGTH + y(first));
  }
  double kinetic(const Eigen::VectorXd& v) const {
    double sum = 0;
    for (const auto& term : inertia) sum += term->kineticEnergy(v);
    return sum;
  }
};

/// @param keep  pins as equations; else eliminated, but for what closes chains
inline Linkage makeLinkage(const std::vector<Bar>& bars, const std::vector<Pin>& pins, bool keep,
                           Enforcement enforcement = Enforcement::MULTIPLIERS, double penalty = 10) {
  const auto count = static_cast<int>(bars.size());
  Linkage result;
  std::vector<Rotation> rotations;
  for (int k = 0; k < count; ++k) rotations.push_back({2 * count + 4 * k, LENGTH, {Eigen::Vector3d::UnitZ()}});
  std::vector<Equation> equations;
  for (const Pin& pin : pins) {
    for (int i = 0; i < 2; ++i) {
      Equation e;
      e.name = pin.name;
      e.keepable = true;
      const auto add = [&](int bar, double sign) {
        e.terms.emplace_back(2 * bar + i, sign);
        for (int j = 0; j < 2; ++j) e.terms.emplace_back(2 * count + 4 * bar + i + 2 * j, sign * pin.at(j) / LENGTH);
      };
      add(pin.first, 1);
      if (pin.second >= 0) add(pin.second, -1);
      equations.push_back(e);
    }
  }
  SplitEquations split = splitEquations(6 * count, 0, equations, keep, 2 * count, count, 4);
  auto coordinates = std::make_shared<const Coordinates>(split.eliminated, 2, rotations);
  TermProblem::Parts parts{HessianLayout(6 * count), coordinates, {}, 1, 1e-12, 0};
  for (int k = 0; k < count; ++k) {
    const Eigen::Vector2d c = bars[k].centre();
    const double turning = 0.5 * bars[k].inertia();  // half about each axis of the plane
    result.inertia.push_back(std::make_shared<const RigidInertiaTerm>(
        "bar", 2, 2 * k, rotations[k],
        RigidMass::of(bars[k].mass, {c(0), c(1), 0}, Eigen::Vector3d(turning, turning, 2 * turning).asDiagonal())));
    parts.terms.push_back(result.inertia.back());
  }
  result.weights = std::make_shared<const Weights>(bars);
  parts.terms.push_back(result.weights);
  if (split.kept.count() > 0) {
    result.redundant = redundantRows(*coordinates, split.kept, 1e-4);
    parts.constraints = std::make_shared<const Constraints>(split.kept, enforcement, penalty, 1e-15, result.redundant);
  }
  result.problem = std::make_shared<const TermProblem>(std::move(parts));
  return result;
}

}  // namespace snapwing::solver::testing_linkages
