// Parts: closed meshes of the right volume, readable DXF, a list that agrees with the layout.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <tuple>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"
#include "snapwing/design/wing/wing_parts.h"
#include "wing_example.h"

namespace snapwing::design {
namespace {

using Key = std::tuple<long, long, long>;

Key keyOf(const Eigen::Vector3d& p) {
  return {std::lround(p.x() * 1e9), std::lround(p.y() * 1e9), std::lround(p.z() * 1e9)};
}

/// Every directed edge must be met once by its reverse.
bool closed(const PartMesh& mesh) {
  std::map<std::pair<Key, Key>, int> edges;
  for (const auto& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) ++edges[{keyOf(t[i]), keyOf(t[(i + 1) % 3])}];
  }
  for (const auto& [edge, count] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    if (back == edges.end() || back->second != count || count != 1) return false;
  }
  return true;
}

double exactVolume(const FlatBar& bar) {
  const double r = bar.width / 2, h = bar.hole_diameter / 2;
  return bar.thickness * (M_PI * r * r + bar.length * bar.width - 2 * M_PI * h * h);
}

WingLayout layout() {
  const WingSettings settings = paperSettings();
  return layoutOf(settings, paperDesign(), vehicle::loadVehicle(settings.vehicle_file), "rigid");
}

TEST(WingParts, MeshIsClosedAndItsVolumeConverges) {
  for (const double length : {0.0135, 0.040, 0.077}) {
    const FlatBar bar{length, 0.010, 0.004, 0.003};
    double last = 1;
    for (const int segments : {16, 64, 256}) {
      const PartMesh mesh = meshOf(bar, segments);
      EXPECT_TRUE(closed(mesh)) << length << " " << segments;
      const double error = std::abs(mesh.volume() / exactVolume(bar) - 1);
      EXPECT_LT(error, 0.1 * last);
      last = error;
    }
    EXPECT_LT(last, 1e-4);
  }
}

TEST(WingParts, AMissingTriangleIsNoticed) {
  PartMesh mesh = meshOf({0.05, 0.01, 0.004, 0.003});
  mesh.triangles.pop_back();
  EXPECT_FALSE(closed(mesh));
}

TEST(WingParts, LengthsAreThoseOfTheLinkage) {
  const WingLayout w = layout();
  const auto parts = partsOf(w);
  ASSERT_EQ(parts.size(), 4u);
  EXPECT_DOUBLE_EQ(parts[0].bar.length, w.linkage.crankLength());
  EXPECT_DOUBLE_EQ(parts[1].bar.length, w.linkage.couplerLength());
  EXPECT_DOUBLE_EQ(parts[3].bar.length, w.linkage.rockerLength());
  const std::string list = partList(w);
  EXPECT_NE(list.find("leading_edge_rod,2,"), std::string::npos);
  EXPECT_NE(list.find(",8.00,8.00,"), std::string::npos);
}

TEST(WingParts, FilesAreWritten) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "wing_parts";
  saveParts(layout(), {}, folder.string());
  const std::string stl = common::readFile((folder / "rocker.stl").string());
  EXPECT_EQ(stl.rfind("solid rocker", 0), 0u);
  EXPECT_NE(stl.find("endsolid rocker"), std::string::npos);
  const std::string dxf = common::readFile((folder / "arm_bar.dxf").string());
  EXPECT_NE(dxf.find("CIRCLE"), std::string::npos);
  EXPECT_NE(dxf.find("EOF"), std::string::npos);
}

TEST(WingParts, HolesThatBreakOutAreRefused) {
  EXPECT_THROW(meshOf({0.05, 0.003, 0.004, 0.003}), common::Error);
  EXPECT_THROW(meshOf({0.002, 0.01, 0.004, 0.003}), common::Error);
  EXPECT_THROW(meshOf({0.05, 0.01, 0.004, 0.003}, 10), common::Error);
}

}  // namespace
}  // namespace snapwing::design
