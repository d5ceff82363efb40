#include "snapwing/statics/singular.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace snapwing::statics {

Chord::Chord(const solver::Equilibrium& a, const solver::Equilibrium& b) : a_(a), b_(b), normal_(b.z - a.z) {
  normal_ /= std::max(normal_.squaredNorm(), 1e-300);
}

solver::BranchPlane Chord::plane(double s) const {
  solver::BranchPlane plane;
  plane.origin = a_.z;
  plane.normal = normal_;
  plane.control = a_.p(0);
  plane.distance = s;
  return plane;
}

solver::Equilibrium Chord::guess(double s) const {
  solver::Equilibrium x;
  x.p = a_.p + s * (b_.p - a_.p);
  x.z = a_.z + s * (b_.z - a_.z);
  x.multipliers = a_.multipliers + s * (b_.multipliers - a_.multipliers);
  return x;
}

double Chord::controlRate(const solver::Equilibrium& x) const { return 1 / normal_.dot(x.slope); }

/// Finite at limit points as well, where stiffness and slope are not.
double Chord::forceRate(const solver::Equilibrium& x) const { return x.stiffness / normal_.dot(x.slope); }

namespace {

/// One end of the bracket: share of the chord, point, lowest eigenvalue and its mode.
struct End {
  double s = 0, eigenvalue = 0;
  solver::Equilibrium x;
  Eigen::VectorXd mode;
};

End makeEnd(solver::EquilibriumSolver& solver, double s, solver::Equilibrium x) {
  End end;
  end.s = s;
  end.x = std::move(x);
  solver.linearise(end.x);
  end.eigenvalue = solver.softestMode(end.x, end.mode);
  return end;
}

/// Secant where both ends see the same mode change its sign, else the middle.
double nextShare(const End& low, const End& high) {
  const bool same = std::abs(low.mode.dot(high.mode)) > 0.9 && low.eigenvalue * high.eigenvalue < 0;
  double share = 0.5;
  if (same) share = low.eigenvalue / (low.eigenvalue - high.eigenvalue);
  return low.s + std::min(0.98, std::max(0.02, share)) * (high.s - low.s);
}

/// At a limit point the control stands still. Judged a little aside: at a bifurcation itself rounding spoils the slope.
double controlRateNear(solver::EquilibriumSolver& solver, const Chord& chord, const solver::Equilibrium& a,
                       const solver::Equilibrium& b, double s) {
  constexpr double ASIDE = 1e-3;
  s += s > 0.5 ? -ASIDE : ASIDE;
  solver::Equilibrium x = chord.guess(s);
  if (!solver.correctOn(chord.plane(s), x).converged()) return 0;
  const double around = std::max(std::abs(chord.controlRate(a)), std::abs(chord.controlRate(b)));
  return around > 0 ? std::abs(chord.controlRate(x)) / around : 0;
}

void describe(const End& low, const End& high, SingularPoint& found) {
  const End& near = std::abs(low.eigenvalue) < std::abs(high.eigenvalue) ? low : high;
  found.point = near.x;
  found.eigenvalue = near.eigenvalue;
  const double load = near.x.load.norm();
  found.load_share = load > 0 ? std::abs(near.mode.dot(near.x.load)) / load : 0;
  Eigen::Index largest = 0;
  near.mode.cwiseAbs().maxCoeff(&largest);
  found.mode = near.mode / near.mode(largest);
  found.accuracy = std::abs(high.x.p(0) - low.x.p(0));
}

}  // namespace

bool locateSingular(solver::EquilibriumSolver& solver, const solver::Equilibrium& a, const solver::Equilibrium& b,
                    SingularPoint& found, std::string& why) {
  constexpr int MOST = 60;
  constexpr double NARROW = 1e-9, SOFT = 1e-9;
  const Chord chord(a, b);
  End low = makeEnd(solver, 0, a), high = makeEnd(solver, 1, b);
  const solver::Equilibrium first = low.x, last = high.x;
  found.before = low.x.negative_pivots;
  found.after = high.x.negative_pivots;
  const double stiff = std::max(std::abs(low.eigenvalue), std::abs(high.eigenvalue));
  for (int k = 0; k < MOST && high.s - low.s > NARROW; ++k) {
    if (std::min(std::abs(low.eigenvalue), std::abs(high.eigenvalue)) < SOFT * stiff) break;
    // Every third step halves, so that one slow end cannot hold up the bracket.
    const double s = k % 3 == 2 ? 0.5 * (low.s + high.s) : nextShare(low, high);
    solver::Equilibrium x = chord.guess(s);
    const solver::NewtonResult result = solver.correctOn(chord.plane(s), x);
    // Rounding hides the sign of a pivot very near the point itself.
    if (result.status == solver::SolveStatus::SINGULAR && high.s - low.s < 1e-3) break;
    if (!result.converged()) {
      std::ostringstream text;
      text << "the corrector lost the branch between controls " << low.x.p(0) << " and " << high.x.p(0) << ": "
           << result.message;
      why = text.str();
      return false;
    }
    End end = makeEnd(solver, s, std::move(x));
    (end.x.negative_pivots == found.before ? low : high) = std::move(end);
  }
  describe(low, high, found);
  found.point.at.hessian.clear();  // large, and not needed any more
  found.point.at.sum = {};
  found.control_rate = controlRateNear(solver, chord, first, last, 0.5 * (low.s + high.s));
  found.kind = found.control_rate < 0.02 ? SingularKind::LIMIT_POINT : SingularKind::BIFURCATION;
  return true;
}

solver::NewtonResult switchBranch(solver::EquilibriumSolver& solver, const SingularPoint& from, double amount,
                                  solver::Equilibrium& found) {
  solver::BranchPlane plane;
  plane.origin = from.point.z;
  plane.normal = from.mode / from.mode.squaredNorm();
  plane.control = from.point.p(0);
  plane.distance = amount;
  found = from.point;
  found.z += amount * from.mode;
  return solver.correctOn(plane, found);
}

}  // namespace snapwing::statics
