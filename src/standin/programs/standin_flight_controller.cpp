/// standin_flight_controller: answers MSP (or hears SBUS, CRSF) with the measured timing of a real flight controller
/// and sends its motor outputs as UDP datagrams. For tests and the simulated vehicle.
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "own_arguments.h"
#include "snapwing/common/error.h"
#include "snapwing/link/clock.h"
#include "snapwing/link/realtime.h"
#include "snapwing/link/transport.h"
#include "standin_controller.h"
#include "standin_port.h"
#include "standin_wrong.h"

namespace {

using namespace snapwing;

volatile sig_atomic_t stop_signal = 0;
void onStop(int number) { stop_signal = number; }

struct Options {
  std::string listen = "127.0.0.1:5761";
  std::string pty;
  std::string protocol = "msp";
  std::string motor_host = "127.0.0.1";
  int motor_port = link::MOTOR_STREAM_PORT;
  int imu_port = 0;
  std::string events;
  double period = 0.001;
  std::string variant;
  std::vector<std::string> wrong;
  standin::StandinSettings settings;
};

sockaddr_in ipv4(const std::string& host, int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  if (inet_pton(AF_INET, host.c_str(), &address.sin_addr) != 1) {
    throw common::SettingError("stand-in", "host", host, "an IPv4 address");
  }
  return address;
}

/// Where bytes come from and answers go: a TCP port that refuses others while one caller lives, or a pseudo-terminal.
class Port {
 public:
  explicit Port(const Options& o) {
    if (!o.pty.empty()) {
      pty_ = link::makeTransport("pty:" + o.pty, {});
      std::printf("standin_flight_controller: pseudo-terminal %s\n", o.pty.c_str());
      return;
    }
    const std::size_t colon = o.listen.rfind(':');
    const std::optional<int> port = link::portNumber(colon == std::string::npos ? "" : o.listen.substr(colon + 1));
    if (!port) throw common::SettingError("stand-in", "listen", o.listen, "ADDRESS:PORT with a port within [0, 65535]");
    const std::string host = o.listen.substr(0, colon);
    sockaddr_in address = ipv4(host, *port);
    listener_ = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    const int on = 1;
    setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    if (bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 || ::listen(listener_, 4) != 0) {
      throw common::Error("cannot listen on " + o.listen + ": " + std::strerror(errno));
    }
    socklen_t size = sizeof address;
    getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    std::printf("standin_flight_controller: listening on %s:%d\n", host.c_str(), ntohs(address.sin_port));
  }

  void wait(double seconds) {
    pollfd waiting[2] = {{listener_, POLLIN, 0}, {pty_ ? pty_->descriptor() : client_, POLLIN, 0}};
    timespec timeout{0, static_cast<long>(1e9 * seconds)};
    ppoll(waiting, 2, &timeout, nullptr);
  }

  /// @return true if a new caller came: what the last one began is void
  bool accept() {
    if (listener_ < 0) return false;
    const int caller = accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (caller < 0) return false;
    if (callerLives()) {
      close(caller);
      return false;
    }
    client_ = caller;
    const int on = 1;
    setsockopt(client_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    return true;
  }

  std::size_t read(std::uint8_t* out, std::size_t capacity) {
    if (pty_) return pty_->read(out, capacity);
    if (client_ < 0) return 0;
    const ssize_t got = ::read(client_, out, capacity);
    if (got > 0) return static_cast<std::size_t>(got);
    if (got == 0 || (errno != EAGAIN && errno != EINTR)) hangUp();
    return 0;
  }

  void write(const std::uint8_t* bytes, std::size_t size, double now) {
    if (pty_) {
      pty_->write(bytes, size, now);
    } else if (client_ >= 0 && ::write(client_, bytes, size) < 0 && errno != EAGAIN && errno != EINTR) {
      hangUp();
    }
  }

 private:
  /// False, and closed, if the caller has gone and all that it sent was read.
  bool callerLives() {
    std::uint8_t byte = 0;
    const ssize_t got = client_ < 0 ? 0 : recv(client_, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
    if (client_ >= 0 && (got > 0 || (got < 0 && (errno == EAGAIN || errno == EINTR)))) return true;
    hangUp();
    return false;
  }

  void hangUp() {
    if (client_ >= 0) close(client_);
    client_ = -1;
  }

  std::unique_ptr<link::Transport> pty_;
  int listener_ = -1, client_ = -1;
};

/// Motor outputs as datagrams.
class MotorSender {
 public:
  MotorSender(const std::string& host, int port) : address_(ipv4(host, port)), on_(port > 0) {
    socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  }
  void send(const link::MotorOutputs& outputs) {
    const link::MotorPacket packet = link::encodeMotors(outputs);
    if (on_) sendto(socket_, packet.data(), packet.size(), 0, reinterpret_cast<sockaddr*>(&address_), sizeof address_);
  }

 private:
  sockaddr_in address_;
  bool on_;
  int socket_;
};

/// What the accelerometer measures, as datagrams; without a port it rests upright.
class ImuReceiver {
 public:
  explicit ImuReceiver(int port) {
    if (port == 0) return;
    const sockaddr_in address = ipv4("127.0.0.1", port);
    socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
      throw common::Error("cannot listen for the IMU on port " + std::to_string(port) + ": " + std::strerror(errno));
  }
  void takeIn(standin::StandinController& fc) {
    std::array<std::uint8_t, 2 * link::IMU_PACKET_SIZE> bytes;
    std::array<double, 3> force;
    for (ssize_t got = 0; socket_ >= 0 && (got = recv(socket_, bytes.data(), bytes.size(), 0)) > 0;) {
      if (link::decodeImu(bytes.data(), static_cast<std::size_t>(got), force)) fc.feel(force);
    }
  }

 private:
  int socket_ = -1;
};

/// Writes a line of JSON whenever armed, failsafe, the arming flags or the motors change.
class EventLog {
 public:
  explicit EventLog(const std::string& path) : file_(path.empty() ? nullptr : std::fopen(path.c_str(), "w")) {
    if (!path.empty() && file_ == nullptr) throw common::FileError(path, "cannot write");
  }
  void note(const standin::StandinController& fc, double now) {
    const bool same = fc.armed() == armed_ && fc.failsafe() == failsafe_ && fc.armingFlags() == flags_;
    if (same && fc.motorMicroseconds() == motor_) return;
    if (!same) {
      std::printf("armed %d failsafe %d flags 0x%x\n", fc.armed() ? 1 : 0, fc.failsafe() ? 1 : 0, fc.armingFlags());
      std::fflush(stdout);
    }
    armed_ = fc.armed();
    failsafe_ = fc.failsafe();
    flags_ = fc.armingFlags();
    motor_ = fc.motorMicroseconds();
    if (file_ == nullptr) return;
    std::fprintf(file_,
                 "{\"t\": %.6f, \"utime\": %lld, \"armed\": %s, \"failsafe\": %s, \"flags\": %u, \"motor\": %d}\n", now,
                 static_cast<long long>(link::wallMicroseconds()), armed_ ? "true" : "false",
                 failsafe_ ? "true" : "false", flags_, motor_);
    std::fflush(file_);
  }

 private:
  std::FILE* file_;
  bool armed_ = false, failsafe_ = false;
  std::uint32_t flags_ = ~0U;
  int motor_ = -1;
};

int run(const Options& o) {
  Port port(o);
  MotorSender motors(o.motor_host, o.motor_port);
  ImuReceiver imu(o.imu_port);
  EventLog log(o.events);
  std::fflush(stdout);
  standin::StandinController fc(o.settings, link::monotonicSeconds());
  standin::StandinPort receiver(o.protocol, fc, link::monotonicSeconds());
  std::array<std::uint8_t, 4096> in;
  std::array<std::uint8_t, 4096> out;
  double next_motor = 0;
  link::takeRealtimePriority(link::STANDIN_PRIORITY);
  while (stop_signal == 0) {
    port.wait(o.period);
    if (port.accept()) receiver.reset();
    const double now = link::monotonicSeconds();
    imu.takeIn(fc);
    while (const std::size_t got = port.read(in.data(), in.size())) receiver.take(in.data(), got, now);
    const std::size_t size = receiver.step(now, out.data(), out.size());
    if (size > 0) port.write(out.data(), size, now);
    log.note(fc, now);
    if (now < next_motor) continue;
    motors.send(fc.motorOutputs());
    next_motor = now + 0.5 * o.period;
  }
  return 0;
}

void addOptions(CLI::App& app, Options& o) {
  app.add_option("--listen", o.listen, "TCP address and port for MSP; port 0 = any, printed")->capture_default_str();
  app.add_option("--pty", o.pty, "serve a pseudo-terminal instead; its far end is linked here");
  app.add_option("--protocol", o.protocol, "msp, sbus or crsf")
      ->check(CLI::IsMember({"msp", "sbus", "crsf"}))
      ->capture_default_str();
  app.add_option("--motor-host", o.motor_host, "where motor outputs go")->capture_default_str();
  app.add_option("--motor-port", o.motor_port, "UDP port, 0 = none")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  app.add_option("--imu-port", o.imu_port, "UDP port on the loopback for what the accelerometer measures, 0 = none")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  app.add_option("--events", o.events, "file for a line of JSON at each change");
  app.add_option("--boot-grace", o.settings.boot_grace, "no arming for this long after the start [s]")
      ->check(CLI::Range(0.0, 60.0))
      ->capture_default_str();
  app.add_option("--failsafe-delay", o.settings.failsafe.delay, "stage 2 of the failsafe [s]")
      ->check(CLI::Range(0.1, 20.0))
      ->capture_default_str();
  app.add_option("--failsafe-procedure", o.settings.failsafe.procedure, "shown to who asks; 1 = motors off")
      ->capture_default_str();
  app.add_option("--api-minor", o.settings.api.minor, "minor number of the interface shown")->capture_default_str();
  app.add_option("--variant", o.variant, "behaves as this firmware")->check(CLI::IsMember({"BTFL", "INAV"}));
  app.add_option("--wrong", o.wrong, "make this setting wrong; may be given more than once")
      ->check(CLI::IsMember(standin::wrongConfigurations()));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Stand-in flight controller with the measured timing of Betaflight 4.5"};
  Options o;
  addOptions(app, o);
  signal(SIGINT, onStop);
  signal(SIGTERM, onStop);
  signal(SIGPIPE, SIG_IGN);
  try {
    app.parse(ownArguments(argc, argv));
    if (o.variant == "INAV") o.settings.becomeInav();
    for (const std::string& name : o.wrong) standin::setWrongly(name, o.settings);
    o.settings.failsafe_delay = o.settings.failsafe.delay;
    return run(o);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "standin_flight_controller: %s\n", error.what());
    return 2;
  }
}
