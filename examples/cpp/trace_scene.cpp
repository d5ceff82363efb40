// Traces the force-displacement curve of a scene: trace_scene SCENE.yaml
#include <cstdio>

#include "snapwing/common/error.h"
#include "snapwing/scene/scene_problem.h"
#include "snapwing/statics/scene_curve.h"

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: trace_scene SCENE.yaml\n"), 2;
  try {
    const snapwing::scene::Scene scene = snapwing::scene::loadScene(argv[1]);
    const auto compiled = snapwing::scene::compileScene(scene, 1);
    const auto curve = snapwing::statics::traceScene(scene, *compiled, {}, [](double, double) { return false; });
    std::printf("control,force_N,stable\n");
    for (const auto& point : curve.path.points)
      std::printf("%.6g,%.6g,%d\n", point.control, curve.multiplicity * point.force, point.stable);
    return curve.path.message.empty() ? 0 : 1;
  } catch (const snapwing::common::Error& error) {
    return std::fprintf(stderr, "error: %s\n", error.what()), 2;
  }
}
