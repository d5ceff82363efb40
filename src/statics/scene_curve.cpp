#include "snapwing/statics/scene_curve.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "snapwing/common/error.h"

namespace snapwing::statics {

namespace {

/// As RFC 4180 has it: quoted if it holds a comma, a quote or a line's end.
std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

std::string SceneCurve::csv(const scene::Scene& scene) const {
  std::ostringstream text;
  text.precision(12);
  text << (scene.control_is_length ? "displacement_m,force_N,stiffness_N_per_m"
                                   : "load_factor,work_per_factor_J,slope_J")
       << ",energy_J,stable,negative_pivots,min_det_f,iterations,by_arc,by_series";
  for (const scene::SceneMonitor& m : scene.monitors) text << "," << csvField(m.name + (m.radius > 0 ? "_rad" : "_m"));
  if (!back.points.empty()) text << ",force_back_N";
  text << "\n";
  for (std::size_t k = 0; k < path.points.size(); ++k) {
    const PathPoint& p = path.points[k];
    text << p.control << "," << multiplicity * p.force << "," << multiplicity * p.stiffness << ","
         << multiplicity * p.energy << "," << (p.stable ? 1 : 0) << "," << p.negative_pivots << "," << p.min_det_f
         << "," << p.iterations << "," << (p.by_arc ? 1 : 0) << "," << (p.by_series ? 1 : 0);
    for (const double value : monitors[k]) text << "," << value;
    if (!back.points.empty()) {
      const auto same = std::find_if(back.points.begin(), back.points.end(), [&](const PathPoint& other) {
        return !other.by_arc && !p.by_arc && other.control == p.control;
      });
      text << ",";
      if (same != back.points.end()) text << multiplicity * same->force;
    }
    text << "\n";
  }
  return text.str();
}

PathResult SceneCurve::costs() const {
  PathResult sum;
  for (const PathResult* run : {&path, &below, &back}) {
    if (run->status == solver::SolveStatus::NOT_SOLVED) continue;
    if (sum.status == solver::SolveStatus::NOT_SOLVED || run->status != solver::SolveStatus::CONVERGED) {
      sum.status = run->status;
      sum.message = run->message;
    }
    for (const auto count : {&PathResult::iterations, &PathResult::factorizations, &PathResult::projections,
                             &PathResult::halvings, &PathResult::series}) {
      sum.*count += run->*count;
    }
    if (sum.no_series.empty()) sum.no_series = run->no_series;
    for (const auto seconds : {&PathResult::seconds, &PathResult::seconds_assembly, &PathResult::seconds_factor,
                               &PathResult::seconds_solve, &PathResult::seconds_analysis}) {
      sum.*seconds += run->*seconds;
    }
  }
  return sum;
}

namespace {

/// Calls visit(run, number) for the points of a table, travel increasing.
template <class Visit>
void eachTablePoint(const SceneCurve& curve, const Visit& visit) {
  const std::vector<PathPoint>& path = curve.path.points;
  const bool down = !path.empty() && path.back().control < path.front().control;
  for (std::size_t k = curve.below.points.size(); k-- > 1;) visit(curve.below, k);
  for (std::size_t n = 0; n < path.size(); ++n) visit(curve.path, down ? path.size() - 1 - n : n);
}

}  // namespace

vehicle::ForceTable SceneCurve::table() const {
  vehicle::ForceTable t;
  eachTablePoint(*this, [&](const PathResult& run, std::size_t k) {
    const PathPoint& p = run.points[k];
    const mpm::MovingMass& moving = &run == &below ? inertia_below[k] : inertia[k];
    const std::vector<double>& seen = &run == &below ? monitors_below[k] : monitors[k];
    t.travel.push_back(p.control);
    t.force.push_back(multiplicity * p.force);
    t.stiffness.push_back(multiplicity * p.stiffness);
    t.energy.push_back(multiplicity * p.energy);
    t.mass = moving.mass;
    t.kinetic_mass.push_back(moving.kinetic);
    t.coupled_mass.push_back(moving.coupled);
    t.rotation.push_back(rotation >= 0 ? seen[rotation] : 0);
    t.min_det_f.push_back(p.min_det_f);
    t.stable.push_back(p.stable ? 1 : 0);
    t.iterations.push_back(p.iterations);
  });
  if (back.points.empty() || back.points.size() != path.points.size()) return t;
  // Below zero there is no way back of its own: the curve is reversible there by construction.
  t.force_back = t.force;
  const std::size_t last = t.force.size() - 1, count = back.points.size();
  const bool down = path.points.back().control < path.points.front().control;
  for (std::size_t k = 0; k < count; ++k) {
    t.force_back[down ? k : last - k] = multiplicity * back.points[k].force;
  }
  return t;
}

vehicle::ArmShapes outlineAlong(const scene::Scene& scene, const scene::CompiledScene& compiled,
                                const SceneCurve& curve, int body) {
  const mpm::DensityField& density = scene.bodies[body].density;
  if (compiled.planar() == nullptr || density.value.empty()) {
    throw common::Error("body '" + scene.bodies[body].name + "' has no outline; allowed: planar, given by a density");
  }
  vehicle::ArmShapes shapes;
  shapes.rest = mpm::outline(density.resampled(scene.cell_size), 0.5);
  eachTablePoint(curve, [&](const PathResult& run, std::size_t k) {
    const PathPoint& p = run.points[k];
    const Eigen::VectorXd u =
        compiled.terms().coordinates().expand(p.solution, Eigen::VectorXd::Constant(1, p.control));
    auto loops = shapes.rest;
    for (auto& loop : loops) {
      for (auto& point : loop) {
        const mpm::Vector<2> moved = compiled.planar()->displacementAt(body, {point[0], point[1]}, u);
        point = {point[0] + moved(0), point[1] + moved(1)};
      }
    }
    shapes.moved.push_back(std::move(loops));
  });
  return shapes;
}

namespace {

/// One or two runs along the scene's path, with what a resumed trace knows already.
class SceneTracer {
 public:
  SceneTracer(const scene::Scene& scene, const scene::CompiledScene& compiled, const TraceSettings& settings,
              const std::function<bool(double, double)>& progress)
      : scene_(scene), problem_(compiled.problem()), settings_(settings), progress_(progress) {
    for (int k = 0; k <= scene.steps; ++k) targets_.push_back(scene.to * k / scene.steps);
    for (int k = 0; k <= scene.from_steps && scene.from_steps > 0; ++k) {
      below_.push_back(scene.from * k / scene.from_steps);
    }
    total_ = static_cast<double>(targets_.size()) * (twoRuns() ? 2 : 1) + static_cast<double>(below_.size());
  }

  /// @param out  forces and points are filled in as they come
  void run(SceneCurve& out) {
    const Eigen::VectorXd rest = Eigen::VectorXd::Zero(problem_.freeCount());
    const bool resumed = settings_.resume != nullptr;
    out.path = one(rest, targets_, resumed ? &settings_.resume->path : nullptr, out.path, out);
    if (out.path.status != solver::SolveStatus::CONVERGED) return;
    if (!below_.empty()) {
      out.below = one(out.path.points.front().solution, below_, nullptr, out.below, out);
      if (out.below.status != solver::SolveStatus::CONVERGED) return;
    }
    if (!twoRuns()) return;
    remember(out.path.points);
    const std::vector<double> back(targets_.rbegin(), targets_.rend());
    const bool second = resumed && !settings_.resume->back.points.empty();
    out.back = one(out.path.points.back().solution, back, second ? &settings_.resume->back : nullptr, out.back, out);
  }

 private:
  static constexpr std::size_t DENSE = 64;  ///< targets from which a series may cover enough of them

  bool twoRuns() const { return scene_.back || settings_.reverse; }

  void remember(const std::vector<PathPoint>& points) {
    for (const PathPoint& point : points) {
      if (!point.by_arc) known_[point.control] = &point;
    }
  }

  PathResult one(const Eigen::VectorXd& start, const std::vector<double>& targets, const PathResult* known,
                 PathResult& partial, const SceneCurve& sofar) {
    partial = {};
    if (known != nullptr) partial = *known;
    while (!partial.points.empty() && !partial.points.back().restart) partial.points.pop_back();
    AutomaticSettings automatic = automaticSettings(partial, sofar);
    if (settings_.method == TraceMethod::ARC_LENGTH) return byArc(start, targets, automatic);
    if (partial.points.empty()) return followAutomatically(problem_, start, targets, automatic);
    const PathResult before = partial;  // `partial` goes on growing
    if (before.points.back().control == targets.back()) return before;
    PathResult after = continueAutomatically(problem_, start, before.points, targets, automatic);
    return joined(before, std::move(after));
  }

  AutomaticSettings automaticSettings(PathResult& partial, const SceneCurve& sofar) {
    AutomaticSettings automatic;
    automatic.arc_on_failure = settings_.method != TraceMethod::DISPLACEMENT;
    automatic.largest_arc = settings_.largest_arc;
    automatic.path.newton = settings_.newton;
    automatic.path.series = targets_.size() >= DENSE;
    automatic.path.perturbation = settings_.perturbation != 0 ? settings_.perturbation : scene_.perturbation;
    const auto outer = settings_.newton.cancelled;
    automatic.path.newton.cancelled = [this, outer] { return cancelled_ || (outer && outer()); };
    automatic.path.known = [this](double control) {
      const auto found = known_.find(control);
      return found == known_.end() ? nullptr : found->second;
    };
    automatic.path.progress = [this](int) { return cancelled_; };
    automatic.path.recorded = [&](const PathPoint& point) {
      if (!point.by_arc) ++done_;
      partial.points.push_back(point);
      if (settings_.reached) settings_.reached(sofar);
      if (progress_ && progress_(std::min(1.0, done_ / total_), point.control)) cancelled_ = true;
    };
    done_ += static_cast<double>(partial.points.size());
    return automatic;
  }

  PathResult byArc(const Eigen::VectorXd& start, const std::vector<double>& targets,
                   const AutomaticSettings& automatic) {
    ArcSettings arc;
    arc.newton = automatic.path.newton;
    arc.first_step = arc.largest_step = std::abs(scene_.to) / scene_.steps;
    arc.max_points = settings_.largest_arc;
    arc.end = targets.back();
    arc.perturbation = automatic.path.perturbation;
    arc.recorded = automatic.path.recorded;
    arc.progress = [this](int, double) { return cancelled_; };
    return followArc(problem_, start, targets.front(), arc).path;
  }

  static PathResult joined(PathResult before, PathResult&& after) {
    before.points.insert(before.points.end(), after.points.begin(), after.points.end());
    after.points = std::move(before.points);
    after.iterations += before.iterations;
    after.factorizations += before.factorizations;
    after.projections += before.projections;
    after.halvings += before.halvings;
    after.series += before.series;
    return std::move(after);
  }

  const scene::Scene& scene_;
  const solver::Problem& problem_;
  const TraceSettings& settings_;
  const std::function<bool(double, double)>& progress_;
  std::vector<double> targets_, below_;
  std::map<double, const PathPoint*> known_;  ///< points of the way there, by control
  double total_ = 1, done_ = 0;
  bool cancelled_ = false;
};

}  // namespace

SceneCurve traceScene(const scene::Scene& scene, const scene::CompiledScene& compiled, const TraceSettings& settings,
                      const std::function<bool(double, double)>& progress) {
  if (settings.resume != nullptr && settings.method == TraceMethod::ARC_LENGTH)
    throw common::Error("a path by arc length alone cannot be resumed; trace it automatically");
  SceneCurve curve;
  curve.multiplicity = compiled.multiplicity();
  SceneTracer(scene, compiled, settings, progress).run(curve);
  if (settings.reverse && curve.path.status == solver::SolveStatus::CONVERGED) {
    std::swap(curve.path, curve.back);
    if (!scene.back) curve.back = {};
  }
  curve.limit_points = turningPoints(curve.path.points);
  curve.crossings = stabilityChanges(curve.path.points);
  curve.rotation = scene::rotationMonitor(scene);
  for (const PathPoint& p : curve.path.points) {
    curve.monitors.push_back(compiled.monitors(p.solution, p.control));
    curve.inertia.push_back(compiled.movingMass(p.solution, p.control, p.slope));
  }
  for (const PathPoint& p : curve.below.points) {
    curve.monitors_below.push_back(compiled.monitors(p.solution, p.control));
    curve.inertia_below.push_back(compiled.movingMass(p.solution, p.control, p.slope));
  }
  return curve;
}

}  // namespace snapwing::statics
