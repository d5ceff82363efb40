#include "link/loop_simulation.h"

#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace snapwing::link::test {

void PipeTransport::maintain(double now) {
  if (connected_ || !plugged || now < next_attempt_) return;
  next_attempt_ = now + 0.25;
  unplug();
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends) != 0) return;
  descriptor_ = ends[0];
  far_ = ends[1];
  opened(true);
}

long PipeTransport::send(const std::uint8_t* bytes, std::size_t size) {
  return Transport::send(bytes, takes > 0 ? std::min(takes, size) : size);
}

int PipeTransport::backlog() const { return hides_backlog ? 0 : waiting(); }

int PipeTransport::waiting() const {
  int bytes = 0;
  return far_ >= 0 && ioctl(far_, FIONREAD, &bytes) == 0 ? bytes : 0;
}

bool PipeTransport::flush() {
  if (keeps_all) return true;
  std::uint8_t bytes[256];
  while (farRead(bytes, sizeof bytes) > 0) {
  }
  return true;
}

std::size_t PipeTransport::farRead(std::uint8_t* out, std::size_t capacity) {
  const ssize_t got = far_ >= 0 ? ::read(far_, out, capacity) : -1;
  return got > 0 ? static_cast<std::size_t>(got) : 0;
}

void PipeTransport::farWrite(const std::uint8_t* bytes, std::size_t size) {
  if (far_ >= 0 && ::send(far_, bytes, size, MSG_NOSIGNAL) < 0) return;
}

void PipeTransport::unplug() {
  if (far_ >= 0) ::close(far_);
  far_ = -1;
  close();
}

Simulation::Simulation(const standin::StandinSettings& standin, const BridgeSettings& settings,
                       const std::set<std::string>& allowed)
    : fc(standin, now), port(fc, now), bridge_settings_(settings), allowed_(allowed) {
  restartBridge();
}

standin::StandinSettings Simulation::quickStandin() {
  standin::StandinSettings settings;
  settings.boot_grace = 0.6;
  return settings;
}

void Simulation::restartBridge() {
  line.unplug();
  bridge = std::make_unique<BridgeLoop>(bridge_settings_, Protocol::MSP2, true, allowed_, line, ++session_, now);
  bridge_runs = true;
  pulse_id = 0;
}

Stamp Simulation::stamp() {
  const BridgeStatus& heard = bridge->core().status();
  return {1, session_, ++number_, heard.frame_time, 0.1, heard.number, now - heard.frame_time};
}

void Simulation::step() {
  now += 0.001;
  if (operator_runs && now >= next_beat_) {
    next_beat_ = now + 0.02;
    Inbound beat;
    beat.kind = Inbound::Kind::HEARTBEAT;
    beat.heartbeat = {stamp(), arm_switch, deadman, reset};
    if (bridge_runs) bridge->inbox().push(beat);
  }
  if (bridge_runs) {
    bridge->takeIn(now);
    if (now >= bridge->nextFrameTime(now)) bridge->frame(now);
    Outbound gone;
    while (bridge->outbox().pop(gone)) {
    }
  }
  if (pilot && now >= next_pilot_) {
    next_pilot_ = now + 0.009;
    fc.onPilotFrame(*pilot, now);
  }
  std::uint8_t bytes[1024];
  while (line_open) {
    const std::size_t got = line.farRead(bytes, sizeof bytes);
    if (got == 0) break;
    port.receive(bytes, got);
  }
  const std::size_t size = port.step(now, bytes, sizeof bytes);
  if (size > 0 && line_open) line.farWrite(bytes, size);
  highest_motor = std::max(highest_motor, fc.motorMicroseconds());
}

void Simulation::run(double seconds, const std::function<void()>& each) {
  for (const double end = now + seconds; now < end - 1e-9;) {
    step();
    if (each) each();
  }
}

bool Simulation::runUntil(double limit, const std::function<bool()>& done) {
  for (const double end = now + limit; now < end;) {
    step();
    if (done()) return true;
  }
  return false;
}

void Simulation::arm() {
  arm_switch = false;
  ASSERT_TRUE(runUntil(10.0, [&] { return bridge->core().status().controller.known && fc.armingFlags() == 0; }));
  run(0.2);
  arm_switch = true;
  ASSERT_TRUE(runUntil(1.0, [&] { return fc.armed() && bridge->core().status().controller.armed; }));
  run(0.1);
}

void Simulation::command(double throttle, double duration, std::optional<double> pitch) {
  command({throttle, duration, 0.0, 0.0, pitch.value_or(0.0), pitch.has_value()});
}

void Simulation::command(const PulseShape& shape) {
  Inbound item;
  item.kind = Inbound::Kind::PULSE;
  item.pulse = {shape, stamp(), ++pulse_id};
  bridge->inbox().push(item);
}

Refusal Simulation::pulse(double throttle, double duration) {
  const std::int64_t refused = bridge->core().status().commands_refused;
  command(throttle, duration);
  run(0.021);
  return bridge->core().status().commands_refused > refused ? bridge->core().status().last_refusal : Refusal::NONE;
}

}  // namespace snapwing::link::test
