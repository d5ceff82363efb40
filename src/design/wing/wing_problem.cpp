#include "snapwing/design/wing/wing_problem.h"

#include <cmath>

#include "linkage_loop.h"
#include "wing_constraint_rows.h"

namespace snapwing::design {

using Eigen::Vector4d;

namespace {

constexpr int TRANSMISSION_SAMPLES = 13;
constexpr double SOFT = 1e-5;  ///< of h^2; a loop with margin has h^2 above 1e-2: relative error below 1e-7

template <class S>
struct Terms {
  S objective;
  std::vector<S> constraints;
};

template <class S>
S square(const S& a) {
  return a * a;
}

template <class S>
S objectiveOf(const WingSettings& s, const std::array<Loop<S>, 2>& states) {
  S sum(0.0);
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector2d target = s.tipTarget(i);
    sum = sum + square(S(states[i].tip.x - target.x())) + square(S(states[i].tip.y - target.y()));
    sum = sum + square(s.rotation_weight) * square(S(states[i].wing_rotation - s.wantedRotation(i)));
  }
  const double wanted = s.wantedRotation(1) - s.wantedRotation(0);
  return sum + square(s.dwell_weight) * square(S(states[1].wing_rotation - states[0].wing_rotation - wanted));
}

template <class S>
std::vector<S> constraintsOf(const WingSettings& s, const LoopFrame& frame, const Plane<S>& X1, const Plane<S>& X2,
                             const Loop<S>& second) {
  using std::sqrt;
  const Plane<S> b{S(frame.bx), S(frame.by)};
  const Plane<S> between = X1 - X2, rocker = X2 - b;
  std::vector<S> all;  // in the order of WingConstraintRow
  all.push_back((s.separation - sqrt(dot(between, between))) / CONSTRAINT_LENGTH);
  all.push_back((s.wall_joint2_x - second.joint2.x) / CONSTRAINT_LENGTH);
  all.push_back((second.joint1.y - s.wall_joint1_y) / CONSTRAINT_LENGTH);
  all.push_back((s.min_bar_length - sqrt(dot(X1, X1))) / CONSTRAINT_LENGTH);
  all.push_back((s.min_bar_length - sqrt(dot(rocker, rocker))) / CONSTRAINT_LENGTH);
  const S coupler2 = dot(between, between), rocker2 = dot(rocker, rocker);
  const double most = std::pow(std::cos(s.transmission_margin), 2);
  for (int k = 0; k < TRANSMISSION_SAMPLES; ++k) {
    const double theta = s.targets[1].arm_rotation * k / (TRANSMISSION_SAMPLES - 1);
    const Plane<S> d = b - turned(X1, S(frame.crank_sign * theta));
    const S c = coupler2 + rocker2 - dot(d, d);
    all.push_back(0.25 * c * c / (coupler2 * rocker2) - most);
  }
  return all;
}

template <class S>
Terms<S> termsAt(const WingSettings& s, const LoopFrame& frame, const Plane<S>& X1, const Plane<S>& X2) {
  const std::array<Loop<S>, 2> states{closeLoop(frame, X1, X2, S(s.targets[0].arm_rotation), SOFT),
                                      closeLoop(frame, X1, X2, S(s.targets[1].arm_rotation), SOFT)};
  return {objectiveOf(s, states), constraintsOf(s, frame, X1, X2, states[1])};
}

}  // namespace

int WingProblem::constraintCount() const { return ROW_TRANSMISSION + TRANSMISSION_SAMPLES; }

FourBar WingProblem::linkage(const Vector4d& X) const {
  FourBar bar;
  bar.auxiliary = settings_.auxiliary_joint;
  bar.joint1 = X.head<2>();
  bar.joint2 = X.tail<2>();
  bar.tip = settings_.tipAtRest();
  bar.crank_sign = settings_.crank_sign;
  return bar;
}

Vector4d WingProblem::low() const {
  return {settings_.joint1_box.low.x(), settings_.joint1_box.low.y(), settings_.joint2_box.low.x(),
          settings_.joint2_box.low.y()};
}

Vector4d WingProblem::high() const {
  return {settings_.joint1_box.high.x(), settings_.joint1_box.high.y(), settings_.joint2_box.high.x(),
          settings_.joint2_box.high.y()};
}

WingEvaluation RigidWingProblem::evaluate(const Vector4d& X, bool with_derivatives) const {
  const LoopFrame frame = LoopFrame::of(linkage(X));
  WingEvaluation e;
  e.constraints.setZero(constraintCount());
  e.jacobian.setZero(constraintCount(), 4);
  if (!with_derivatives) {
    const Terms<double> terms = termsAt(settings_, frame, Plane<double>{X[0], X[1]}, Plane<double>{X[2], X[3]});
    e.objective = terms.objective;
    for (int k = 0; k < constraintCount(); ++k) e.constraints[k] = terms.constraints[k];
    return e;
  }
  using J = Jet<4>;
  const Plane<J> X1{J::variable(X[0], 0), J::variable(X[1], 1)}, X2{J::variable(X[2], 2), J::variable(X[3], 3)};
  const Terms<J> terms = termsAt(settings_, frame, X1, X2);
  e.objective = terms.objective.value;
  e.gradient = terms.objective.gradient;
  for (int k = 0; k < constraintCount(); ++k) {
    e.constraints[k] = terms.constraints[k].value;
    e.jacobian.row(k) = terms.constraints[k].gradient.transpose();
  }
  return e;
}

}  // namespace snapwing::design
