#include "controller_check.h"

#include <poll.h>

#include <cmath>

#include "controller_watch.h"
#include "snapwing/link/clock.h"

namespace snapwing::link {
namespace {

constexpr double SLOW_ANSWER = 0.1;  ///< [s] gaps between frames must stay below
constexpr int TICK = 10;             ///< [ms] at most one question in two of them, as beside a stream of frames

void takeAnswers(Transport& line, MspParser& parser, ControllerWatch& watch) {
  std::array<std::uint8_t, 512> bytes;
  while (const std::size_t got = line.read(bytes.data(), bytes.size())) {
    for (std::size_t i = 0; i < got; ++i) {
      if (parser.push(bytes[i])) watch.onPacket(parser.packet(), monotonicSeconds());
    }
    if (got < bytes.size()) return;
  }
}

void askNext(Transport& line, ControllerWatch& watch, double now) {
  MspPacket question;
  if (!watch.nextRequest(now, question)) return;
  std::array<std::uint8_t, 16> bytes;
  line.write(bytes.data(), encodeMsp(question, bytes.data(), bytes.size()), now);
}

std::string milliseconds(double seconds) { return std::to_string(std::lround(1e3 * seconds)) + " ms"; }

std::string lineOf(const char* mark, const std::string& text) { return std::string(mark) + text + "\n"; }

}  // namespace

CheckReport reportOn(const ControllerAnswers& answers, const ControllerRules& rules, double slowest) {
  CheckReport report;
  int failed = 0;
  for (const Finding& finding : findings(answers, rules)) {
    if (finding.passed) {
      report.text += lineOf("  ok         ", finding.found);
    } else if (finding.allowed) {
      report.text += lineOf("  allowed    ", finding.found + ": " + describe(finding.check));
    } else {
      ++failed;
      report.text += lineOf("  NOT READY  ", finding.found + ": " + describe(finding.check));
    }
  }
  const bool slow = slowest > SLOW_ANSWER;
  if (slow) {
    report.text +=
        lineOf("  NOT READY  ", "slow: an answer took " + milliseconds(slowest) +
                                    "; no other program may use the port, and a telemetry radio is not a line "
                                    "for pulses");
  } else if (slowest > 0) {
    report.text += lineOf("  ok         ", "answers within " + milliseconds(slowest));
  }
  for (const std::string& setting : unreadableSettings(rules)) {
    report.text += lineOf("  look       ", "cannot be read: " + setting);
  }
  failed += slow ? 1 : 0;
  report.result = failed == 0 ? CheckResult::READY : CheckResult::NOT_READY;
  report.text += failed == 0 ? "ready\n" : "not ready: " + std::to_string(failed) + " to mend\n";
  return report;
}

CheckReport checkController(Transport& line, MspVersion version, const ControllerRules& rules, double patience) {
  ControllerWatch watch(version, rules);
  MspParser parser;
  int connections = 0;
  bool foreign = false;
  const double end = monotonicSeconds() + patience;
  for (double now = monotonicSeconds(); now < end; now = monotonicSeconds()) {
    line.maintain(now);
    if (line.connected() && line.connections() != connections) {
      connections = line.connections();
      parser.reset();
      watch.connected(now);
    }
    if (line.connected()) {
      takeAnswers(line, parser, watch);
      foreign = watch.failedCheck() == Check::INAV || watch.failedCheck() == Check::CONTROLLER;
      if (watch.answers().complete() || foreign) break;
      askNext(line, watch, now);
    }
    pollfd waiting{line.connected() ? line.descriptor() : -1, POLLIN, 0};
    poll(&waiting, 1, TICK);
  }
  if (watch.answers().complete() || foreign) return reportOn(watch.answers(), rules, watch.slowestAnswer());
  CheckReport report;
  if (connections == 0) {
    report.text = "not ready: the line cannot be opened (device missing, another program uses it, or nobody listens)\n";
  } else if (watch.telemetry().replies + watch.telemetry().reply_errors == 0) {
    report.text =
        "not ready: the line is open and nothing answers (power, wiring, MSP on that port: `serial` lists the ports; a "
        "second caller on TCP is refused while the first lives)\n";
  } else {
    report.text = "not ready: only a part of the questions was answered within " + milliseconds(patience) + "\n";
  }
  return report;
}

}  // namespace snapwing::link
