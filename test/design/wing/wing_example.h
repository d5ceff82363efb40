#pragma once
/// The shipped paper configuration with a small search, and other random feasible layouts, for the wing's tests.

#include <random>
#include <string>

#include "snapwing/design/wing/wing_design.h"
#include "support/paths.h"

namespace snapwing::design {

inline std::string paperFile() { return test::sourceDir() + "/config/designs/wing_paper.yaml"; }

inline WingSettings paperSettings() { return loadWingSettings(paperFile()); }

/// Designed once with the shipped settings; every test reads the same one.
inline const WingDesign& paperDesign() {
  static const WingDesign design = designWing(RigidWingProblem(paperSettings()));
  return design;
}

inline Eigen::Vector4d variablesOf(const FourBar& bar) {
  return {bar.joint1.x(), bar.joint1.y(), bar.joint2.x(), bar.joint2.y()};
}

/// Random layouts that close from rest to `largest` with a transmission angle above `margin`.
inline std::vector<FourBar> randomFeasible(int count, double largest, double margin, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> place(-0.08, 0.09);
  std::vector<FourBar> found;
  for (int i = 0; i < 100000 && static_cast<int>(found.size()) < count; ++i) {
    FourBar bar;
    bar.joint1 = {place(rng), place(rng)};
    bar.joint2 = {place(rng), place(rng)};
    bar.tip = {0.155, 0.020};
    if (bar.crankLength() < 0.012 || bar.couplerLength() < 0.012 || bar.rockerLength() < 0.012) continue;
    const TravelCheck check = checkTravel(bar, largest);
    if (check.closes && check.smallest_transmission > margin) found.push_back(bar);
  }
  return found;
}

/// Worst relative error of the gradient by central differences.
inline double slopeError(const WingProblem& problem, const Eigen::Vector4d& X, double step) {
  const WingEvaluation at = problem.evaluate(X, true);
  double worst = 0;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector4d e = step * Eigen::Vector4d::Unit(i);
    const WingEvaluation high = problem.evaluate(X + e, false), low = problem.evaluate(X - e, false);
    worst = std::max(worst, std::abs((high.objective - low.objective) / (2 * step) - at.gradient[i]) /
                                at.gradient.cwiseAbs().maxCoeff());
    const Eigen::VectorXd rows = (high.constraints - low.constraints) / (2 * step) - at.jacobian.col(i);
    worst = std::max(worst, rows.cwiseAbs().maxCoeff() / at.jacobian.cwiseAbs().maxCoeff());
  }
  return worst;
}

}  // namespace snapwing::design
