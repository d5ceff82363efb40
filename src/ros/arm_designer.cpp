#include "arm_designer.h"

#include <filesystem>
#include <utility>

#include "conversions.h"
#include "topics.h"

namespace snapwing::nodes {

namespace {

OptimizeDesignFeedback feedbackOf(const design::ArmDesignSettings& settings, const design::ArmProgress& p) {
  OptimizeDesignFeedback feedback;
  feedback.stage = OptimizeDesignFeedback::OPTIMIZING;
  feedback.iteration = p.report.iteration;
  feedback.iterations = settings.iterations();
  feedback.objective = p.report.objective;
  feedback.violation = p.report.violation;
  feedback.volume = p.volume;
  feedback.grey = p.grey;
  return feedback;
}

/// Feedback and preemption of a goal as the design layer asks for them.
design::ArmJob jobFor(const design::ArmDesignSettings& settings, const DesignJob& job, const std::string& folder) {
  design::ArmJob arm_job;
  arm_job.folder = folder;
  arm_job.resume = !job.goal.recompute;
  arm_job.warning = [](const std::string& text) { ROS_WARN_STREAM("design_arm: " << text); };
  arm_job.progress = [&settings, &job](const design::ArmProgress& p) {
    job.feedback(feedbackOf(settings, p));
    return job.preempted();
  };
  arm_job.checking = [&settings, &job](const std::string& name) {
    if (!name.empty()) {
      OptimizeDesignFeedback feedback;
      feedback.stage = OptimizeDesignFeedback::CHECKING;
      feedback.iteration = feedback.iterations = settings.iterations();
      feedback.detail = name;
      job.feedback(feedback);
    }
    return job.preempted();
  };
  return arm_job;
}

std::uint8_t codeOf(design::OptimizerStatus status) {
  switch (status) {
    case design::OptimizerStatus::INFEASIBLE:
      return OptimizeDesignResult::INFEASIBLE;
    case design::OptimizerStatus::EVALUATION_FAILED:
    case design::OptimizerStatus::NOT_RUN:
      return OptimizeDesignResult::FAILED;
    case design::OptimizerStatus::CANCELLED:
      return OptimizeDesignResult::PREEMPTED;
    default:
      return OptimizeDesignResult::SUCCEEDED;
  }
}

}  // namespace

ArmDesigner::ArmDesigner(ros::NodeHandle& relative, std::string frame) : frame_(std::move(frame)) {
  geometry_ = relative.advertise<ArmGeometry>(topics::DESIGNED_ARM_GEOMETRY, 1, true);
  curve_ = relative.advertise<ForceDisplacementCurve>(topics::DESIGNED_FORCE_CURVE, 1, true);
}

void ArmDesigner::publish(const design::ArmDesignSettings& settings, const design::ArmOutcome& outcome) {
  if (outcome.table.travel.empty()) return;
  vehicle::Vehicle vehicle = settings.vehicle;
  vehicle.arm.density_file = outcome.bodyFile();
  ArmGeometry geometry = geometryMessage(vehicle, outcome.table);
  ForceDisplacementCurve curve = curveMessage(outcome.table);
  geometry.header.frame_id = curve.header.frame_id = frame_;
  geometry.header.stamp = curve.header.stamp = ros::Time::now();
  geometry_.publish(geometry);
  curve_.publish(curve);
}

OptimizeDesignResult ArmDesigner::run(const DesignJob& job) {
  const design::ArmDesignSettings settings = design::loadArmDesignSettings(job.settings_file);
  const std::string folder = design::storedArmFolder(settings, job.store_folder);
  OptimizeDesignResult result;
  std::optional<design::ArmOutcome> outcome;
  if (!job.goal.recompute) outcome = design::loadArmOutcome(settings, folder);
  result.from_store = outcome.has_value();
  if (!outcome) {
    if (job.goal.recompute) std::filesystem::remove_all(folder);
    outcome = design::designArm(settings, jobFor(settings, job, folder));
  }
  result.code = codeOf(outcome->status);
  result.message = design::nameOf(outcome->status) + (outcome->message.empty() ? "" : ": " + outcome->message);
  result.inputs_sha256 = settings.hash();
  result.folder = folder;
  result.verdict = outcome->bistable;
  result.targets_met = outcome->all_met;
  result.objective = outcome->objective;
  result.violation = outcome->violation;
  result.iterations = outcome->iterations;
  if (result.code != OptimizeDesignResult::PREEMPTED) publish(settings, *outcome);
  return result;
}

}  // namespace snapwing::nodes
