#pragma once
/// The guardian as a process: forked before any thread exists, without LCM, without allocation in its loop.

#include <sys/types.h>

#include <memory>

#include "bridge_loop.h"
#include "guardian.h"
#include "link_log.h"

namespace snapwing::link {

/// The bridge's end. Create it before the first thread, and before the line is opened.
class Guardian {
 public:
  /// Forks. The child never returns from here.
  /// @param log  both write to it; created before
  /// @param priority  SCHED_FIFO priority if allowed, 0 = none
  /// @throws common::Error if the process cannot be made
  Guardian(Protocol protocol, double frame_period, int priority, const LogWriter& log);
  ~Guardian();
  Guardian(const Guardian&) = delete;
  Guardian& operator=(const Guardian&) = delete;

  /// In memory that both processes map, as long as anybody holds it.
  const std::shared_ptr<GuardianRecord>& record() { return record_; }
  pid_t pid() const { return pid_; }
  /// Hands on the line's descriptor whenever the connection is another one; call with each frame. Never waits.
  /// @param descriptor  -1 if there is none
  void holdLine(int descriptor, int connection);
  /// The guardian lives, moves, and holds that connection. Call once per frame: it counts them.
  bool guards(int connection);
  /// The bridge has sent its own safe frames and is about to end.
  void endInOrder() { record_->orderly_end = true; }

 private:
  bool hungUp() const;
  std::shared_ptr<GuardianRecord> record_;
  int socket_ = -1;
  pid_t pid_ = 0;
  int handed_ = 0;  ///< connection last handed on, 0 = none
  std::uint64_t last_beat_ = 0;
  int still_ = 0, still_limit_ = 5;
};

}  // namespace snapwing::link
