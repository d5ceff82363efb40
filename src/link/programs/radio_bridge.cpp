/// radio_bridge: thrust pulses in as LCM messages, remote-control frames out at a fixed rate. No ROS, no planner,
/// nothing but the last watchdog before the flight controller's own. docs/safety.md says what it promises.
#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/timerfd.h>
#include <time.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <optional>

#include "bridge_lcm.h"
#include "bridge_loop.h"
#include "clock_watch.h"
#include "controller_check.h"
#include "guardian_process.h"
#include "link_log.h"
#include "own_arguments.h"
#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"
#include "snapwing/link/clock.h"
#include "snapwing/link/realtime.h"
#include "snapwing/link/transport.h"
#include "snapwing/vehicle/pulse.h"

namespace {

using namespace snapwing;

volatile sig_atomic_t stop_signal = 0;
volatile sig_atomic_t stop_event = -1;            ///< raised with it, so that a loop about to sleep does not
constexpr std::int64_t LOG_LIMIT = 1000000;       ///< [bytes] then the log's file becomes FILE.1
constexpr int GUARDIAN_ABOVE = 5;                 ///< priority of the guardian above the loop's
constexpr rlim_t MEMORY_ROOM = rlim_t{16} << 20;  ///< [bytes] that the running bridge may grow by

constexpr double CHECK_PATIENCE = 5.0;  ///< [s]

struct Options {
  std::string fc = "tcp:127.0.0.1:5761";
  std::string lcm_url = link::DEFAULT_LCM_URL;
  std::string protocol = "msp2";
  std::string key_file, create_key, log;
  std::string vehicle_id = link::DEFAULT_VEHICLE_ID;
  std::vector<std::string> allow;
  int realtime_priority = 50;
  bool check = false;
  std::string vehicle_file;
  link::BridgeSettings settings;
};

void onStop(int number) {
  const int before = errno;
  stop_signal = number;
  const std::uint64_t one = 1;
  if (stop_event >= 0 && write(stop_event, &one, sizeof one) < 0) errno = before;  // full: wakes as well
}

void catchSignals() {
  struct sigaction action {};
  sigemptyset(&action.sa_mask);
  action.sa_handler = onStop;
  for (int number = 1; number <= SIGRTMAX; ++number) sigaction(number, &action, nullptr);  // KILL and STOP refuse
  // A fault of the program ends it at once; the guardian sends the safe frames.
  for (const int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGSYS, SIGTRAP}) signal(number, SIG_DFL);
  for (const int number : {SIGPIPE, SIGTSTP, SIGTTIN, SIGTTOU}) signal(number, SIG_IGN);
  for (const int number : {SIGCHLD, SIGCONT, SIGURG, SIGWINCH}) signal(number, SIG_DFL);  // mean nothing
}

void addOptions(CLI::App& app, Options& o) {
  app.add_option("--fc", o.fc, "line to the flight controller: tcp:HOST:PORT, serial:/dev/NAME or pty:LINK")
      ->capture_default_str();
  app.add_option("--protocol", o.protocol, "msp1, msp2, sbus or crsf")->capture_default_str();
  app.add_option("--lcm-url", o.lcm_url, "LCM network; keep ttl=0 unless the operator sits on another machine")
      ->capture_default_str();
  app.add_option("--key-file", o.key_file,
                 "key shared with the operator's node, permissions 0600; default ~/.ros/snapwing_link_ID.key");
  app.add_option("--vehicle", o.vehicle_id, "id of the vehicle: goes into every message, others' are dropped")
      ->capture_default_str();
  app.add_option("--create-key", o.create_key, "draw a new key, write it to this file and end");
  app.add_option("--log", o.log,
                 "file for refusals, faults and pulses sent; at 1 MB it becomes FILE.1. All of it goes to standard "
                 "error as well");
  app.add_option("--allow", o.allow,
                 "checks of the flight controller that need not pass: " + link::allowableChecks() +
                     "; no-readback: do not ask it at all (needed with sbus and crsf)");
  app.add_option(
      "--vehicle-file", o.vehicle_file,
      "vehicle's YAML file: its radio.throttle_low, throttle_high, min_check and motor_idle hold on the wire");
  app.add_flag("--check", o.check,
               "ask the flight controller, print what is ready and what is not, and end: 0 ready, 1 not ready, 3 no "
               "answer; sends no channel and needs no key");
  app.add_option("--max-throttle", o.settings.max_throttle, "larger commands are refused [1]")->capture_default_str();
  app.add_option("--max-pulse", o.settings.max_pulse, "longer commands are refused [s]")->capture_default_str();
  app.add_option("--max-pitch", o.settings.max_pitch, "pitch stick with mixed control, 0 = not allowed [1]")
      ->capture_default_str();
  app.add_option("--min-rest", o.settings.min_rest, "pause between pulses [s]")->capture_default_str();
  app.add_option("--throttle-rise", o.settings.throttle_rise, "ramp from low to full, 0 = step [s]")
      ->capture_default_str();
  app.add_option("--heartbeat-timeout", o.settings.heartbeat_timeout, "silence of the operator that disarms [s]")
      ->capture_default_str();
  app.add_option("--frame-period", o.settings.frame_period, "[s]")->capture_default_str();
  app.add_flag("--pilot-override", o.settings.pilot_override,
               "the pilot's receiver leads and these frames count on masked channels only, while the pilot holds the "
               "MSP OVERRIDE switch; the pilot arms");
  app.add_flag("--imu", o.settings.imu.ask,
               "ask the flight controller's accelerometer too, 20 times a second, for a vehicle on which nothing else "
               "measures; over MSP only");
  app.add_option("--imu-counts-per-g", o.settings.imu.counts_per_g,
                 "numbers per g in the answer to MSP_RAW_IMU [1/g]; upright at rest the IMU must read 9.8 m/s2")
      ->capture_default_str();
  app.add_option("--realtime-priority", o.realtime_priority, "SCHED_FIFO priority of the loop if allowed, 0 = none")
      ->check(CLI::Range(0, 90))
      ->capture_default_str();
}

/// Sleeps until an absolute time, a message or bytes on the line; a loop held up on its way here is not late for that.
class Waiter {
 public:
  explicit Waiter(int arrivals) : arrivals_(arrivals), timer_(timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK)) {
    if (timer_ < 0) throw common::Error("no timer");
  }
  ~Waiter() { close(timer_); }
  Waiter(const Waiter&) = delete;
  Waiter& operator=(const Waiter&) = delete;

  void sleep(double until, int line) {
    itimerspec when{};
    when.it_value.tv_sec = static_cast<time_t>(until);
    when.it_value.tv_nsec = std::max(1L, static_cast<long>(1e9 * (until - std::floor(until))));
    timerfd_settime(timer_, TFD_TIMER_ABSTIME, &when, nullptr);
    pollfd waiting[] = {{timer_, POLLIN, 0}, {arrivals_, POLLIN, 0}, {line, POLLIN, 0}};
    if (poll(waiting, 3, -1) <= 0 || waiting[1].revents == 0) return;
    std::uint64_t ignored = 0;
    if (read(arrivals_, &ignored, sizeof ignored) < 0) return;
  }

 private:
  int arrivals_, timer_;
};

/// What the loop needs besides itself.
struct Surroundings {
  link::BridgeLcm& lcm;
  link::Transport& transport;
  link::Guardian& guardian;
  const link::LogWriter& log;
  link::ClockWatch clocks;
  link::EventWatch events;
  std::int64_t before_shutdown = 0;  ///< frames
  double shutdown_since = -1;
};

int connectionOf(const link::Transport& line) { return line.connected() ? line.connections() : 0; }

/// The guardian is looked at right before the frame that its death makes a safe one.
void sendFrame(link::BridgeLoop& loop, Surroundings& around, double now) {
  const link::Transport& line = around.transport;
  loop.core().onGuardian(around.guardian.guards(connectionOf(line)));
  loop.frame(now);
  around.guardian.holdLine(line.connected() ? line.descriptor() : -1, connectionOf(line));
  around.events.look(loop.core().status(), {line.connected(), line.connections(), line.lastError()}, now, &around,
                     [](void* owner, const link::LogEvent& e) {
                       static_cast<Surroundings*>(owner)->log.note(e.kind, e.code, e.detail, e.value, e.seconds);
                     });
  around.lcm.notify();
}

/// @return when the bridge was asked to end and has sent its safe frames, or could not for as long
void run(link::BridgeLoop& loop, Surroundings& around) {
  Waiter waiter(around.lcm.arrivals());
  stop_event = around.lcm.arrivals();
  while (true) {
    const link::ClockReading clocks = link::readClocks();
    const double now = clocks.monotonic;
    const double jump = around.clocks.look(clocks);
    if (jump > 0) loop.core().onClockJump(jump);
    if (stop_signal != 0 && around.shutdown_since < 0) {
      around.shutdown_since = now;
      around.before_shutdown = loop.core().status().frames_sent;
      loop.core().requestShutdown(now);
    }
    if (jump > 0 || now >= loop.nextFrameTime(now)) {  // what `now` says may not be waited for after a jump
      sendFrame(loop, around, now);
      if (loop.core().shutdownDone(now)) {
        stop_event = -1;
        return;
      }
    } else {
      loop.takeIn(now);
      waiter.sleep(loop.nextWakeTime(now), around.transport.connected() ? around.transport.descriptor() : -1);
    }
  }
}

int check(const Options& o, link::Protocol protocol, const std::set<std::string>& allowed) {
  const std::unique_ptr<link::Transport> line = link::makeTransport(o.fc, link::lineSettings(protocol));
  const link::CheckReport report = link::checkController(*line, link::mspVersion(protocol),
                                                         link::controllerRules(o.settings, allowed), CHECK_PATIENCE);
  std::printf("flight controller on %s:\n%s", o.fc.c_str(), report.text.c_str());
  return static_cast<int>(report.result);
}

/// Any end without safe frames is the guardian's business: no core file, no unwinding, nothing that takes time.
void endFastWhenItCrashes() {
  const rlimit none{0, 0};
  setrlimit(RLIMIT_CORE, &none);
  prctl(PR_SET_DUMPABLE, 0, 0, 0, 0);
}

/// A leak then ends this process alone, and at once: a large one takes long to be torn down, and the machine would
/// stand still first.
void boundMemory() {
  std::FILE* file = std::fopen("/proc/self/statm", "r");
  long pages[6] = {};
  const bool known = file != nullptr && std::fscanf(file, "%ld %ld %ld %ld %ld %ld", &pages[0], &pages[1], &pages[2],
                                                    &pages[3], &pages[4], &pages[5]) == 6;
  if (file != nullptr) std::fclose(file);
  if (!known) return;
  const auto used = static_cast<rlim_t>(pages[5]) * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
  const rlimit bound{used + MEMORY_ROOM, used + MEMORY_ROOM};
  setrlimit(RLIMIT_DATA, &bound);
}

/// @return exit code
int ended(link::BridgeLoop& loop, const Surroundings& around, const Options& o) {
  const link::BridgeStatus& status = loop.core().status();
  link::LogEvent event{0, link::LogKind::ENDED,
                       0, status.frames_sent - around.before_shutdown,
                       0, status.frame_time - around.shutdown_since};
  around.log.note(event.kind, event.code, event.detail, event.value, event.seconds);
  std::fprintf(stderr, "radio_bridge: %s\n", link::describe(event, o.fc).c_str());
  return 0;
}

int fly(const Options& o, link::Protocol protocol, bool blind, const std::set<std::string>& allowed,
        const link::Sealer& sealer) {
  const std::unique_ptr<link::Transport> transport = link::makeTransport(o.fc, link::lineSettings(protocol));
  o.settings.validate();
  // Both processes before the first thread; a wrong setting has been told by now.
  const link::LogWriter log(o.log, LOG_LIMIT, o.fc);
  const int guardian_priority = o.realtime_priority > 0 ? o.realtime_priority + GUARDIAN_ABOVE : 0;
  link::Guardian guardian(protocol, o.settings.frame_period, guardian_priority, log);
  const std::int64_t session = link::randomId();
  link::BridgeLoop loop(o.settings, protocol, !blind, allowed, *transport, session, link::monotonicSeconds());
  loop.publishTo(guardian.record());
  endFastWhenItCrashes();
  prctl(PR_SET_TIMERSLACK, 1UL, 0, 0, 0);
  // LCM's threads inherit a little less than the loop gets afterwards.
  if (o.realtime_priority > 0 && !link::takeRealtimePriority(std::max(1, o.realtime_priority - 10)))
    setpriority(PRIO_PROCESS, 0, -15);
  link::BridgeLcm lcm(o.lcm_url, sealer, session, loop.inbox(), loop.outbox());
  std::fprintf(stderr, "radio_bridge %s: vehicle %s, line %s, %s, %s, guardian %d\n", common::version().c_str(),
               o.vehicle_id.c_str(), o.fc.c_str(), o.protocol.c_str(), o.lcm_url.c_str(), guardian.pid());
  log.note(link::LogKind::STARTED);
  const bool realtime = link::takeRealtimePriority(o.realtime_priority);
  // After the threads are there: under a small limit it fails here, and not in the middle of the work.
  const bool locked = o.realtime_priority > 0 && mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  boundMemory();
  loop.core().noteGrants(realtime, locked);
  std::fprintf(stderr, "radio_bridge: real-time priority %s, memory %s\n", realtime ? "granted" : "not granted",
               locked ? "locked" : "not locked");
  Surroundings around{lcm, *transport, guardian, log, {}, {}};
  try {
    run(loop, around);
  } catch (const std::exception& error) {  // the guardian goes on from here, and must not wait for threads to end
    std::fprintf(stderr, "radio_bridge: %s\n", error.what());
    _exit(2);
  }
  guardian.endInOrder();
  return ended(loop, around, o);
}

int start(const Options& o) {
  if (!o.create_key.empty()) {
    link::createKeyFile(o.create_key);
    std::printf("%s\n", o.create_key.c_str());
    return 0;
  }
  std::set<std::string> allowed(o.allow.begin(), o.allow.end());
  const bool blind = allowed.erase("no-readback") > 0;
  const link::Protocol protocol = link::protocolFromName(o.protocol);
  const bool can_ask = protocol == link::Protocol::MSP1 || protocol == link::Protocol::MSP2;
  if (!can_ask && o.check) {
    throw common::SettingError("radio bridge", "check", o.protocol, "msp1 or msp2: other lines cannot be asked");
  }
  if (!can_ask && !blind) {
    throw common::SettingError("radio bridge", "allow", "",
                               "no-readback must be named: " + o.protocol + " cannot be asked");
  }
  if (o.settings.imu.ask && (blind || !can_ask))
    throw common::SettingError("radio bridge", "imu", "on", "off where the controller is not asked (no-readback)");
  if (o.check) return check(o, protocol, allowed);
  const std::string key_file = o.key_file.empty() ? link::defaultKeyFile(o.vehicle_id) : o.key_file;
  const link::Sealer sealer(link::loadKeyFile(key_file), o.vehicle_id);
  return fly(o, protocol, blind, allowed, sealer);
}

}  // namespace

int main(int argc, char** argv) {
  catchSignals();
  link::keepArguments(argc, argv);
  CLI::App app{"Radio bridge: LCM pulse commands to remote-control frames, with its own watchdog"};
  Options options;
  addOptions(app, options);
  try {
    app.parse(ownArguments(argc, argv));
    if (!options.vehicle_file.empty()) options.settings.useScale(vehicle::throttleScaleOf(options.vehicle_file));
    return start(options);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "radio_bridge: %s\n", error.what());
    return 2;
  }
}
