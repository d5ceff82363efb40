#include "link_worker.h"

#include <chrono>
#include <cmath>
#include <exception>
#include <memory>

#include "snapwing/link/clock.h"
#include "snapwing/link/realtime.h"
#include "snapwing_lcm/abort_t.hpp"

namespace snapwing::nodes {
namespace {

using Request = link::ArmingProtocol::Request;
constexpr double TURN = 0.002;    ///< [s] longest wait for a message in a turn
constexpr double PATIENCE = 6.0;  ///< [s] for an answer; the protocol is always done earlier

std::string milliseconds(double seconds) { return std::to_string(std::lround(1e3 * seconds)) + " ms"; }

}  // namespace

LinkWorker::LinkWorker(const LinkWorkerSettings& settings, StatusCallback on_status, ImuCallback on_imu, Log log)
    : settings_(settings),
      on_status_(std::move(on_status)),
      on_imu_(std::move(on_imu)),
      log_(std::move(log)),
      link_(settings.lcm_url, link::Sealer(settings.key, settings.vehicle_id),
            [this](const link::BridgeStatus& status) {
              door_.noteStatus(link_.session(), status.number, link::monotonicSeconds());
              on_status_(status, link_);
              protocol_.step(view(), link::monotonicSeconds());
            }),
      protocol_(settings.times),
      door_(settings.key, settings.vehicle_id),
      alive_(link::monotonicSeconds()) {
  thread_ = std::thread([this] { run(); });
}

LinkWorker::~LinkWorker() {
  stop_ = true;
  thread_.join();
}

// -- the worker's thread

void LinkWorker::run() {
  link::takeRealtimePriority(link::OPERATOR_PRIORITY);
  while (!stop_) {
    try {
      turn();
    } catch (const std::exception& error) {
      log_(Level::ERROR, std::string("flight link: ") + error.what());
    }
  }
}

void LinkWorker::turn() {
  link_.handle(TURN);
  passImuOn();
  runTasks();
  const double now = link::monotonicSeconds();
  watchCallbacks(now);
  protocol_.step(view(), now);
  beat(now);
  keepCopies();
}

void LinkWorker::passImuOn() {
  if (!link_.telemetryKnown()) return;
  const snapwing_lcm::telemetry_t& telemetry = link_.telemetry();
  const bool news = telemetry.stamp.session != imu_session_ || telemetry.imu_number != imu_number_;
  imu_session_ = telemetry.stamp.session;
  imu_number_ = telemetry.imu_number;
  if (news && telemetry.imu_number > 0) on_imu_(telemetry);
}

/// A change of the wish is told at once.
void LinkWorker::beat(double now) {
  const bool held = deadmanHeld(now) && protocol_.deadmanAllowed();
  const bool wish = protocol_.armSwitch() && held;
  if (now < next_heartbeat_ && wish == wished_) return;
  wished_ = wish;
  next_heartbeat_ = now + settings_.heartbeat_period;
  link_.sendHeartbeat(protocol_.armSwitch(), held, protocol_.resetFlag());
}

/// Callbacks that do not come round could not take an abort either: that is a fault with a name.
void LinkWorker::watchCallbacks(double now) {
  const double late = now - alive_;
  if (late <= settings_.spin_timeout || !protocol_.armSwitch()) return;
  log_(Level::ERROR, "callbacks of this node are " + milliseconds(late) + " late: aborted");
  protocol_.ask(Request::ABORT, view(), now);
  link_.abort(snapwing_lcm::abort_t::LATE_OPERATOR);
}

bool LinkWorker::deadmanHeld(double now) {
  if (!settings_.deadman_topic) return true;
  const double age = now - deadman_time_;
  const bool fresh = age <= settings_.deadman_timeout;
  const bool silent = !fresh && age < 1e6;
  if (deadman_was_fresh_ && silent && protocol_.armSwitch()) {
    log_(Level::WARN, "no deadman message for " + milliseconds(age) + ": disarmed");
  }
  deadman_was_fresh_ = fresh;
  return fresh;
}

link::LinkView LinkWorker::view() const {
  link::LinkView view;
  view.alive = link_.bridgeAlive();
  view.conflict = link_.conflict();
  view.listened = link_.listened();
  view.deadman_held = !settings_.deadman_topic || link::monotonicSeconds() - deadman_time_ <= settings_.deadman_timeout;
  view.hint = link_.hint();
  view.status = link_.status();
  return view;
}

void LinkWorker::runTasks() {
  std::deque<Task> tasks;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    tasks.swap(tasks_);
  }
  for (const Task& task : tasks) task();
}

void LinkWorker::keepCopies() {
  const std::lock_guard<std::mutex> lock(mutex_);
  snapshot_.status = link_.status();
  snapshot_.counters = link_.counters();
  snapshot_.rejected_by_bridge = link_.messagesRejectedByBridge();
  snapshot_.status_age = link_.statusAge();
  if (link_.telemetryKnown()) snapshot_.telemetry = link_.telemetry();
  snapshot_.refused_here = refused_here_;
  snapshot_.hint = link_.hint();
  news_.notify_all();
}

void LinkWorker::refused(const std::string& what, const std::string& why) {
  ++refused_here_;
  log_(Level::WARN, what + " refused: " + why);
}

std::int64_t LinkWorker::begin(Request request, const link::CommandSeal& seal, std::string& refusal) {
  const double now = link::monotonicSeconds();
  if (request == Request::ARM || request == Request::RESET) {
    const bool arm = request == Request::ARM;
    const std::string content = arm ? link::armContent(true) : link::resetContent();
    refusal = link_.bridgeAlive() ? door_.judge(content, seal, settings_.request_age, now)
                                  : "no radio bridge heard" + (link_.hint().empty() ? "" : "; " + link_.hint());
    if (refusal.empty() && arm) refusal = scaleTrouble();
    if (!refusal.empty()) {
      refused(arm ? "arm" : "reset", refusal);
      return 0;
    }
  }
  const std::int64_t ticket = protocol_.ask(request, view(), now);
  if (request == Request::ABORT) link_.abort(snapwing_lcm::abort_t::OPERATOR);
  beat(now);
  return ticket;
}

std::string LinkWorker::scaleTrouble() const {
  const std::string mismatch = link::scaleMismatch(link_.status().throttle, settings_.throttle);
  return mismatch.empty() ? "" : "throttle is scaled in two ways: " + mismatch;
}

// -- any thread

void LinkWorker::post(Task task) {
  const std::lock_guard<std::mutex> lock(mutex_);
  tasks_.push_back(std::move(task));
}

link::ArmingAnswer LinkWorker::carryOut(Request request, const link::CommandSeal& seal) {
  struct Slip {
    std::int64_t ticket = 0;
    bool done = false;
    link::ArmingAnswer answer;
  };
  const auto slip = std::make_shared<Slip>();  // outlives a caller that has lost patience
  // Runs on the worker's thread until the request is over.
  const auto look = std::make_shared<Task>();
  const std::weak_ptr<Task> again = look;
  *look = [this, slip, request, seal, again] {
    if (slip->ticket == 0) {
      std::string refusal;
      slip->ticket = begin(request, seal, refusal);
      if (slip->ticket == 0) slip->answer.message = refusal;
    }
    link::ArmingAnswer answer;
    const bool over = slip->ticket == 0 || protocol_.answer(slip->ticket, answer);
    const std::lock_guard<std::mutex> lock(mutex_);
    if (slip->ticket != 0) slip->answer = answer;
    slip->done = over;
    if (const std::shared_ptr<Task> task = again.lock(); task && !over) tasks_.push_back([task] { (*task)(); });
  };
  post([look] { (*look)(); });
  std::unique_lock<std::mutex> lock(mutex_);
  news_.wait_for(lock, std::chrono::duration<double>(PATIENCE), [&] { return slip->done || stop_; });
  return slip->done ? slip->answer : link::ArmingAnswer{false, "no answer from this node's link thread"};
}

void LinkWorker::pulse(std::uint32_t id, const link::PulseShape& shape, const link::CommandSeal& seal) {
  post([this, id, shape, seal] {
    const std::string name = "pulse " + std::to_string(id);
    std::string why = door_.judge(link::pulseContent(id, shape), seal, settings_.pulse_age, link::monotonicSeconds());
    if (why.empty()) why = scaleTrouble();
    if (!why.empty()) return refused(name, why);
    if (id == last_pulse_) return;  // the planner's repetition of one that went on its way
    if (link_.sendPulse(id, shape)) {
      last_pulse_ = id;
    } else {
      refused(name, link_.aborting() ? "an abort is under way" : "no radio bridge heard");
    }
  });
}

void LinkWorker::noteAlive() { alive_ = link::monotonicSeconds(); }
void LinkWorker::setDeadman(bool held) { deadman_time_ = held ? link::monotonicSeconds() : -1e9; }

LinkSnapshot LinkWorker::snapshot() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return snapshot_;
}

}  // namespace snapwing::nodes
