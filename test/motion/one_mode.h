#pragma once
/// Problems of one or two masses on an axis, for schemes.

#include <memory>
#include <vector>

#include "snapwing/motion/stepper.h"
#include "snapwing/solver/row_terms.h"

namespace snapwing::test {

/// Full coordinates that are all free, without solids.
inline std::shared_ptr<const solver::TermProblem> pointMasses(
    int coordinates, const std::vector<std::shared_ptr<const solver::Term>>& terms, int controls = 0) {
  auto free = std::make_shared<const solver::Coordinates>(solver::Reduction(coordinates, controls, {}));
  return std::make_shared<const solver::TermProblem>(
      solver::TermProblem::Parts{solver::HessianLayout(coordinates), free, terms, 1, 1e-13, 0});
}

inline solver::Row only(int coordinate) { return solver::Row({{coordinate, 1.0}}); }

inline motion::StepperSettings equalSteps(double h, double tolerance = 1e-9) {
  motion::StepperSettings settings;
  settings.largest_step = h;
  settings.relative_tolerance = tolerance;
  return settings;
}

/// A midpoint step of 2 ms from rest at y0.
inline solver::Step stepFrom(const Eigen::VectorXd& y0) {
  solver::Step step;
  step.h = 2e-3;
  step.kappa = 2 / (step.h * step.h);
  step.y0 = y0;
  step.v0 = 0 * y0;
  return step;
}

inline motion::ControlOf nothing() {
  return [](double, double) { return Eigen::VectorXd(); };
}

}  // namespace snapwing::test
