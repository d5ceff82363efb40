// Mirror planes: found, named, and the same curve with and without.
#include <gtest/gtest.h>

#include "scene_text.h"
#include "snapwing/common/error.h"

namespace snapwing::scene {
namespace {

/// A block of 4 x 2 x 2 mm, pressed flat: symmetric about all its middle planes but y's.
std::string press(const std::string& use, const std::string& more = "") {
  return "scene: press\nlength_unit: mm\ndimension: 3\nkernel: linear_reduced\ncell_size: 1\nuse_symmetry: " + use +
         "\nbodies:\n  block:\n    material: {youngs_modulus: 5.5e+6, poisson_ratio: 0.48}\n"
         "    shape: {difference: [{box: {x: [2, 6], y: [0, 2], z: [0, 2]}}, "
         "{cylinder: {from: [4, 0, 1], to: [4, 2, 1], radius: 0.6}}]}\n"
         "supports:\n  - {name: table, region: {y: [0, 0]}, hold: xyz}\n" +
         more +
         "ports:\n  - {name: ram, region: {y: [2, 2]}, direction: [0, -1, 0], cross_motion: held}\n"
         "monitors:\n  - {name: bulge, at: [2, 1, 1], direction: [1, 0, 0]}\npath: {to: 0.4, steps: 2}\n";
}

TEST(Symmetry, CurvesWithAndWithoutAgree) {
  const Scene whole = sceneFromText(press("false")), half = sceneFromText(press("true")),
              quarter = sceneFromText(press("all"));
  const auto a = compileScene(whole, 1), b = compileScene(half, 1), c = compileScene(quarter, 1);
  EXPECT_EQ(a->symmetry(), "none");
  EXPECT_EQ(b->symmetry(), "mirror plane z = 0.001 m");
  EXPECT_EQ(c->symmetry(), "mirror plane x = 0.004 m, mirror plane z = 0.001 m");
  EXPECT_EQ(c->multiplicity(), 4);
  EXPECT_EQ(a->cellCount(), 4 * c->cellCount());
  const statics::SceneCurve x = statics::traceScene(whole, *a, {}, {}), y = statics::traceScene(half, *b, {}, {}),
                            z = statics::traceScene(quarter, *c, {}, {});
  ASSERT_EQ(x.path.status, solver::SolveStatus::CONVERGED) << x.path.message;
  for (const statics::SceneCurve* other : {&y, &z}) {
    ASSERT_EQ(other->path.status, solver::SolveStatus::CONVERGED) << other->path.message;
    const double force = x.path.points.back().force;
    EXPECT_NEAR(other->multiplicity * other->path.points.back().force, force, 1e-8 * force);
    EXPECT_NEAR(other->monitors.back()[0], x.monitors.back()[0], 1e-8 * std::abs(x.monitors.back()[0]));
  }
}

TEST(Symmetry, IsNotTakenWhereSomethingBreaksIt) {
  const auto symmetry = [](const std::string& text) { return compileScene(sceneFromText(text), 1)->symmetry(); };
  const std::string clamp = "  - {name: clamp, region: {x: [6, 6]}, hold: x}\n";
  EXPECT_EQ(symmetry(press("all", clamp)), "mirror plane z = 0.001 m");
  EXPECT_EQ(symmetry(press("all", clamp + "  - {name: clamp, region: {x: [2, 2]}, hold: x}\n")),
            "mirror plane x = 0.004 m, mirror plane z = 0.001 m");
  EXPECT_EQ(symmetry(press("all", "  - {name: stop, region: {z: [0, 0]}, hold: z}\n")), "mirror plane x = 0.004 m");
  // Dead weight across a plane, a shape that is not its image, and cells that the plane would cut.
  std::string text = press("all");
  text.replace(text.find("\nports:") + 1, 0, "gravity: [0, 0, -9.81]\n");
  text.replace(text.find("poisson_ratio: 0.48"), 19, "poisson_ratio: 0.48, mass_density: 1000");
  EXPECT_EQ(symmetry(text), "mirror plane x = 0.004 m");
  text = press("all");
  text.replace(text.find("from: [4, 0, 1]"), 15, "from: [3.5, 0, 1]");
  EXPECT_EQ(symmetry(text), "mirror plane z = 0.001 m");
  text = press("all");
  text.replace(text.find("cell_size: 1"), 12, "cell_size: 0.8");
  EXPECT_EQ(symmetry(text), "none");
}

}  // namespace
}  // namespace snapwing::scene
