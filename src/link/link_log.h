#pragma once
/// The link's log: bridge and guardian hand over events of fixed size without waiting; a process of its own turns them
/// into sentences for a file of bounded size and for standard error. A full disk or a stopped terminal holds up nobody.

#include <cstdint>
#include <string>

#include "snapwing/link/bridge_types.h"

namespace snapwing::link {

enum class LogKind : std::int32_t {
  STARTED = 1,
  LINE_OPEN = 2,
  LINE_FAILED = 3,        ///< detail: errno
  LINE_CLOSED = 4,        ///< detail: errno
  CONTROLLER_SILENT = 5,  ///< the line is open, and nobody answers
  CONTROLLER_KNOWN = 6,
  CONTROLLER_REFUSED = 7,  ///< code: check
  ARMED = 8,
  DISARMED = 9,               ///< code: Disarming
  FAULT = 10,                 ///< code: Fault, detail
  RESET = 11,                 ///< the fault was reset
  REFUSED = 12,               ///< code: Refusal, detail; value: refusals so far
  PULSE_BEGAN = 13,           ///< code: id, value: throttle
  PULSE_ENDED = 14,           ///< code: id, seconds: first frame with thrust to first without
  GUARDIAN_TOOK_OVER = 15,    ///< code: GuardianReason
  GUARDIAN_ENDED_PULSE = 16,  ///< code: GuardianReason, detail: frames, seconds
  ENDED = 17,                 ///< detail: safe frames that the line took, seconds
  LINES_LOST = 18,            ///< detail: number of events that found no place
};

struct LogEvent {
  std::int64_t wall = 0;  ///< [us] since 1970
  LogKind kind = LogKind::STARTED;
  std::int64_t code = 0, detail = 0;
  double value = 0, seconds = 0;
};

/// A sentence without time, e.g. "cannot open serial:/dev/ttyUSB0: No such file or directory".
std::string describe(const LogEvent& event, const std::string& line);

/// A text file that becomes FILE.1 when it would grow beyond the limit; the old FILE.1 is dropped.
class RotatingFile {
 public:
  /// @param path  empty: nothing is written. @throws common::FileError if it cannot be opened
  RotatingFile(std::string path, std::int64_t limit);
  ~RotatingFile();
  RotatingFile(const RotatingFile&) = delete;
  RotatingFile& operator=(const RotatingFile&) = delete;
  /// What cannot be written is lost; the next line is tried again.
  void write(const std::string& line);

 private:
  void open();
  std::string path_;
  std::int64_t limit_, size_ = 0;
  int descriptor_ = -1;
};

/// The writing end. Copies in forked processes write to the same log.
class LogWriter {
 public:
  /// Forks the process that writes. Create it before any thread.
  /// @param line  name of the line, for the sentences
  /// @throws common::Error, common::FileError
  LogWriter(const std::string& path, std::int64_t limit, const std::string& line);
  ~LogWriter();
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;
  /// Never waits, never allocates.
  void note(LogKind kind, std::int64_t code = 0, std::int64_t detail = 0, double value = 0, double seconds = 0) const;

 private:
  int pipe_ = -1;
  mutable std::int64_t lost_ = 0;
};

/// What a frame's status and line show that the one before did not.
class EventWatch {
 public:
  struct Line {
    bool open = false;
    int connections = 0;
    int error = 0;  ///< errno of the last attempt or loss; 0 = none
  };
  using Sink = void (*)(void* owner, const LogEvent& event);

  /// Call after each frame. An equal refusal is reported once a second, a missing line once.
  void look(const BridgeStatus& status, const Line& line, double now, void* owner, Sink sink);

 private:
  void lookAtLine(const Line& line, double now);
  void lookAtController(const BridgeStatus& status, const Line& line, double now);
  void lookAtState(const BridgeStatus& status);
  void lookAtPulse(const BridgeStatus& status);
  void tell(LogKind kind, std::int64_t code = 0, std::int64_t detail = 0, double value = 0, double seconds = 0);

  void* owner_ = nullptr;
  Sink sink_ = nullptr;
  BridgeStatus before_;
  Line line_;
  bool failure_told_ = false, known_ = false, silence_told_ = false;
  int check_told_ = 0;
  double open_since_ = 0;
  double refusal_told_ = -1e9;
  Refusal last_refusal_ = Refusal::NONE;
  bool in_pulse_ = false;
  std::int64_t pulse_ = 0;
  double pulse_since_ = 0;
};

}  // namespace snapwing::link
