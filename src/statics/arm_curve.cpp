#include <algorithm>
#include <cmath>

#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"
#include "snapwing/statics/arm_problem.h"

namespace snapwing::statics {

namespace {

void append(vehicle::ForceTable& table, const ArmProblem& arm, const PathPoint& point) {
  table.travel.push_back(point.control);
  table.force.push_back(point.force);
  table.stiffness.push_back(point.stiffness);
  table.energy.push_back(point.energy);
  table.rotation.push_back(arm.rotation(point.solution, point.control));
  table.min_det_f.push_back(point.min_det_f);
  table.stable.push_back(point.stable ? 1 : 0);
  table.iterations.push_back(point.iterations);
  const mpm::MovingMass inertia = arm.movingMass(point.slope);
  table.mass = inertia.mass;
  table.kinetic_mass.push_back(inertia.kinetic);
  table.coupled_mass.push_back(inertia.coupled);
  table.shapes.moved.push_back(arm.movedShapes(point.solution, point.control));
}

void addCosts(ArmCurve& curve, const PathResult& path) {
  curve.iterations += path.iterations;
  curve.factorizations += path.factorizations;
  curve.projections += path.projections;
  curve.halvings += path.halvings;
  curve.seconds += path.seconds;
  curve.seconds_assembly += path.seconds_assembly;
  curve.seconds_factor += path.seconds_factor;
  curve.seconds_solve += path.seconds_solve;
  curve.seconds_analysis += path.seconds_analysis;
  if (curve.status == solver::SolveStatus::NOT_SOLVED || path.status != solver::SolveStatus::CONVERGED) {
    curve.status = path.status;
    curve.message = path.message;
  }
}

std::vector<double> steps(double to, double step) {
  const int count = static_cast<int>(std::ceil(std::abs(to) / step - 1e-9));
  std::vector<double> result;
  for (int k = 0; k <= count; ++k) result.push_back(to * k / std::max(count, 1));
  return result;
}

}  // namespace

void ArmCurveSettings::validate() const {
  const auto refuse = [](const char* name, double value, const char* allowed) {
    throw common::Error(std::string(name) + " is " + common::toText(value) + " m; allowed: " + allowed);
  };
  if (!(from <= 0)) refuse("from", from, "<= 0");
  if (!(to > 0)) refuse("to", to, "> 0");
  if (!(step > 0 && step <= to / 3)) refuse("step", step, "> 0 and at most a third of 'to'");
}

ArmCurve traceArm(const ArmProblem& arm, const ArmCurveSettings& settings) {
  settings.validate();
  ArmCurve curve;
  curve.table.shapes.rest = arm.restShapes();
  const std::vector<double> forward = steps(settings.to, settings.step);
  const std::vector<double> below = steps(settings.from, settings.step);
  const double total = static_cast<double>(forward.size() * (settings.back ? 2 : 1) + below.size());
  double finished = 0;
  const auto follow = [&](const Eigen::VectorXd& start, const std::vector<double>& targets) {
    PathSettings path = settings.path;
    path.progress = [&](int point) {
      return settings.progress && settings.progress((finished + point + 1) / total, targets[point]);
    };
    PathResult result = PathFollower(arm.problem(), path).follow(start, targets);
    finished += static_cast<double>(targets.size());
    addCosts(curve, result);
    return result;
  };

  const PathResult up = follow(Eigen::VectorXd::Zero(arm.problem().freeCount()), forward);
  if (up.points.empty()) return curve;
  if (below.size() > 1 && curve.status == solver::SolveStatus::CONVERGED) {
    const PathResult down = follow(up.points.front().solution, below);
    for (std::size_t k = down.points.size(); k-- > 1;) append(curve.table, arm, down.points[k]);
  }
  if (settings.locate && curve.status == solver::SolveStatus::CONVERGED) {
    curve.located = locateFeaturesOf(arm.problem(), settings.path.newton, up.points);
  }
  const std::size_t first = curve.table.travel.size();
  for (const PathPoint& point : up.points) append(curve.table, arm, point);
  if (settings.back && curve.status == solver::SolveStatus::CONVERGED) {
    const PathResult back = follow(up.points.back().solution, std::vector<double>(forward.rbegin(), forward.rend()));
    if (back.status != solver::SolveStatus::CONVERGED) return curve;
    // Below zero there is no way back of its own: the curve is reversible there by construction.
    curve.table.force_back = curve.table.force;
    const std::size_t count = back.points.size();
    for (std::size_t k = 0; k < count; ++k) curve.table.force_back[first + k] = back.points[count - 1 - k].force;
  }
  return curve;
}

}  // namespace snapwing::statics
