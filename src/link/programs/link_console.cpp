/// link_console: the operator's end of the link on a terminal, without ROS; for bench work and tests. Commands on
/// standard input, one a line: arm, disarm, reset, pulse ID THROTTLE SECONDS [PITCH], abort or stop, deadman on|off,
/// quit, and hold ID THROTTLE SECONDS HOLD_THROTTLE HOLD_SECONDS for a pulse that goes over into a second level. Status
/// as lines of JSON on standard output. It is the heartbeat: when it ends or stops, the bridge disarms.
#include <poll.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <sstream>
#include <vector>

#include "snapwing/common/error.h"
#include "snapwing/link/clock.h"
#include "snapwing/link/operator_link.h"
#include "snapwing/link/realtime.h"
#include "snapwing_lcm/abort_t.hpp"

namespace {

using namespace snapwing;

struct Operator {
  bool arm = false, deadman = true, quit = false;
  double reset_until = 0;
  bool changed = false;  ///< the bridge hears of it at once, not with the next heartbeat
};

std::string listed(const link::Histogram& histogram) {
  std::string text;
  for (const std::int64_t count : histogram) text += (text.empty() ? "" : ", ") + std::to_string(count);
  return text;
}

void printStatus(const link::OperatorLink& link, double now) {
  const link::BridgeStatus& s = link.status();
  std::printf(
      "{\"t\": %.6f, \"frame_time\": %.6f, \"state\": \"%s\", \"fault\": \"%s\", \"pulse_id\": %lld, \"throttle\": "
      "%.4f, "
      "\"throttle_us\": %d, \"aux1_us\": %d, \"frames\": %lld, \"dropped\": %lld, \"accepted\": %lld, \"refused\": "
      "%lld, "
      "\"rejected\": %lld, \"refusal\": \"%s\", \"latency_worst\": %.6f, \"connected\": %d, \"known\": %d, \"armed\": "
      "%d, "
      "\"hint\": \"%s\", \"failsafe\": %d, \"flags\": %u, \"missed\": %lld, \"realtime\": %d, \"locked\": %d, "
      "\"periods\": [%s]}\n",
      now, s.frame_time, link::stateName(s.state), link::describe(s.fault, s.fault_detail).c_str(),
      static_cast<long long>(s.pulse_id), s.commanded_throttle, s.channels.us[link::THROTTLE],
      s.channels.us[link::AUX1], static_cast<long long>(s.frames_sent), static_cast<long long>(s.frames_dropped),
      static_cast<long long>(s.commands_accepted), static_cast<long long>(s.commands_refused),
      static_cast<long long>(link.messagesRejectedByBridge()),
      link::describe(s.last_refusal, s.last_refusal_detail).c_str(), s.latency_worst, s.controller.connected ? 1 : 0,
      s.controller.known ? 1 : 0, s.controller.armed ? 1 : 0, link.hint().c_str(), s.controller.failsafe ? 1 : 0,
      s.controller.arming_flags, static_cast<long long>(link.counters().missed), s.realtime ? 1 : 0,
      s.memory_locked ? 1 : 0, listed(s.period_histogram).c_str());
}

void say(const char* what) { std::printf("{\"said\": \"%s\"}\n", what); }

/// Numbers behind `pulse` or `hold`. @return none unless each word is one: half of a number is another number
std::vector<double> numbersIn(std::istringstream& words) {
  std::vector<double> numbers;
  for (std::string word; words >> word;) {
    char* end = nullptr;
    numbers.push_back(std::strtod(word.c_str(), &end));
    if (*end != '\0' || word.find_first_not_of("0123456789+-.eE") != std::string::npos) return {};
  }
  return numbers;
}

void sendPulse(std::istringstream& words, bool hold, link::OperatorLink& link) {
  const std::vector<double> numbers = numbersIn(words);
  const bool right = hold ? numbers.size() == 5 : numbers.size() == 3 || numbers.size() == 4;
  if (!right || numbers[0] < 1 || numbers[0] > link::MAX_PULSE_ID || numbers[0] != std::floor(numbers[0])) {
    return say(hold ? "not sent; allowed: hold ID THROTTLE SECONDS HOLD_THROTTLE HOLD_SECONDS, numbers with a point"
                    : "not sent; allowed: pulse ID THROTTLE SECONDS [PITCH], numbers with a point");
  }
  link::PulseShape shape;
  shape.throttle = numbers[1], shape.duration = numbers[2];
  if (hold) shape.hold_throttle = numbers[3], shape.hold_duration = numbers[4];
  shape.mixed = !hold && numbers.size() == 4;
  if (shape.mixed) shape.pitch = numbers[3];
  const auto id = static_cast<std::int64_t>(numbers[0]);
  const double now = link::monotonicSeconds();
  if (link.sendPulse(id, shape)) std::printf("{\"sent\": %lld, \"t\": %.6f}\n", static_cast<long long>(id), now);
}

void obey(const std::string& line, link::OperatorLink& link, Operator& o) {
  static const std::set<std::string> VERBS = {"arm", "disarm", "reset", "deadman", "quit", "abort", "pulse", "hold"};
  std::istringstream words(line);
  std::string verb;
  words >> verb;
  std::transform(verb.begin(), verb.end(), verb.begin(), [](unsigned char c) { return std::tolower(c); });
  if (verb == "stop") verb = "abort";  // who means that must not have to look a word up
  o.changed = true;
  if (!verb.empty() && VERBS.count(verb) == 0) {
    return say(
        "not understood; allowed: abort (or stop), disarm, arm, reset, deadman on, deadman off, pulse, hold, quit");
  }
  if (verb == "arm") o.arm = true;
  if (verb == "disarm") o.arm = false;
  if (verb == "reset") {
    o.arm = false;
    o.deadman = true;  // an abort has let it go
    o.reset_until = link::monotonicSeconds() + 0.1;
  }
  if (verb == "deadman") {
    words >> verb;
    o.deadman = verb == "on";
  }
  if (verb == "quit") o.quit = true;
  if (verb == "abort") {  // repeated until the bridge shows the fault; switch and deadman stay off afterwards
    o.arm = o.deadman = false;
    if (!link.abort(snapwing_lcm::abort_t::OPERATOR)) say("no radio bridge was ever heard");
  }
  if (verb == "pulse" || verb == "hold") sendPulse(words, verb == "hold", link);
}

/// Takes whole lines from standard input as they come; its end means quit.
void readLines(std::string& rest, link::OperatorLink& link, Operator& o) {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  if (poll(&input, 1, 0) <= 0) return;
  char bytes[1024];
  const ssize_t got = read(STDIN_FILENO, bytes, sizeof bytes);
  if (got <= 0) {
    o.quit = true;
    return;
  }
  rest.append(bytes, static_cast<std::size_t>(got));
  for (std::size_t end = rest.find('\n'); end != std::string::npos; end = rest.find('\n')) {
    obey(rest.substr(0, end), link, o);
    rest.erase(0, end + 1);
  }
}

int run(const std::string& url, const link::Sealer& sealer, double heartbeat_period) {
  link::takeRealtimePriority(link::OPERATOR_PRIORITY);
  link::OperatorLink link(url, sealer);
  Operator o;
  std::string rest;
  double next_heartbeat = 0;
  std::int64_t shown = 0;
  while (!o.quit) {
    link.handle(0.002);
    const double now = link::monotonicSeconds();
    readLines(rest, link, o);
    if (link.counters().statuses != shown) {
      shown = link.counters().statuses;
      printStatus(link, now);
      std::fflush(stdout);
    }
    if (now < next_heartbeat && !o.changed) continue;
    o.changed = false;
    next_heartbeat = now + heartbeat_period;
    link.sendHeartbeat(o.arm, o.deadman, now < o.reset_until);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Operator's console of the radio link"};
  std::string url = link::DEFAULT_LCM_URL, key_file, vehicle_id = link::DEFAULT_VEHICLE_ID;
  double period = 0.02;
  app.add_option("--lcm-url", url, "LCM network")->capture_default_str();
  app.add_option("--key-file", key_file, "key shared with the bridge; default ~/.ros/snapwing_link_ID.key");
  app.add_option("--vehicle", vehicle_id, "id of the vehicle, as given to the bridge")->capture_default_str();
  app.add_option("--heartbeat-period", period, "[s]")->check(CLI::Range(0.005, 1.0))->capture_default_str();
  try {
    app.parse(argc, argv);
    if (key_file.empty()) key_file = link::defaultKeyFile(vehicle_id);
    return run(url, link::Sealer(link::loadKeyFile(key_file), vehicle_id), period);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "link_console: %s\n", error.what());
    return 2;
  }
}
