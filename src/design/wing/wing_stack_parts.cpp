// The wing's own bars, rod and pins as a stack.
#include "snapwing/common/error.h"
#include "snapwing/design/wing/wing_parts.h"
#include "snapwing/design/wing/wing_stack.h"

namespace snapwing::design {

using Eigen::Vector2d;

namespace {

enum Piece { ARM_BAR, WING_PLATE, EDGE_PLATE, ROD, ROCKER };
enum Pin { AXLE, AUXILIARY, JOINT_1, JOINT_2 };

}  // namespace

Stack stackOf(const WingLayout& w, int samples) {
  if (samples < 2) throw common::Error("stack: " + std::to_string(samples) + " samples; allowed: at least 2");
  const std::vector<WingPart> parts = partsOf(w);
  Stack s;
  for (const std::size_t part : {0, 1, 2, 2, 3}) {
    s.pieces.push_back({parts[part].name, 0.5 * w.bars.width, w.bars.thickness, {}});
  }
  s.pieces[ROD] = {LEADING_EDGE_ROD, 0.5 * w.blade.rod_diameter, w.blade.rod_diameter, {}};
  const double radius = 0.5 * w.bars.pin_diameter;
  s.pins = {{"axle", radius, {ARM_BAR}, true, {}},
            {"auxiliary", radius, {ROCKER}, true, {}},
            {"X1", radius, {ARM_BAR, WING_PLATE}, false, {}},
            {"X2", radius, {WING_PLATE, EDGE_PLATE, ROCKER}, false, {}}};
  s.fixed = {{WING_PLATE, EDGE_PLATE}, {EDGE_PLATE, ROD}};
  for (int k = 0; k < samples; ++k) {
    const double theta = w.arm_rotation[1] * k / (samples - 1);
    const auto pose = poseAt(w.linkage, theta);
    if (!pose) throw common::Error("stack: the loop does not close at " + std::to_string(theta) + " rad");
    const Vector2d axle = Vector2d::Zero(), edge = (pose->tip - pose->joint2).normalized();
    const auto add = [&](Piece piece, const Vector2d& a, const Vector2d& b) { s.pieces[piece].ends.push_back({a, b}); };
    add(ARM_BAR, axle, pose->joint1);
    add(WING_PLATE, pose->joint1, pose->joint2);
    add(EDGE_PLATE, pose->joint2, pose->joint2 + parts[EDGE_PLATE].bar.length * edge);
    add(ROD, pose->joint2, pose->tip);
    add(ROCKER, w.linkage.auxiliary, pose->joint2);
    s.pins[AXLE].place.push_back(axle);
    s.pins[AUXILIARY].place.push_back(w.linkage.auxiliary);
    s.pins[JOINT_1].place.push_back(pose->joint1);
    s.pins[JOINT_2].place.push_back(pose->joint2);
  }
  return s;
}

}  // namespace snapwing::design
