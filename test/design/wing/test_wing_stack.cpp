// Layers: hand-made stacks that need two and three layers, one that has none, pins in the way, and the wing's own.
#include <gtest/gtest.h>

#include <algorithm>

#include "snapwing/common/error.h"
#include "snapwing/design/wing/wing_layout.h"
#include "snapwing/design/wing/wing_parts.h"
#include "wing_example.h"

namespace snapwing::design {
namespace {

using Eigen::Vector2d;

/// A bar 10 mm wide and 4 mm thick that does not move.
StackPiece bar(const std::string& name, const Vector2d& a, const Vector2d& b) { return {name, 0.005, 0.004, {{a, b}}}; }

/// Two bars on one pin, hinged at the origin.
Stack hinge() {
  Stack s;
  s.pieces = {bar("left", {0, 0}, {-0.05, 0}), bar("right", {0, 0}, {0.05, 0})};
  s.pins = {{"middle", 0.0015, {0, 1}, false, {{0, 0}}}};
  return s;
}

WingStackSettings within(int layers) {
  WingStackSettings settings;
  settings.most_layers = layers;
  return settings;
}

std::vector<int> layersOf(const StackPlan& plan) {
  std::vector<int> layers;
  for (const PlacedPiece& p : plan.pieces) layers.push_back(p.layer);
  return layers;
}

TEST(WingStack, BarsApartShareALayer) {
  Stack s;
  s.pieces = {bar("a", {0, 0}, {0.05, 0}), bar("b", {0, 0.0115}, {0.05, 0.0115})};  // 1.5 mm between them
  const StackPlan plan = planStack(s, within(1));
  ASSERT_TRUE(plan.found) << plan.message;
  EXPECT_EQ(layersOf(plan), (std::vector<int>{1, 1}));
  EXPECT_TRUE(plan.over.empty());
  s.pieces[1] = bar("b", {0, 0.0105}, {0.05, 0.0105});  // .5 mm: less than the clearance
  EXPECT_FALSE(planStack(s, within(1)).found);
}

TEST(WingStack, AHingeNeedsTwoLayers) {
  const StackPlan plan = planStack(hinge(), within(6));
  ASSERT_TRUE(plan.found) << plan.message;
  EXPECT_EQ(plan.layers, 2);
  EXPECT_EQ(layersOf(plan), (std::vector<int>{1, 2}));
  EXPECT_DOUBLE_EQ(plan.pieces[0].z, 0.0005);
  EXPECT_DOUBLE_EQ(plan.pieces[1].z, 0.0050);
  EXPECT_DOUBLE_EQ(plan.pins[0].low, 0.0005);
  EXPECT_DOUBLE_EQ(plan.pins[0].high, 0.0090);
  ASSERT_EQ(plan.over.size(), 1u);
  EXPECT_NEAR(plan.over[0].gap, -0.010, 1e-12);
  const StackPlan one = planStack(hinge(), within(1));
  EXPECT_FALSE(one.found);
  EXPECT_NE(one.message.find("within 1 layers; 2 would do"), std::string::npos) << one.message;
}

TEST(WingStack, ABarThatSweepsOverTheHingeNeedsAThirdLayerOutsideThePin) {
  Stack s = hinge();
  for (StackPiece& piece : s.pieces) piece.ends.resize(3, piece.ends[0]);
  s.pins[0].place.resize(3, s.pins[0].place[0]);
  s.pieces.push_back(bar("sweep", {0.1, 0.02}, {0.1, 0.1}));
  s.pieces[2].ends.push_back({Vector2d(0, -0.04), Vector2d(0, 0.04)});  // only here it lies over both bars
  s.pieces[2].ends.push_back({Vector2d(0.1, 0.02), Vector2d(0.1, 0.1)});
  const StackPlan plan = planStack(s, within(6));
  ASSERT_TRUE(plan.found) << plan.message;
  EXPECT_EQ(plan.layers, 3);
  EXPECT_NE(plan.pieces[2].layer, 2);  // not between the bars, where the pin is
  ASSERT_EQ(plan.in_way.size(), 1u);
  EXPECT_EQ(plan.in_way[0].sample, 1);
  EXPECT_EQ(plan.over.size(), 3u);
  s.pieces[2].ends[1] = s.pieces[2].ends[0];
  EXPECT_EQ(planStack(s, within(6)).layers, 2);
}

TEST(WingStack, NoOrderIsRefusedWithItsReason) {
  // Two levers on posts of the ring, each over the other's post: each would have to lie below the other.
  Stack s;
  s.pieces = {bar("left", {0, 0}, {0.05, 0}), bar("right", {0.05, 0}, {0, 0})};
  s.pins = {{"left post", 0.0015, {0}, true, {{0, 0}}}, {"right post", 0.0015, {1}, true, {{0.05, 0}}}};
  const StackPlan plan = planStack(s, within(8));
  EXPECT_FALSE(plan.found);
  EXPECT_EQ(plan.layers, 0);
  EXPECT_EQ(plan.find("left"), nullptr);
  EXPECT_NE(plan.message.find("in any number of layers"), std::string::npos) << plan.message;
  EXPECT_NE(plan.message.find("pin left post meets right"), std::string::npos) << plan.message;
  EXPECT_NE(plan.message.find("pin right post meets left"), std::string::npos) << plan.message;
  s.pieces[1] = bar("right", {0.05, 0}, {0.02, 0});  // no longer over the left post
  EXPECT_EQ(layersOf(planStack(s, within(8))), (std::vector<int>{2, 1}));
}

TEST(WingStack, FixedPiecesAreNeighbours) {
  Stack s;
  const Vector2d a(-0.05, 0), b(0.05, 0);
  s.pieces = {bar("lever", a, b), bar("plate", a, b), bar("rod", a, b)};
  s.fixed = {{0, 2}, {1, 2}};
  EXPECT_EQ(planStack(s, within(8)).pieces[2].layer, 2);
  s.fixed.push_back({0, 1});
  const StackPlan plan = planStack(s, within(8));
  EXPECT_FALSE(plan.found);
  EXPECT_NE(plan.message.find("plate is fixed to rod"), std::string::npos) << plan.message;
}

TEST(WingStack, TwoPinsAtOnePlaceDoNotShareALayer) {
  Stack s;
  s.pieces = {bar("a", {0, 0}, {-0.05, 0}), bar("b", {0.001, 0}, {0.05, 0})};
  s.pins = {{"first", 0.0015, {0}, true, {{-0.02, 0}}}, {"second", 0.0015, {1}, true, {{-0.019, 0}}}};
  const StackPlan plan = planStack(s, within(6));
  EXPECT_FALSE(plan.found);
  EXPECT_EQ(plan.pin_pairs.size(), 1u);
  EXPECT_NE(plan.message.find("pin first meets pin second"), std::string::npos) << plan.message;
}

TEST(WingStack, WrongStacksAreRefused) {
  EXPECT_THROW(planStack({}, {}), common::Error);
  Stack s = hinge();
  s.pieces[0].ends.push_back(s.pieces[0].ends[0]);
  EXPECT_THROW(planStack(s, {}), common::Error);
  s = hinge();
  s.pins[0].pieces = {2};
  EXPECT_THROW(planStack(s, {}), common::Error);
  s = hinge();
  s.pieces[1].ends[0][0].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(planStack(s, {}), common::Error);
  EXPECT_THROW(planStack(hinge(), within(0)), common::SettingError);
}

double distance(const Vector2d& p, const std::array<Vector2d, 2>& line) {
  double least = 1;
  for (int k = 0; k <= 2000; ++k) least = std::min(least, (p - line[0] - k / 2000.0 * (line[1] - line[0])).norm());
  return least;
}

/// The plan of the paper's wing, checked by sampling points of the bars themselves.
TEST(WingStack, ThePapersWingHasLayersInWhichNothingCollides) {
  const WingSettings settings = paperSettings();
  const WingLayout w = layoutOf(settings, paperDesign(), vehicle::loadVehicle(settings.vehicle_file), "rigid");
  const StackPlan plan = planStack(stackOf(w), settings.stack);
  ASSERT_TRUE(plan.found) << plan.message;
  const Stack coarse = stackOf(w, 40);
  for (std::size_t p = 0; p < coarse.pins.size(); ++p) {
    for (std::size_t i = 0; i < coarse.pieces.size(); ++i) {
      const auto& held = coarse.pins[p].pieces;
      if (std::count(held.begin(), held.end(), static_cast<int>(i)) > 0) continue;
      const double low = plan.pieces[i].z, high = low + coarse.pieces[i].thickness;
      if (high <= plan.pins[p].low || low >= plan.pins[p].high) continue;
      for (std::size_t k = 0; k < 40; ++k) {
        EXPECT_GT(distance(coarse.pins[p].place[k], coarse.pieces[i].ends[k]), 0.0015 + coarse.pieces[i].half_width)
            << coarse.pins[p].name << " " << coarse.pieces[i].name;
      }
    }
  }
  // The rod passes X1 by less than its own radius and the pin's: it cannot lie in that pin's reach.
  const PlacedPiece* rod = plan.find(LEADING_EDGE_ROD);
  ASSERT_NE(rod, nullptr);
  EXPECT_TRUE(rod->z >= plan.pins[2].high || rod->z + w.blade.rod_diameter <= plan.pins[2].low);
  const std::string list = partList(w, plan);
  EXPECT_NE(list.find("pin_X1,2,"), std::string::npos) << list;
}

}  // namespace
}  // namespace snapwing::design
