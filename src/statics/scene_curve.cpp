#include "snapwing/statics/scene_curve.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace snapwing::statics {

std::string SceneCurve::csv(const Scene& scene) const {
  std::ostringstream text;
  text.precision(12);
  text << (scene.control_is_length ? "displacement_m,force_N,stiffness_N_per_m"
                                   : "load_factor,work_per_factor_J,slope_J")
       << ",energy_J,stable,negative_pivots,min_det_f,iterations";
  for (const SceneMonitor& m : scene.monitors) text << "," << m.name << (m.radius > 0 ? "_rad" : "_m");
  if (!back.points.empty()) text << ",force_back_N";
  text << "\n";
  for (std::size_t k = 0; k < path.points.size(); ++k) {
    const PathPoint& p = path.points[k];
    text << p.control << "," << multiplicity * p.force << "," << multiplicity * p.stiffness << ","
         << multiplicity * p.energy << "," << (p.stable ? 1 : 0) << "," << p.negative_pivots << "," << p.min_det_f
         << "," << p.iterations;
    for (const double value : monitors[k]) text << "," << value;
    if (!back.points.empty()) {
      const std::size_t last = back.points.size();
      const bool reached = path.points.size() - 1 - k < last;
      text << ",";
      if (reached) text << multiplicity * back.points[path.points.size() - 1 - k].force;
    }
    text << "\n";
  }
  return text.str();
}

common::ForceTable SceneCurve::table() const {
  common::ForceTable t;
  const bool down = !path.points.empty() && path.points.back().control < 0;
  for (std::size_t n = 0; n < path.points.size(); ++n) {
    const PathPoint& p = path.points[down ? path.points.size() - 1 - n : n];
    t.travel.push_back(p.control);
    t.force.push_back(multiplicity * p.force);
    t.stiffness.push_back(multiplicity * p.stiffness);
    t.energy.push_back(multiplicity * p.energy);
    t.rotation.push_back(0);
    t.min_det_f.push_back(p.min_det_f);
    t.stable.push_back(p.stable ? 1 : 0);
    t.iterations.push_back(p.iterations);
  }
  if (!back.points.empty() && back.points.size() == path.points.size()) {
    for (const PathPoint& p : back.points) t.force_back.push_back(multiplicity * p.force);
    if (!down) std::reverse(t.force_back.begin(), t.force_back.end());
  }
  return t;
}

SceneCurve traceScene(const Scene& scene, const CompiledScene& compiled, PathSettings settings,
                      const std::function<bool(double, double)>& progress) {
  std::vector<double> targets;
  for (int k = 0; k <= scene.steps; ++k) targets.push_back(scene.to * k / scene.steps);
  SceneCurve curve;
  curve.multiplicity = compiled.multiplicity();
  const double total = static_cast<double>(targets.size()) * (scene.back ? 2 : 1);
  double before = 0;
  const auto follow = [&](const Eigen::VectorXd& start, const std::vector<double>& goals) {
    settings.progress = [&](int point) { return progress && progress((before + point + 1) / total, goals[point]); };
    PathResult result = PathFollower(compiled.problem(), settings).follow(start, goals);
    before += static_cast<double>(goals.size());
    return result;
  };
  curve.path = follow(Eigen::VectorXd::Zero(compiled.problem().freeCount()), targets);
  for (const PathPoint& p : curve.path.points) curve.monitors.push_back(compiled.monitors(p.solution, p.control));
  if (scene.back && curve.path.status == SolveStatus::CONVERGED) {
    std::reverse(targets.begin(), targets.end());
    curve.back = follow(curve.path.points.back().solution, targets);
  }
  return curve;
}

SceneCurve traceSceneByArc(const Scene& scene, const CompiledScene& compiled, const NewtonSettings& newton,
                           int max_points, const std::function<bool(double, double)>& progress) {
  ArcSettings settings;
  settings.newton = newton;
  settings.first_step = std::abs(scene.to) / scene.steps;
  settings.largest_step = settings.first_step;
  settings.max_points = max_points;
  settings.end = scene.to;
  settings.progress = [&](int, double control) {
    return progress && progress(std::min(0.99, control / scene.to), control);
  };
  SceneCurve curve;
  curve.multiplicity = compiled.multiplicity();
  ArcResult arc = followArc(compiled.problem(), Eigen::VectorXd::Zero(compiled.problem().freeCount()), 0, settings);
  curve.path = std::move(arc.path);
  curve.limit_points = std::move(arc.limit_points);
  curve.crossings = std::move(arc.crossings);
  for (const PathPoint& p : curve.path.points) curve.monitors.push_back(compiled.monitors(p.solution, p.control));
  return curve;
}

}  // namespace snapwing::statics
