#include "conversions.h"

#include <snapwing/ModeState.h>
#include <snapwing/PredictSnap.h>
#include <snapwing/SnapPrediction.h>
#include <snapwing/SwitchModeGoal.h>
#include <snapwing/TransitionPlan.h>
#include <snapwing/VehicleTruth.h>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"

namespace snapwing::nodes {

namespace {

template <class Message>
constexpr bool sameModes() {
  return Message::UNKNOWN == static_cast<int>(vehicle::Mode::UNKNOWN) &&
         Message::FIXED_WING == static_cast<int>(vehicle::Mode::FIXED_WING) &&
         Message::QUADROTOR == static_cast<int>(vehicle::Mode::QUADROTOR);
}
static_assert(sameModes<ModeState>() && sameModes<SnapPrediction>() && sameModes<TransitionPlan>() &&
                  sameModes<VehicleTruth>() && sameModes<PredictSnapRequest>() && sameModes<SwitchModeGoal>(),
              "messages and vehicle::Mode must number the modes alike");

std::vector<double> times(double factor, std::vector<double> values) {
  for (double& value : values) value *= factor;
  return values;
}

}  // namespace

ThrustPulse toMessage(const vehicle::Pulse& pulse) {
  ThrustPulse message;
  message.throttle = pulse.throttle;
  message.duration = pulse.duration;
  message.hold_throttle = pulse.hold_throttle;
  message.hold_duration = pulse.hold_duration;
  return message;
}

vehicle::Pulse fromMessage(const ThrustPulse& message) {
  return {message.throttle, message.duration, message.hold_throttle, message.hold_duration};
}

std::uint8_t toMessage(vehicle::Mode mode) { return static_cast<std::uint8_t>(mode); }

vehicle::Mode modeFromMessage(std::uint8_t mode) {
  if (mode > toMessage(vehicle::Mode::QUADROTOR)) {
    throw common::Error("mode " + std::to_string(mode) + " is none of 0 (unknown), 1 (fixed wing), 2 (quadrotor)");
  }
  return static_cast<vehicle::Mode>(mode);
}

ForceDisplacementCurve curveMessage(const vehicle::ForceTable& table) {
  ForceDisplacementCurve message;
  const auto entry = [&table](const char* key) {
    const auto found = table.provenance.find(key);
    return found == table.provenance.end() ? std::string() : found->second;
  };
  message.rung = entry("rung");
  message.inputs_sha256 = entry("inputs_sha256");
  message.travel = table.travel;
  message.force = times(table.arm_count, table.force);
  message.energy = times(table.arm_count, table.energy);
  message.rotation = table.rotation;
  message.stable.assign(table.stable.begin(), table.stable.end());
  const vehicle::CurveFeatures features = vehicle::curveFeatures(table);
  message.peak_travel = features.peak_travel;
  message.peak_force = features.peak_force;
  message.valley_travel = features.valley_travel;
  message.valley_force = features.valley_force;
  message.barrier_travel = features.barrier_travel;
  message.second_travel = features.second_travel;
  message.barrier_forward = features.barrier_forward;
  message.barrier_back = features.barrier_back;
  message.hysteresis = features.hysteresis;
  message.bistable = features.bistable;
  return message;
}

ArmGeometry geometryMessage(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table) {
  ArmGeometry message;
  message.vehicle = vehicle.name;
  message.arm_count = static_cast<std::uint8_t>(vehicle.arm.count);
  for (const auto& loop : table.shapes.rest) {
    geometry_msgs::Polygon polygon;
    for (const auto& point : loop) {
      geometry_msgs::Point32 corner;
      corner.x = static_cast<float>(point[0]);
      corner.y = static_cast<float>(point[1]);
      polygon.points.push_back(corner);
    }
    message.outline.push_back(polygon);
  }
  message.pin.x = vehicle.arm.pin_x;
  message.pin.y = vehicle.arm.pin_y;
  message.leg_width = vehicle.arm.leg_width;
  message.leg_thickness = vehicle.arm.leg_thickness;
  message.bar_thickness = vehicle.arm.bar_thickness;
  message.housing_radius = vehicle.geometry.housing_radius;
  message.ring_radius = vehicle.geometry.ring_radius;
  message.axle_below_ring = vehicle.geometry.axle_below_ring;
  message.density_file = vehicle.arm.density_file;
  message.density_sha256 = common::sha256OfFile(vehicle.arm.density_file);
  return message;
}

}  // namespace snapwing::nodes
