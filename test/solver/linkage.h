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

inline const std::vector<Bar> PENDULUM = {{{0, 0}, {0.1, 0}, 0.12}, {{0.1, 0}, {0.1, -0.14}, 0.2}};
inline const std::vector<Pin> HUNG = {{"shoulder", 0, -1, {0, 0}}, {"elbow", 1, 0, {0.1, 0}}};

/// Crank 30, coupler 80, rocker 60 mm on ground pivots 70 mm apart: the crank goes round.
struct FourBar {
  double crank = 0.03, coupler = 0.08, rocker = 0.06, ground = 0.07;
  /// Angles of coupler and rocker against x at one of the crank.
  Eigen::Vector2d others(double theta) const {
    const Eigen::Vector2d a(crank * std::cos(theta), crank * std::sin(theta)), b(ground, 0), d = b - a;
    const double r = d.norm();
    const double alpha = std::acos((coupler * coupler + r * r - rocker * rocker) / (2 * coupler * r));
    const double phi = std::atan2(d(1), d(0)) + alpha;
    const Eigen::Vector2d c = a + coupler * Eigen::Vector2d(std::cos(phi), std::sin(phi));
    return {phi, std::atan2(c(1), c(0) - ground)};
  }
  std::vector<Bar> bars(double theta) const {
    const Eigen::Vector2d o = others(theta);
    const Eigen::Vector2d a(crank * std::cos(theta), crank * std::sin(theta)), g(ground, 0);
    const Eigen::Vector2d c = g + rocker * Eigen::Vector2d(std::cos(o(1)), std::sin(o(1)));
    return {{Eigen::Vector2d::Zero(), a, 0.05}, {a, c, 0.09}, {g, c, 0.07}};
  }
  std::vector<Pin> pins(double theta) const {
    const std::vector<Bar> b = bars(theta);
    return {{"ground left", 0, -1, b[0].from},
            {"crank pin", 0, 1, b[0].to},
            {"rocker pin", 1, 2, b[1].to},
            {"ground right", 2, -1, b[2].from}};
  }
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
