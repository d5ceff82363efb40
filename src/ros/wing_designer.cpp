#include "wing_designer.h"

#include <filesystem>
#include <limits>
#include <utility>

#include "topics.h"

namespace snapwing::nodes {

namespace {

geometry_msgs::Point planar(const Eigen::Vector2d& p) {
  geometry_msgs::Point point;
  point.x = p.x();
  point.y = p.y();
  return point;
}

OptimizeDesignFeedback feedbackOf(const design::WingProgress& p) {
  OptimizeDesignFeedback feedback;
  feedback.stage = OptimizeDesignFeedback::OPTIMIZING;
  feedback.iteration = static_cast<std::uint32_t>(p.run);
  feedback.iterations = static_cast<std::uint32_t>(p.runs);
  feedback.objective = p.objective;
  feedback.violation = p.violation;
  feedback.volume = feedback.grey = std::numeric_limits<double>::quiet_NaN();
  return feedback;
}

std::uint8_t codeOf(design::WingStatus status) {
  switch (status) {
    case design::WingStatus::DESIGNED:
      return OptimizeDesignResult::SUCCEEDED;
    case design::WingStatus::CANCELLED:
      return OptimizeDesignResult::PREEMPTED;
    case design::WingStatus::INFEASIBLE:
      return OptimizeDesignResult::INFEASIBLE;
    default:
      return OptimizeDesignResult::FAILED;
  }
}

}  // namespace

WingGeometry wingMessage(const design::WingLayout& layout, const std::string& table_file) {
  WingGeometry message;
  message.name = layout.name;
  message.rung = layout.rung;
  message.auxiliary = planar(layout.linkage.auxiliary);
  message.joint1 = planar(layout.linkage.joint1);
  message.joint2 = planar(layout.linkage.joint2);
  message.tip = planar(layout.linkage.tip);
  message.anchor = planar(layout.anchor);
  message.crank_sign = static_cast<std::int8_t>(layout.linkage.crank_sign);
  message.wing_sign = static_cast<std::int8_t>(layout.wing_sign);
  for (std::size_t i = 0; i < 2; ++i) {
    message.arm_rotation[i] = layout.arm_rotation[i];
    const auto pose = design::poseAt(layout.linkage, layout.arm_rotation[i]);
    message.wing_rotation[i] = pose ? pose->wing_rotation : std::numeric_limits<double>::quiet_NaN();
  }
  message.smallest_transmission = design::checkTravel(layout.linkage, layout.arm_rotation[1]).smallest_transmission;
  message.panel_angle = design::WingBlade(layout).panelAngle();
  message.axle_radius = layout.axle_radius;
  message.axle_below_ring = layout.axle_below_ring;
  message.table_file = table_file;
  return message;
}

WingDesigner::WingDesigner(ros::NodeHandle& relative, const vehicle::Vehicle& vehicle, std::string frame)
    : frame_(std::move(frame)) {
  designed_ = relative.advertise<WingGeometry>(topics::DESIGNED_WING_GEOMETRY, 1, true);
  if (vehicle.wing.layout_file.empty()) return;
  geometry_ = relative.advertise<WingGeometry>(topics::WING_GEOMETRY, 1, true);
  publish(geometry_, design::loadWing(vehicle.wing.layout_file), vehicle.wing.table_file);
}

void WingDesigner::publish(const ros::Publisher& to, const design::WingLayout& layout, const std::string& table_file) {
  WingGeometry message = wingMessage(layout, table_file);
  message.header.frame_id = frame_;
  message.header.stamp = ros::Time::now();
  to.publish(message);
}

OptimizeDesignResult WingDesigner::run(const DesignJob& job) {
  const design::WingSettings settings = design::loadWingSettings(job.settings_file);
  OptimizeDesignResult result;
  const design::WingRung rung = design::wingRungOf(settings.rung);
  result.inputs_sha256 = design::wingHash(settings, rung);
  result.folder = (std::filesystem::path(job.store_folder) / result.inputs_sha256).string();
  std::optional<design::WingOutcome> outcome;
  if (!job.goal.recompute) outcome = design::loadWingOutcome(settings, result.folder);
  if (!outcome) {
    design::WingJob wing_job;
    wing_job.folder = result.folder;
    wing_job.rung = rung;
    wing_job.cancelled = job.preempted;
    wing_job.go_on = [&job](const design::WingProgress& p) {
      job.feedback(feedbackOf(p));
      return !job.preempted();
    };
    outcome = design::designWingInto(settings, wing_job);
  }
  const design::WingDesign& design = outcome->design;
  result.from_store = outcome->from_store;
  result.code = codeOf(design.status);
  result.message = std::string(design::nameOf(design.status)) + ": " + design.message;
  result.verdict = design.status == design::WingStatus::DESIGNED;
  result.targets_met = outcome->targets_met;
  result.objective = result.verdict ? design.objective : std::numeric_limits<double>::quiet_NaN();
  result.violation = result.verdict ? 0 : std::numeric_limits<double>::quiet_NaN();
  result.iterations = static_cast<std::uint32_t>(design.evaluations);
  if (result.verdict && !outcome->stack.found) result.message += "; no layers: " + outcome->stack.message;
  if (result.verdict) publish(designed_, outcome->layout, result.folder + "/wing_table.h5");
  return result;
}

}  // namespace snapwing::nodes
