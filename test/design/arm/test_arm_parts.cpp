// Outline, cover and printable solid of simple shapes whose volume is known.
#include <gtest/gtest.h>

#include <cmath>

#include "design_scene.h"
#include "snapwing/design/arm/arm_parts.h"
#include "support/example_arm.h"

namespace snapwing::design {
namespace {

Loop rectangle(double x0, double y0, double x1, double y1) { return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}; }
Loop reversed(Loop loop) { return {loop.rbegin(), loop.rend()}; }

TEST(ArmShape, DistanceAreaAndHoles) {
  const ArmShape shape({rectangle(0.01, 0.005, 0.05, 0.015), reversed(rectangle(0.02, 0.008, 0.03, 0.012))});
  EXPECT_NEAR(shape.area(), 0.04 * 0.01 - 0.01 * 0.004, 1e-12);
  EXPECT_NEAR(shape.signedDistance(0.012, 0.01), -0.002, 1e-12);
  EXPECT_NEAR(shape.signedDistance(0.025, 0.010), 0.002, 1e-12);
  EXPECT_NEAR(shape.signedDistance(0.054, 0.018), 0.005, 1e-12);
}

TEST(ArmShape, CoverFollowsTheAreaAndTheOffset) {
  const mpm::DensityField domain = armDomain(testing::exampleArm(), 0.001, 0);
  const ArmShape shape({rectangle(0.0103, 0.0042, 0.0507, 0.0156)});
  for (const double offset : {-0.0002, 0.0, 0.0002}) {
    const mpm::DensityField field = shape.cover(domain, offset, 3, 0.02, 0.01);
    double area = 0;
    for (const double value : field.value) area += value > 0 ? std::pow(value, 3) * 1e-6 : 0;
    const double expected = (0.0404 + 2 * offset) * (0.0114 + 2 * offset);
    EXPECT_NEAR(area, expected, 0.005 * expected) << offset;
  }
}

TEST(ArmShape, IslandsAreDropped) {
  mpm::DensityField field = armDomain(testing::exampleArm(), 0.001, 0);
  for (int j = 2; j < 12; ++j) {
    for (int i = 5; i < 60; ++i) field.value[static_cast<std::size_t>(j) * 80 + i] = i < 40 || i > 45 ? 1 : 0;
  }
  const ArmShape shape(field);
  EXPECT_EQ(shape.loops().size(), 1u);
  EXPECT_NEAR(shape.area(), 35e-3 * 10e-3, 0.02 * 35e-5);
  EXPECT_GT(shape.signedDistance(0.05, 0.006), 0);
}

TEST(ExtrudeArm, VolumeOfASteppedBlockAndWatertight) {
  const vehicle::ArmSettings arm = testing::exampleArm();
  // Crosses the step between the thicknesses, with holes on each side and across it.
  const ArmShape shape({rectangle(0.0103, 0.0022, 0.0507, 0.0186), reversed(rectangle(0.0121, 0.0051, 0.0149, 0.0078)),
                        reversed(rectangle(0.0181, 0.0101, 0.0249, 0.0133)),
                        reversed(rectangle(0.0303, 0.0057, 0.0391, 0.0143))});
  const SolidMesh mesh = extrudeArm(arm, shape, 0.0005);
  EXPECT_TRUE(mesh.watertight());
  const double leg = (0.0097 * 0.0164 - 0.0028 * 0.0027 - 0.0019 * 0.0032) * 0.005;
  const double bar = (0.0307 * 0.0164 - 0.0049 * 0.0032 - 0.0088 * 0.0086) * 0.010;
  EXPECT_NEAR(mesh.volume(), leg + bar, 0.004 * (leg + bar));  // corners are cut by the contouring
  const auto extent = mesh.extent();
  EXPECT_NEAR(extent[0], 0.0404, 2e-5);
  EXPECT_NEAR(extent[1], 0.0164, 2e-5);
  EXPECT_NEAR(extent[2], 0.010, 1e-12);
}

TEST(ExtrudeArm, AHoleInTheMeshIsSeen) {
  SolidMesh mesh = extrudeArm(testing::exampleArm(), ArmShape({rectangle(0.0103, 0.0042, 0.0507, 0.0156)}), 0.001);
  ASSERT_TRUE(mesh.watertight());
  SolidMesh turned = mesh;
  std::swap(turned.triangles[5][0], turned.triangles[5][1]);
  EXPECT_FALSE(turned.watertight());
  mesh.triangles.pop_back();
  EXPECT_FALSE(mesh.watertight());
}

TEST(Drawings, StlHasItsTrianglesAndDxfItsEnd) {
  const ArmShape shape({rectangle(0.0103, 0.0042, 0.0507, 0.0156)});
  const SolidMesh mesh = extrudeArm(testing::exampleArm(), shape, 0.001);
  EXPECT_EQ(stlOf(mesh, "arm").size(), 84 + 50 * mesh.triangles.size());
  const std::string dxf = dxfOf(shape.loops(), {{0.078, 0.002, 0.0015}});
  EXPECT_NE(dxf.find("50.7"), std::string::npos);  // millimetres
  EXPECT_EQ(dxf.substr(dxf.size() - 4), "EOF\n");
  EXPECT_NE(svgOf(shape.loops(), {}).find("mm\""), std::string::npos);
}

}  // namespace
}  // namespace snapwing::design
