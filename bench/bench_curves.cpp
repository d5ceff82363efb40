// Every point of a scene's curve, or of the shipped vehicle's arm, with all digits: what must not change by accident
// when the solver is rebuilt. bench/curves runs it over config/scenes and compares two results.
//   bench_curves SCENE.yaml DRIVE CELL_SIZE_M STEPS [TOLERANCE]     0: as the scene says
//   bench_curves VEHICLE.yaml                           its arm in the plane
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "snapwing/scene/arm_scene.h"
#include "snapwing/scene/rung.h"
#include "snapwing/statics/scene_curve.h"
#include "snapwing/vehicle/vehicle.h"

namespace {

using namespace snapwing;

double tolerance = 1e-12;  // of Newton's method, by the last argument

void print(const char* word, const Eigen::VectorXd& values) {
  std::printf("%s", word);
  for (double v : values) std::printf(" %.17g", v);
  std::printf("\n");
}

void print(const statics::PathResult& path) {
  for (const statics::PathPoint& p : path.points) {
    std::printf("point %.17g %.17g %.17g %.17g %.17g %d %d %d %d %d\n", p.control, p.force, p.stiffness, p.energy,
                p.min_det_f, p.stable, p.negative_pivots, p.by_arc, p.iterations, p.factorizations);
    print("z", p.solution);
    print("multipliers", p.multipliers);
  }
  std::printf("end %s %d %d %d\n", solver::statusName(path.status).c_str(), path.iterations, path.factorizations,
              path.projections);
}

void traceSceneFile(const std::string& file, const std::string& drive, double cell_size, int steps) {
  scene::Scene scene = scene::loadScene(file);
  scene.enforcement = solver::enforcementFromName(drive);
  if (cell_size > 0) scene.cell_size = cell_size;
  if (steps > 0) scene.steps = steps;
  const auto compiled = scene::compileScene(scene, 1);
  statics::TraceSettings settings;
  settings.newton.relative_tolerance = tolerance;
  settings.method = statics::TraceMethod::AUTOMATIC;
  const statics::SceneCurve curve =
      statics::traceScene(scene, *compiled, settings, [](double, double) { return false; });
  print(curve.path);
  print(curve.back);
  for (const auto& m : curve.monitors)
    print("monitors", Eigen::Map<const Eigen::VectorXd>(m.data(), static_cast<Eigen::Index>(m.size())));
  for (const mpm::MovingMass& m : curve.inertia)
    std::printf("inertia %.17g %.17g %.17g\n", m.mass, m.kinetic, m.coupled);
}

void traceVehicle(const std::string& file) {
  const vehicle::Vehicle vehicle = vehicle::loadVehicle(file);
  const mpm::DensityField design =
      mpm::loadDensityCsv(vehicle.arm.density_file, vehicle.arm.domain_length, vehicle.arm.domain_height);
  scene::ArmSceneSettings settings;
  settings.from = -0.015;
  settings.to = 0.080;
  const scene::Scene scene = scene::armScene(vehicle, design, settings);
  const auto arm = scene::compileScene(scene, 1);
  statics::TraceSettings trace;
  trace.newton.relative_tolerance = tolerance;
  const statics::SceneCurve curve = statics::traceScene(scene, *arm, trace, {});
  const vehicle::ForceTable t = curve.table();
  for (std::size_t k = 0; k < t.travel.size(); ++k) {
    std::printf("point %.17g %.17g %.17g %.17g %.17g %.17g %d %d\n", t.travel[k], t.force[k], t.stiffness[k],
                t.energy[k], t.min_det_f[k], t.rotation[k], static_cast<int>(t.stable[k]),
                static_cast<int>(t.iterations[k]));
  }
  const statics::PathResult whole = curve.costs();
  std::printf("end %s %d %d %d\n", solver::statusName(whole.status).c_str(), whole.iterations, whole.factorizations,
              whole.projections);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 && argc != 5 && argc != 6) {
    std::fprintf(stderr,
                 "usage: bench_curves SCENE.yaml DRIVE CELL_SIZE_M STEPS [TOLERANCE] | bench_curves VEHICLE.yaml\n");
    return 2;
  }
  if (argc == 6) tolerance = std::atof(argv[5]);
  try {
    if (argc == 2)
      traceVehicle(argv[1]);
    else
      traceSceneFile(argv[1], argv[2], std::atof(argv[3]), std::atoi(argv[4]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_curves: %s\n", error.what());
    return 2;
  }
  return 0;
}
