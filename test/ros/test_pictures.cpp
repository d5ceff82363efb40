// The picture's geometry: triangles fill the outline exactly, and the shipped arm deforms without tearing.
#include <gtest/gtest.h>

#include <cmath>

#include "snapwing/vehicle/wing_table.h"
#include "support/paths.h"
#include "vehicle_picture.h"

namespace snapwing::nodes {
namespace {

double filledArea(const std::vector<Loop>& loops) {
  double area = 0;
  for (const auto& triangle : triangulate(loops)) {
    Loop corners;
    for (const VertexId& id : triangle) corners.push_back(loops[id.loop][id.point]);
    EXPECT_GE(signedArea(corners), 0.0);
    area += signedArea(corners);
  }
  return area;
}

TEST(Triangulation, FillsConcaveOutline) {
  const Loop ell = {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 4}, {0, 4}};
  EXPECT_NEAR(filledArea({ell}), 6.0, 1e-12);
}

TEST(Triangulation, LeavesHoleOutAndIgnoresOrientation) {
  const Loop outer = {{0, 0}, {4, 0}, {4, 4}, {0, 4}};
  Loop hole = {{1, 1}, {1, 2}, {2, 2}, {2, 1}};
  EXPECT_NEAR(filledArea({outer, hole}), 15.0, 1e-12);
  std::reverse(hole.begin(), hole.end());
  EXPECT_NEAR(filledArea({hole, outer}), 15.0, 1e-12);
}

class Picture : public testing::Test {
 protected:
  vehicle::Vehicle vehicle_ = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  vehicle::ForceTable table_ = vehicle::loadForceTable(vehicle_.arm.table_file);
  VehiclePicture picture_{vehicle_, table_, {}};
};

TEST_F(Picture, ShippedOutlineIsFilledAtEveryTravel) {
  for (std::size_t k = 0; k < table_.travel.size(); k += 8) {
    double expected = 0;  // outer loops and holes have opposite orientation or lie in each other
    const auto& loops = table_.shapes.moved[k];
    ASSERT_FALSE(loops.empty());
    for (std::size_t i = 0; i < loops.size(); ++i) expected = std::max(expected, std::abs(signedArea(loops[i])));
    const double filled = filledArea(loops);
    EXPECT_GT(filled, 0.5 * expected) << "u = " << table_.travel[k];
    EXPECT_LT(filled, 1.001 * expected) << "u = " << table_.travel[k];
  }
}

TEST_F(Picture, NoStrainAtRestAndSomeInQuadrotorMode) {
  double rest = 0, moved = 0;
  for (const auto& loop : picture_.outlineStrain(picture_.outline(0.0))) {
    for (const double strain : loop) rest = std::max(rest, std::abs(strain));
  }
  for (const auto& loop : picture_.outlineStrain(picture_.outline(0.05))) {
    for (const double strain : loop) moved = std::max(moved, std::abs(strain));
  }
  EXPECT_LT(rest, 1e-3);
  EXPECT_GT(moved, 0.02);
}

TEST_F(Picture, DesignedWingsAreMirroredAndFoldAsTheTableSays) {
  const vehicle::WingTable wing = vehicle::loadWingTable(vehicle_.wing.table_file);
  ASSERT_TRUE(wing.hasBlade());
  picture_.useWing(wing);
  const auto tipOf = [&](double travel, int id) {
    PictureState state;
    state.travel = travel;
    for (const auto& marker : picture_.draw(state).markers) {
      if (marker.ns == "linkage" && marker.id == id) return marker.points.back();
    }
    ADD_FAILURE() << "no linkage marker " << id;
    return geometry_msgs::Point();
  };
  for (const double travel : {0.0, 0.03, wing.travel.back(), 2 * wing.travel.back()}) {
    const auto left = tipOf(travel, 0), right = tipOf(travel, 2);
    EXPECT_NEAR(left.y, -right.y, 1e-12);
    EXPECT_NEAR(left.z, right.z, 1e-12);
    EXPECT_NEAR(left.y - wing.axle[0], wing.at(wing.tip_x, travel), 1e-12);
  }
  // At rest the leading edge reaches out, folded it points up and in.
  EXPECT_GT(tipOf(0, 0).y, 0.25);
  EXPECT_LT(tipOf(0.07, 0).y, 0.12);
}

TEST_F(Picture, VehicleWithoutWingsIsDrawnWithoutWings) {
  for (const double travel : {0.0, 0.05}) {
    PictureState state;
    state.travel = travel;
    const auto picture = picture_.draw(state);
    EXPECT_GT(picture.markers.size(), 5u);
    for (const auto& marker : picture.markers) {
      EXPECT_EQ(marker.ns.find("wing"), std::string::npos) << marker.ns;
      EXPECT_NE(marker.ns, "linkage");
    }
  }
}

TEST_F(Picture, AnUnknownModeIsDrawnAsTwoFaintOnes) {
  PictureState state;
  state.travel = 0.0;
  const auto known = picture_.draw(state).markers;
  for (const auto& marker : known) EXPECT_EQ(marker.ns.find("ghost"), std::string::npos);
  state.alpha = 0.5;
  state.ghost_travel = 0.05;
  const auto both = picture_.draw(state).markers;
  EXPECT_GT(both.size(), known.size());
  double housing = NAN;
  for (const auto& marker : both) {
    const bool ghost = marker.ns.rfind("ghost ", 0) == 0;
    EXPECT_EQ(ghost, !marker.lifetime.isZero()) << marker.ns;
    if (marker.ns != "label" && marker.action == 0) {
      EXPECT_LE(marker.color.a, ghost ? 0.26 : 0.51) << marker.ns;
    }
    if (marker.ns == "ghost housing") housing = marker.pose.position.z;
  }
  EXPECT_NEAR(housing, picture_.housingHeight(0.05), 1e-12);
}

TEST_F(Picture, HousingMovesDownByTravel) {
  EXPECT_NEAR(picture_.housingHeight(0.0) - picture_.housingHeight(0.05), 0.05, 1e-12);
}

}  // namespace
}  // namespace snapwing::nodes
