#pragma once
/// The thread of flight_link_node that talks to the radio bridge: the only one that touches OperatorLink, arming
/// protocol and door. Other threads hand it requests and read copies. No ROS in it: it must not wait for any callback.

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <mutex>
#include <string>
#include <thread>

#include "snapwing/common/loan.h"
#include "snapwing/link/arming_protocol.h"
#include "snapwing/link/command_seal.h"
#include "snapwing/link/operator_link.h"
#include "snapwing/vehicle/pulse.h"

namespace snapwing::nodes {

struct LinkWorkerSettings {
  std::string lcm_url, vehicle_id;
  link::Key key{};
  common::ThrottleScale throttle;  ///< with which commands are reckoned; the bridge must have the same
  double heartbeat_period = 0.02;  ///< [s]
  double spin_timeout = 0.15;      ///< [s] callbacks silent for longer: abort
  bool deadman_topic = false;      ///< deadman messages must keep coming
  double deadman_timeout = 0.15;   ///< [s]
  double pulse_age = 0.1;          ///< [s] of a pulse's seal
  double request_age = 0.5;        ///< [s] of the seal of arm and reset
  link::ArmingTimes times;
};

/// Copies for diagnostics.
struct LinkSnapshot {
  link::BridgeStatus status;
  link::LinkCounters counters;
  std::int64_t rejected_by_bridge = 0;
  double status_age = std::numeric_limits<double>::infinity();  ///< [s]
  snapwing_lcm::telemetry_t telemetry{};
  std::int64_t refused_here = 0;  ///< commands that the door or the link did not take
  std::string hint;
};

class LinkWorker : public common::Lender {
 public:
  /// Called on the worker's thread with each new status, before the door may be asked about it.
  using StatusCallback = std::function<void(const link::BridgeStatus& status, const link::OperatorLink& link)>;
  /// Called on the worker's thread with each new reading of the flight controller's accelerometer.
  using ImuCallback = std::function<void(const snapwing_lcm::telemetry_t& telemetry)>;
  enum class Level { INFO, WARN, ERROR };
  using Log = std::function<void(Level level, const std::string& line)>;

  /// @throws common::Error if the network refuses
  LinkWorker(const LinkWorkerSettings& settings, StatusCallback on_status, ImuCallback on_imu, Log log);
  ~LinkWorker();
  LinkWorker(const LinkWorker&) = delete;
  LinkWorker& operator=(const LinkWorker&) = delete;

  /// Starts a request and waits for its end. Safe from any thread.
  /// @param seal  judged for ARM and RESET, ignored for DISARM and ABORT: who wants to stop needs no key
  link::ArmingAnswer carryOut(link::ArmingProtocol::Request request, const link::CommandSeal& seal = {});
  /// Sends the pulse on if its seal is good. Does not wait.
  void pulse(std::uint32_t id, const link::PulseShape& shape, const link::CommandSeal& seal);
  /// The callbacks' thread has come round.
  void noteAlive();
  void setDeadman(bool held);
  LinkSnapshot snapshot() const;

 private:
  using Task = std::function<void()>;
  void run();
  void turn();
  void passImuOn();
  void beat(double now);
  void watchCallbacks(double now);
  bool deadmanHeld(double now);
  link::LinkView view() const;
  void post(Task task);
  void runTasks();
  void keepCopies();
  std::int64_t begin(link::ArmingProtocol::Request request, const link::CommandSeal& seal, std::string& refusal);
  std::string scaleTrouble() const;
  void refused(const std::string& what, const std::string& why);

  LinkWorkerSettings settings_;
  StatusCallback on_status_;
  ImuCallback on_imu_;
  Log log_;
  link::OperatorLink link_;
  link::ArmingProtocol protocol_;
  link::CommandDoor door_;
  std::int64_t imu_session_ = 0, imu_number_ = 0;  ///< of the last reading
  double next_heartbeat_ = 0;
  bool wished_ = false, deadman_was_fresh_ = true;
  std::int64_t refused_here_ = 0, last_pulse_ = -1;

  mutable std::mutex mutex_;  ///< guards what follows up to the atomics
  std::condition_variable news_;
  std::deque<Task> tasks_;
  LinkSnapshot snapshot_;
  std::atomic<bool> stop_{false};
  std::atomic<double> alive_, deadman_time_{-1e9};
  std::thread thread_;
};

}  // namespace snapwing::nodes
