#include "link_log.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "snapwing/common/error.h"
#include "snapwing/link/clock.h"
#include "snapwing/link/realtime.h"

namespace snapwing::link {
namespace {

std::string milliseconds(double seconds) { return std::to_string(std::llround(1000 * seconds)) + " ms"; }

std::string timeText(std::int64_t wall) {
  const time_t seconds = static_cast<time_t>(wall / 1000000);
  tm parts{};
  gmtime_r(&seconds, &parts);
  char text[40];
  const std::size_t size = strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &parts);
  std::snprintf(text + size, sizeof text - size, ".%03dZ", static_cast<int>(wall / 1000 % 1000));
  return text;
}

/// Standard error gets what it takes at once; a pipe that nobody reads must not hold up the log.
void say(const std::string& text) {
  const std::string line = "radio_bridge: " + text + "\n";
  pollfd out{STDERR_FILENO, POLLOUT, 0};
  if (poll(&out, 1, 0) <= 0) return;
  const ssize_t ignored = write(STDERR_FILENO, line.data(), line.size());
  (void)ignored;
}

/// Reads events until no process is left that could write one.
[[noreturn]] void runLog(int pipe, RotatingFile& file, const std::string& line) {
  sigset_t all;
  sigfillset(&all);
  sigprocmask(SIG_SETMASK, &all, nullptr);
  setsid();
  nameProcess("link_log");
  LogEvent event;
  while (true) {
    const ssize_t got = read(pipe, &event, sizeof event);
    if (got < 0 && errno == EINTR) continue;
    if (got != sizeof event) _exit(0);
    const std::string text = describe(event, line);
    file.write(timeText(event.wall) + " " + text + "\n");
    if (event.kind != LogKind::STARTED && event.kind != LogKind::ENDED) say(text);  // the program says those itself
  }
}

}  // namespace

std::string describe(const LogEvent& event, const std::string& line) {
  const std::string why = event.detail == 0 ? "" : std::string(": ") + std::strerror(static_cast<int>(event.detail));
  switch (event.kind) {
    case LogKind::STARTED:
      return "started on " + line;
    case LogKind::LINE_OPEN:
      return line + " is open";
    case LogKind::LINE_FAILED:
      return "cannot open " + line + why + "; trying on";
    case LogKind::LINE_CLOSED:
      return line + " is lost" + why + "; trying to open it again";
    case LogKind::CONTROLLER_SILENT:
      return "the flight controller does not answer on " + line +
             ": is MSP on at this port, are rate and wiring right?";
    case LogKind::CONTROLLER_KNOWN:
      return "flight controller read, settings accepted";
    case LogKind::CONTROLLER_REFUSED:
      return describe(Refusal::CONTROLLER_UNKNOWN, event.code);
    case LogKind::ARMED:
      return "armed";
    case LogKind::DISARMED:
      return std::string("disarmed: ") + describe(static_cast<Disarming>(event.code));
    case LogKind::FAULT:
      return "fault latched: " + describe(static_cast<Fault>(event.code), event.detail);
    case LogKind::RESET:
      return "fault reset";
    case LogKind::REFUSED:
      return "refused: " + describe(static_cast<Refusal>(event.code), event.detail) + " (" +
             std::to_string(std::llround(event.value)) + " refusals so far)";
    case LogKind::PULSE_BEGAN:
      return "pulse " + std::to_string(event.code) + " began: throttle " + std::to_string(event.value).substr(0, 5);
    case LogKind::PULSE_ENDED:
      return "pulse " + std::to_string(event.code) + " ended after " + milliseconds(event.seconds);
    case LogKind::GUARDIAN_TOOK_OVER:
      return event.code == 1 ? "guardian: the bridge died; the guardian sends throttle low and AUX1 low"
                             : "guardian: the bridge stood still and was ended; the guardian sends throttle low and "
                               "AUX1 low";
    case LogKind::GUARDIAN_ENDED_PULSE:
      return "guardian: ended; the line took " + std::to_string(event.detail) +
             " frames with throttle low and AUX1 "
             "low in " +
             milliseconds(event.seconds);
    case LogKind::ENDED:
      return event.detail == 0 ? "ended; nothing could be sent: " + line + " was not open"
                               : "ended; throttle low and AUX1 low went out in " + std::to_string(event.detail) +
                                     " frames over " + milliseconds(event.seconds);
    case LogKind::LINES_LOST:
      return std::to_string(event.detail) + " lines found no place here";
  }
  return "event " + std::to_string(static_cast<int>(event.kind));
}

RotatingFile::RotatingFile(std::string path, std::int64_t limit) : path_(std::move(path)), limit_(limit) {
  if (path_.empty()) return;
  open();
  if (descriptor_ < 0) throw common::FileError(path_, std::string("cannot write: ") + std::strerror(errno));
}

RotatingFile::~RotatingFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

void RotatingFile::open() {
  descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  struct stat known {};
  const bool file = descriptor_ >= 0 && fstat(descriptor_, &known) == 0 && S_ISREG(known.st_mode);
  size_ = file ? known.st_size : -1;  // a device or pipe is never renamed
}

void RotatingFile::write(const std::string& line) {
  if (path_.empty()) return;
  const auto added = static_cast<std::int64_t>(line.size());
  if (descriptor_ >= 0 && size_ > 0 && size_ + added > limit_) {
    close(descriptor_);
    std::rename(path_.c_str(), (path_ + ".1").c_str());
    descriptor_ = -1;
  }
  if (descriptor_ < 0) open();
  if (descriptor_ >= 0 && ::write(descriptor_, line.data(), line.size()) > 0 && size_ >= 0) size_ += added;
}

LogWriter::LogWriter(const std::string& path, std::int64_t limit, const std::string& line) {
  RotatingFile file(path, limit);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw common::Error(std::string("no pipe for the log: ") + std::strerror(errno));
  const pid_t child = fork();
  if (child < 0) throw common::Error(std::string("no process for the log: ") + std::strerror(errno));
  if (child == 0) {
    close(ends[1]);
    runLog(ends[0], file, line);
  }
  close(ends[0]);
  pipe_ = ends[1];
  fcntl(pipe_, F_SETFL, O_NONBLOCK);
}

LogWriter::~LogWriter() { close(pipe_); }

void LogWriter::note(LogKind kind, std::int64_t code, std::int64_t detail, double value, double seconds) const {
  const std::int64_t wall = wallMicroseconds();
  if (lost_ > 0) {
    const LogEvent loss{wall, LogKind::LINES_LOST, 0, lost_, 0, 0};
    if (::write(pipe_, &loss, sizeof loss) == sizeof loss) lost_ = 0;
  }
  const LogEvent event{wall, kind, code, detail, value, seconds};
  if (::write(pipe_, &event, sizeof event) != sizeof event) ++lost_;
}

}  // namespace snapwing::link
