/// simulated_vehicle_node: a vehicle that stands in for the real one. It is moved by nothing but the flight
/// controller's motor outputs (UDP) and the experimenter's hand (service hold), runs in real time, has parameters of
/// its own drawn within the uncertainty of the vehicle file, and publishes what its IMU measures and, for reports, the
/// truth.

#include <ros/console.h>
#include <ros/publisher.h>
#include <ros/service_server.h>
#include <sensor_msgs/Imu.h>
#include <snapwing/VehicleTruth.h>
#include <std_srvs/SetBool.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <memory>
#include <mutex>
#include <random>
#include <thread>

#include "clocks.h"
#include "conversions.h"
#include "imu_sender.h"
#include "motor_receiver.h"
#include "node_main.h"
#include "params.h"
#include "snapwing/common/time_watch.h"
#include "snapwing/link/realtime.h"
#include "snapwing/standin/plant.h"
#include "snapwing/vehicle/table_origin.h"
#include "snapwing/vehicle/trial.h"
#include "topics.h"

namespace snapwing::nodes {

namespace {

constexpr double DRIFT =
    0.2;  // [s] between real time and ROS time (at a rate of its own), after which stamps follow it

struct SimulationSettings {
  std::uint64_t seed = 0;
  bool nominal = false;
  vehicle::Mode initial_mode = vehicle::Mode::FIXED_WING;
  standin::PlantSettings plant;
  std::uint16_t motor_port = 0;
  double motor_timeout = 0;  ///< [s]
  double imu_period = 0;     ///< [s]
  double truth_period = 0;   ///< [s]
  double imu_noise = 0;      ///< [m/s2]
  double imu_bias = 0;       ///< [m/s2] standard deviation of the vehicle's own constant offset
  std::string imu_frame;
  std::uint16_t imu_port = 0;  ///< of a stand-in flight controller; 0 = none
};

SimulationSettings readSettings(Params& params, const vehicle::Vehicle& vehicle, const std::string& name_space) {
  SimulationSettings s;
  s.seed = static_cast<std::uint64_t>(params.integer("seed", 0, 1000000));
  s.nominal = params.boolean("nominal");
  s.initial_mode = vehicle::modeFromName(params.choice("initial_mode", {"F", "Q"}));
  s.plant.mount = vehicle::mountFor(vehicle, params.choice("mount", {"auto", "free", "boom", "held"}), "mount");
  s.plant.wings = vehicle::wingsFromName(params.choice("wings", {"auto", "on", "off"}));
  s.plant.gravity = params.number("gravity", {-9.83, 9.83}, "m/s2");
  s.plant.step = params.number("step", {1e-6, 1e-3}, "s");
  s.motor_port = static_cast<std::uint16_t>(params.integer("motor_port", 1, 65535));
  s.motor_timeout = params.number("motor_timeout", {0.01, 2.0}, "s");
  s.imu_period = 1 / params.number("imu_rate", {10.0, 1000.0}, "Hz");
  s.truth_period = 1 / params.number("truth_rate", {1.0, 1000.0}, "Hz");
  s.imu_noise = params.number("imu_noise", {0.0, 10.0}, "m/s2");
  s.imu_bias = params.number("imu_bias", {0.0, 2.0}, "m/s2");
  s.imu_port = static_cast<std::uint16_t>(params.integer("imu_port", 0, 65535));
  s.imu_frame = framePrefix(params, name_space) + params.text("imu_frame");
  return s;
}

}  // namespace

class SimulatedVehicleNode {
 public:
  explicit SimulatedVehicleNode(Handles& handles) : SimulatedVehicleNode(handles, Params::fromServer(handles.own)) {}

  ~SimulatedVehicleNode() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }

 private:
  SimulatedVehicleNode(Handles& handles, Params params)
      : vehicle_(params.vehicle()),
        settings_(readSettings(params, vehicle_, handles.relative.getNamespace())),
        plant_(makePlant()),
        receiver_(settings_.motor_port, settings_.motor_timeout),
        random_(settings_.seed + 1) {
    params.finish();
    plant_.reset(settings_.initial_mode);
    bias_ = settings_.imu_bias * normal_(random_);
    if (settings_.imu_port != 0) sender_ = std::make_unique<ImuSender>(settings_.imu_port);
    if (!sender_) imu_ = handles.relative.advertise<sensor_msgs::Imu>(topics::IMU, 100);
    truth_ = handles.relative.advertise<VehicleTruth>(topics::TRUTH, 100);
    hold_ = handles.relative.advertiseService(topics::HOLD, &SimulatedVehicleNode::hold, this);
    thread_ = std::thread([this] { run(); });
    link::leaveRealtimePriority();  // of the thread that spins
  }

  standin::Plant makePlant() const {
    const vehicle::ForceTable table = vehicle::armTableOf(vehicle_);
    const vehicle::VehicleParameters parameters = settings_.nominal
                                                      ? vehicle::realise(vehicle_, table)
                                                      : standin::drawParameters(vehicle_, table, settings_.seed);
    return standin::Plant(vehicle_, table, parameters, settings_.plant, vehicle::wingTableOf(vehicle_, table));
  }

  bool hold(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response) {
    const std::lock_guard<std::mutex> lock(mutex_);
    request.data ? plant_.grab() : plant_.release();
    response.success = true;
    response.message = request.data ? "the hand brakes the boom to rest and holds it" : "the hand lets go";
    return true;
  }

  /// Follows the clock in steps of a millisecond; samples are taken on their own fixed grids of simulated time, so a
  /// late wake-up delays messages but changes no number in them.
  void run() {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point start = Clock::now();
    double next_imu = settings_.imu_period, next_truth = settings_.truth_period;
    for (auto wake = start; !stop_ && ros::ok(); wake += std::chrono::milliseconds(1)) {
      std::this_thread::sleep_until(wake);
      const double now = std::chrono::duration<double>(Clock::now() - start).count();
      const std::lock_guard<std::mutex> lock(mutex_);
      lookAtClock(now);
      outputs_ = receiver_.outputs();
      while (std::min(next_imu, next_truth) <= now) {
        const bool imu_first = next_imu <= next_truth;
        plant_.advanceTo(imu_first ? next_imu : next_truth);
        imu_first ? publishImu(next_imu) : publishTruth(next_truth);
        (imu_first ? next_imu : next_truth) += imu_first ? settings_.imu_period : settings_.truth_period;
      }
      plant_.advanceTo(now);
      plant_.setMotorOutputs({outputs_.begin(), outputs_.end()});
    }
  }

  /// Stamps count in real time from where ROS time stood at the start or at its last jump: a clock of 10 Hz repeats
  /// none.
  void lookAtClock(double time) {
    const Clocks clocks = Clocks::read();
    const common::ClockEvent event = clock_.look(clocks.now, clocks.steady);
    if (event == common::ClockEvent::MISSING) return;
    const double drift = clocks.now - (offset_ + time);
    if (!stamped_ || event != common::ClockEvent::ON || std::abs(drift) > DRIFT) offset_ = clocks.now - time;
    stamped_ = true;
  }

  ros::Time stampAt(double time) const { return ros::Time(std::max(0.0, offset_ + time)); }

  /// To the flight controller, if it is to be the one that measures, else as a message.
  void publishImu(double time) {
    if (sender_) {
      sender_->send(plant_.centreSpecificForce() + bias_ + settings_.imu_noise * normal_(random_));
      return;
    }
    if (!stamped_) return;  // no message without a stamp
    sensor_msgs::Imu message;
    message.header.stamp = stampAt(time);
    message.header.frame_id = settings_.imu_frame;
    message.orientation_covariance[0] = -1;  // not measured
    message.angular_velocity_covariance[0] = -1;
    message.linear_acceleration.z = plant_.centreSpecificForce() + bias_ + settings_.imu_noise * normal_(random_);
    message.linear_acceleration_covariance[8] = settings_.imu_noise * settings_.imu_noise;
    imu_.publish(message);
  }

  void publishTruth(double time) {
    if (!stamped_) return;
    VehicleTruth message;
    const standin::PlantState& state = plant_.state();
    message.header.stamp = stampAt(time);
    message.mode = toMessage(plant_.mode());
    message.travel = state.travel();
    message.travel_rate = state.travelRate();
    message.position = state.ring_position;
    message.speed = state.ring_speed;
    message.thrust = state.thrust();
    message.arm_rotation = plant_.armRotation();
    message.motor_outputs.assign(outputs_.begin(), outputs_.end());
    message.held = plant_.held();
    truth_.publish(message);
  }

  vehicle::Vehicle vehicle_;
  SimulationSettings settings_;
  standin::Plant plant_;
  MotorReceiver receiver_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  double bias_ = 0;
  link::MotorOutputs outputs_{};
  common::ClockWatch clock_;
  bool stamped_ = false;  ///< there is a clock
  double offset_ = 0;     ///< [s] ROS time - time of the simulation
  ros::Publisher imu_;
  std::unique_ptr<ImuSender> sender_;
  ros::Publisher truth_;
  ros::ServiceServer hold_;
  std::mutex mutex_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace snapwing::nodes

int main(int argc, char** argv) {
  // Before ROS starts its threads, which inherit it.
  snapwing::link::takeRealtimePriority(snapwing::link::SIMULATION_PRIORITY);
  return snapwing::nodes::runNode<snapwing::nodes::SimulatedVehicleNode>(argc, argv, "simulated_vehicle_node");
}
