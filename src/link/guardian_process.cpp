#include "guardian_process.h"

#include <poll.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>

#include "snapwing/common/error.h"
#include "snapwing/link/realtime.h"

namespace snapwing::link {
namespace {

/// Sends the line's descriptor, or -1 for none.
bool passDescriptor(int socket, int descriptor, std::int32_t connection) {
  iovec content{&connection, sizeof connection};
  alignas(cmsghdr) char control[CMSG_SPACE(sizeof(int))] = {};
  msghdr message{};
  message.msg_iov = &content;
  message.msg_iovlen = 1;
  if (descriptor >= 0) {
    message.msg_control = control;
    message.msg_controllen = sizeof control;
    cmsghdr* header = CMSG_FIRSTHDR(&message);
    header->cmsg_level = SOL_SOCKET;
    header->cmsg_type = SCM_RIGHTS;
    header->cmsg_len = CMSG_LEN(sizeof(int));
    std::memcpy(CMSG_DATA(header), &descriptor, sizeof descriptor);
  }
  return sendmsg(socket, &message, MSG_DONTWAIT | MSG_NOSIGNAL) >= 0;
}

/// @return false if nothing is there; descriptor -1 if the message has none
bool takeDescriptor(int socket, int& descriptor, std::int32_t& connection) {
  iovec content{&connection, sizeof connection};
  alignas(cmsghdr) char control[CMSG_SPACE(sizeof(int))] = {};
  msghdr message{};
  message.msg_iov = &content;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = sizeof control;
  if (recvmsg(socket, &message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC) != sizeof connection) return false;
  descriptor = -1;
  const cmsghdr* header = CMSG_FIRSTHDR(&message);
  if (header != nullptr && header->cmsg_type == SCM_RIGHTS) {
    std::memcpy(&descriptor, CMSG_DATA(header), sizeof descriptor);
  }
  return true;
}

/// The child's side.
class GuardianLoop {
 public:
  GuardianLoop(int socket, int bridge, GuardianRecord& record, Protocol protocol, double frame_period,
               const LogWriter& log)
      : socket_(socket),
        bridge_(bridge),
        record_(record),
        settings_(GuardianSettings::forPeriod(frame_period)),
        core_(settings_),
        frame_(BridgeLoop::safeFrame(protocol)),
        padding_(lineSettings(protocol).padding),
        log_(log) {}

  void run() {
    const int waking = static_cast<int>(1000 * settings_.waking);
    while (true) {
      pollfd waiting[] = {{socket_, POLLIN, 0}, {ended_ ? -1 : bridge_, POLLIN, 0}, {line_, 0, 0}};
      const int came = poll(waiting, broken_ ? 2 : 3, waking);
      record_.guardian_beat.fetch_add(1);
      if ((waiting[0].revents & POLLIN) != 0) takeLine();
      if ((waiting[0].revents & (POLLHUP | POLLERR)) != 0) socket_ = -1;
      if (waiting[1].revents != 0) ended_ = true;
      if (!broken_ && waiting[2].revents != 0) broken_ = true;  // hung up
      if (act(core_.step(seen(came == 0))) == GuardianAction::FINISHED) return;
    }
  }

 private:
  GuardianSeen seen(bool waking) const {
    GuardianSeen seen;
    seen.waking = waking;
    seen.beat = record_.beat;
    seen.active = record_.active;
    seen.bridge_ended = ended_;
    seen.orderly_end = record_.orderly_end;
    seen.line_open = line_ >= 0 && !broken_;
    if (core_.sending()) seen.backlog = backlog();
    return seen;
  }

  void takeLine() {
    int descriptor = -1;
    std::int32_t connection = 0;
    while (takeDescriptor(socket_, descriptor, connection)) {
      if (line_ >= 0) close(line_);
      line_ = descriptor;
      broken_ = false;
      record_.guarded_connection = line_ >= 0 ? connection : 0;
    }
  }

  GuardianAction act(GuardianAction action) {
    if (action == GuardianAction::KILL) syscall(SYS_pidfd_send_signal, bridge_, SIGKILL, nullptr, 0);
    if (action == GuardianAction::CLEAR_AND_SEND) clear();
    if (action == GuardianAction::CLEAR_AND_SEND || action == GuardianAction::SEND) {
      drain();
      const bool first = core_.frames() == 0 && !told_;
      core_.onSent(send());
      if (first) log_.note(LogKind::GUARDIAN_TOOK_OVER, static_cast<std::int64_t>(core_.reason()));
      told_ = true;
    }
    if (action == GuardianAction::FINISHED && core_.reason() != GuardianReason::NONE) {
      log_.note(LogKind::GUARDIAN_ENDED_PULSE, static_cast<std::int64_t>(core_.reason()), core_.frames(), 0,
                settings_.waking * core_.wakings());
    }
    return action;
  }

  int backlog() const {
    int waiting = 0;
    return ioctl(line_, TIOCOUTQ, &waiting) == 0 ? waiting : 0;
  }

  /// What waits is dropped where the line can do that, and a frame that may have been cut is filled up with zeros: with
  /// them its checksum is wrong, or its channels are invalid, and the next byte is the first of a new frame. An SBUS
  /// receiver drops a cut frame after a pause instead.
  void clear() {
    const bool cut = record_.open_bytes.exchange(0) > 0 || backlog() > 0 || rest_ > 0;
    tcflush(line_, TCOFLUSH);
    rest_ = 0;
    if (padding_ && cut) {
      std::memset(out_, 0, Transport::PADDING);
      rest_ = Transport::PADDING;
    } else if (!padding_) {
      const timespec pause{0, 4000000};
      nanosleep(&pause, nullptr);
    }
  }

  void drain() {
    std::uint8_t bytes[256];
    for (int i = 0; i < 16 && read(line_, bytes, sizeof bytes) > 0; ++i) {
    }
  }

  /// What is left of the last frame, then a new one. @return whether the line took all of it
  bool send() {
    if (rest_ == 0 || flushRest()) {
      if (rest_ == 0) {
        std::memcpy(out_, frame_.bytes.data(), frame_.size);
        rest_ = frame_.size;
      }
      return flushRest();
    }
    return false;
  }

  bool flushRest() {
    while (rest_ > 0) {
      const ssize_t sent = write(line_, out_, rest_);
      if (sent < 0 && errno == EINTR) continue;
      if (sent < 0 && errno != EAGAIN && errno != EWOULDBLOCK) broken_ = true;
      if (sent <= 0) return false;
      rest_ -= static_cast<std::size_t>(sent);
      std::memmove(out_, out_ + sent, rest_);
    }
    return true;
  }

  int socket_, bridge_;
  GuardianRecord& record_;
  GuardianSettings settings_;
  GuardianCore core_;
  WireFrame frame_;
  bool padding_;
  const LogWriter& log_;
  int line_ = -1;
  bool ended_ = false, broken_ = false, told_ = false;
  std::uint8_t out_[128] = {};
  std::size_t rest_ = 0;
};

/// Everything that the guardian needs from the system, then its loop. Never returns.
[[noreturn]] void runGuardian(int socket, pid_t bridge, GuardianRecord& record, Protocol protocol, double frame_period,
                              int priority, const LogWriter& log) {
  sigset_t all;
  sigfillset(&all);
  sigprocmask(SIG_SETMASK, &all, nullptr);  // it ends with the bridge; only SIGKILL ends it before
  setsid();                                 // what is sent to the bridge's process group does not reach it
  nameProcess("link_guardian");
  const auto descriptor = static_cast<int>(syscall(SYS_pidfd_open, bridge, 0));
  if (descriptor < 0 || getppid() != bridge) _exit(1);
  if (std::FILE* file = std::fopen("/proc/self/oom_score_adj", "w")) {
    std::fputs("-1000", file);
    std::fclose(file);
  }
  prctl(PR_SET_TIMERSLACK, 1UL, 0, 0, 0);
  record.realtime = takeRealtimePriority(priority);
  record.locked = priority > 0 && mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  GuardianLoop loop(socket, descriptor, record, protocol, frame_period, log);
  loop.run();
  _exit(0);
}

}  // namespace

Guardian::Guardian(Protocol protocol, double frame_period, int priority, const LogWriter& log) {
  void* memory = mmap(nullptr, sizeof(GuardianRecord), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  int ends[2];
  if (memory == MAP_FAILED) throw common::Error(std::string("no guardian: ") + std::strerror(errno));
  record_ = {new (memory) GuardianRecord, [](GuardianRecord* record) { munmap(record, sizeof *record); }};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) {
    throw common::Error(std::string("no guardian: ") + std::strerror(errno));
  }
  still_limit_ = std::max(5, static_cast<int>(0.1 / frame_period));
  const pid_t bridge = getpid();
  pid_ = fork();
  if (pid_ < 0) throw common::Error(std::string("no guardian: ") + std::strerror(errno));
  if (pid_ == 0) {
    close(ends[0]);
    runGuardian(ends[1], bridge, *record_, protocol, frame_period, priority, log);
  }
  close(ends[1]);
  socket_ = ends[0];
  const timespec pause{0, 1000000};
  for (int i = 0; i < 2000 && record_->guardian_beat == 0 && !hungUp(); ++i) nanosleep(&pause, nullptr);
  if (record_->guardian_beat == 0) throw common::Error("no guardian: it did not start (a kernel before 5.3?)");
}

Guardian::~Guardian() { close(socket_); }

void Guardian::holdLine(int descriptor, int connection) {
  const int wanted = descriptor >= 0 ? connection : 0;
  if (wanted != handed_ && passDescriptor(socket_, descriptor, wanted)) handed_ = wanted;
}

bool Guardian::hungUp() const {
  pollfd waiting{socket_, 0, 0};
  return poll(&waiting, 1, 0) > 0 && waiting.revents != 0;
}

bool Guardian::guards(int connection) {
  const std::uint64_t beat = record_->guardian_beat;
  still_ = beat == last_beat_ ? still_ + 1 : 0;
  last_beat_ = beat;
  return still_ < still_limit_ && !hungUp() && record_->guarded_connection == connection;
}

}  // namespace snapwing::link
