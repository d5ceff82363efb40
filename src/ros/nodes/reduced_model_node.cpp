/// reduced_model_node: answers what a thrust pulse does (service predict_snap), from the lumped model of the vehicle.

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/console.h>
#include <ros/timer.h>
#include <snapwing/PredictSnap.h>

#include <chrono>

#include "conversions.h"
#include "node_main.h"
#include "planning_conversions.h"
#include "snapwing/rom/lumped_model.h"
#include "snapwing/vehicle/table_origin.h"
#include "topics.h"

namespace snapwing::nodes {

class ReducedModelNode {
 public:
  explicit ReducedModelNode(Handles& handles) : ReducedModelNode(handles, Params::fromServer(handles.own)) {}

 private:
  ReducedModelNode(Handles& handles, Params params)
      : vehicle_(params.vehicle()), trial_(readTrial(params, vehicle_)), model_(makeModel(params)) {
    params.finish();
    service_ = handles.relative.advertiseService(topics::PREDICT_SNAP, &ReducedModelNode::predict, this);
    diagnostics_.setHardwareID(vehicle_.name);
    diagnostics_.add("predictions", this, &ReducedModelNode::diagnose);
    timer_ =
        handles.relative.createTimer(ros::Duration(0.5), [this](const ros::TimerEvent&) { diagnostics_.update(); });
  }

  rom::LumpedModel makeModel(Params& params) const {
    rom::LumpedSettings settings;
    settings.step = params.number("step", {1e-5, 0.01}, "s");
    const vehicle::ForceTable table = vehicle::armTableOf(vehicle_);
    return rom::LumpedModel::fromVehicle(vehicle_, table, vehicle::realise(vehicle_, table), settings,
                                         vehicle::wingTableOf(vehicle_, table));
  }

  bool predict(PredictSnap::Request& request, PredictSnap::Response& response) {
    try {
      vehicle::Trial trial = trial_;
      trial.initial_speed = request.initial_speed;
      trial.validate();
      const auto start = std::chrono::steady_clock::now();
      rom::SnapPrediction prediction =
          model_.predict(modeFromMessage(request.start_mode), fromMessage(request.pulse), vehicle_.radio, trial);
      const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
      prediction.compute_seconds = elapsed.count();
      response.prediction = toMessage(prediction);
      response.ok = true;
      ++answered_;
      last_seconds_ = elapsed.count();
    } catch (const std::exception& error) {
      response.ok = false;
      response.message = error.what();
      ++refused_;
      ROS_WARN_STREAM("prediction refused: " << error.what());
    }
    return true;
  }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
    status.summary(diagnostic_msgs::DiagnosticStatus::OK, "ready");
    status.add("answered", answered_);
    status.add("refused", refused_);
    status.add("last computation [s]", last_seconds_);
  }

  vehicle::Vehicle vehicle_;
  vehicle::Trial trial_;
  rom::LumpedModel model_;
  unsigned answered_ = 0;
  unsigned refused_ = 0;
  double last_seconds_ = 0;
  ros::ServiceServer service_;
  diagnostic_updater::Updater diagnostics_;
  ros::Timer timer_;
};

}  // namespace snapwing::nodes

int main(int argc, char** argv) {
  return snapwing::nodes::runNode<snapwing::nodes::ReducedModelNode>(argc, argv, "reduced_model_node");
}
