#include "bridge_loop.h"

#include <algorithm>
#include <cmath>

#include "snapwing/common/enum_names.h"
#include "snapwing/link/crsf.h"
#include "snapwing/link/sbus.h"

namespace snapwing::link {
namespace {

constexpr double SILENCE_LIMIT = 0.2;  ///< [s] without any answer after which the controller counts as gone
/// Frames that may be on their way unanswered. Not every line tells how much it still holds; a controller or adapter
/// that stands still must not be left with a store of thrust frames. The controller takes 10.4 ms for each, and 20 ms
/// after a gap before thrust returns: one stale frame is followed by a safe one in time.
constexpr int WINDOW = 2;
constexpr int THRUST_WINDOW = 1;  ///< a frame with thrust leaves only when the one before it was answered
/// In a pulse each further frame leaves right behind an answer, to a question asked this long after the last frame [s].
/// A line that stands still swallows the question, and holds no thrust when it is freed. Question and frame take one
/// turn of the controller each, and the next is sent when the last was answered: nothing can pile up there.
constexpr double PROOF_AFTER = 0.015;
constexpr double PROOF_PATIENCE = 0.015;  ///< [s] beyond the frame's time, then the loop goes on without a frame
constexpr double WINDOW_LIMIT = 0.1;      ///< [s] closed for longer: what is on its way is thrown away

bool speaksMsp(Protocol protocol) { return protocol == Protocol::MSP1 || protocol == Protocol::MSP2; }

}  // namespace

MspVersion mspVersion(Protocol protocol) { return protocol == Protocol::MSP1 ? MspVersion::V1 : MspVersion::V2; }

ControllerRules controllerRules(const BridgeSettings& settings, const std::set<std::string>& allowed) {
  ControllerRules rules;
  rules.pilot_override = settings.pilot_override;
  rules.throttle_low = static_cast<int>(std::lround(settings.throttle.low));
  rules.throttle_high = static_cast<int>(std::lround(settings.throttle.high));
  rules.min_check = static_cast<int>(std::lround(settings.throttle.min_check));
  rules.allowed = allowedMask(allowed);
  return rules;
}

Protocol protocolFromName(const std::string& name) {
  static constexpr common::EnumNames<Protocol, 4> NAMES("protocol", {"msp1", "msp2", "sbus", "crsf"});
  return NAMES.value(name);
}

LineSettings lineSettings(Protocol protocol) {
  if (protocol == Protocol::SBUS) return {100000, Parity::EVEN, 2, false};
  if (protocol == Protocol::CRSF) return {420000, Parity::NONE, 1, true};
  return {115200, Parity::NONE, 1, true};
}

BridgeLoop::BridgeLoop(const BridgeSettings& settings, Protocol protocol, bool readback,
                       const std::set<std::string>& allowed, Transport& transport, std::int64_t session, double now)
    : protocol_(protocol),
      readback_(readback && speaksMsp(protocol)),
      transport_(transport),
      core_(settings, session, now),
      watch_(mspVersion(protocol), controllerRules(settings, allowed), settings.imu) {}

WireFrame BridgeLoop::encodeFrame(Protocol protocol, const Channels& channels) {
  if (protocol == Protocol::SBUS) return encodeSbus(channels);
  if (protocol == Protocol::CRSF) return encodeCrsf(channels);
  WireFrame frame;
  frame.size = encodeMsp(setRawRc(mspVersion(protocol), channels), frame.bytes.data(), frame.bytes.size());
  return frame;
}

WireFrame BridgeLoop::safeFrame(Protocol protocol) { return encodeFrame(protocol, safeChannels()); }

void BridgeLoop::publishTo(std::shared_ptr<GuardianRecord> record) {
  record_ = std::move(record);
  transport_->publishOpenBytes({record_, &record_->open_bytes});
}

void BridgeLoop::drainInbox(double now) {
  Inbound message;
  while (inbox_.pop(message)) {
    if (message.kind == Inbound::Kind::PULSE) core_.onPulse(message.pulse, now);
    if (message.kind == Inbound::Kind::HEARTBEAT) core_.onHeartbeat(message.heartbeat, now);
    if (message.kind == Inbound::Kind::ABORT) core_.onAbort(message.abort, now);
  }
}

void BridgeLoop::updateConnection(double now) {
  transport_->maintain(now);
  if (transport_->connected() && transport_->connections() != seen_connections_) {
    seen_connections_ = transport_->connections();
    parser_.reset();
    watch_.connected(now);
  }
  if (!transport_->connected()) watch_.disconnected();
  ControllerState state = watch_.state();
  state.readback = readback_;
  if (!readback_) state.known = state.connected;
  if (readback_ && now - watch_.lastAnswer() > SILENCE_LIMIT) state.connected = false;
  core_.onController(state);
}

bool BridgeLoop::windowOpen(double now) {
  const bool thrust = core_.status().commanded_throttle > 0.0;
  const bool proven = !readback_ || !core_.inPulse() || proof_ > last_frame_;
  if (thrust && !(proven && transport_->empty())) return false;
  const int window = thrust ? THRUST_WINDOW : WINDOW;
  if (!readback_ || watch_.unansweredFrames() < window) {
    window_closed_since_ = -1;
    return true;
  }
  if (window_closed_since_ < 0) window_closed_since_ = now;
  if (now - window_closed_since_ <= WINDOW_LIMIT) return false;
  transport_->discard();
  watch_.forgetFrames();
  window_closed_since_ = -1;
  return transport_->connected();
}

/// An operator's silence is noticed by a frame, which is then low and waits for nothing.
double BridgeLoop::nextFrameTime(double now) const {
  return std::min(dueFrameTime(now), std::max(core_.silentFrom(), core_.earliestFrameTime()));
}

double BridgeLoop::dueFrameTime(double now) const {
  if (readback_ && core_.inPulse() && !core_.urgent()) {
    if (core_.changesSoon(now)) return core_.nextChange(now);
    if (proof_ > last_frame_) return core_.earliestFrameTime();
    return std::min(core_.nextFrameTime() + PROOF_PATIENCE, core_.nextChange(now));
  }
  // A low frame waits for nothing: behind a question it is served as soon as after the question's answer.
  const BridgeState state = core_.status().state;
  const bool low = state == BridgeState::IDLE || state == BridgeState::FAULT;
  const bool free = !readback_ || low || (watch_.unansweredFrames() == 0 && !watch_.asking(now));
  return core_.urgent() && free ? core_.earliestFrameTime() : core_.nextFrameTime();
}

bool BridgeLoop::proofDue(double now) const {
  return readback_ && core_.inPulse() && proof_ <= last_frame_ && !proof_asked_ && watch_.unansweredFrames() == 0 &&
         !watch_.asking(now) && !core_.changesSoon(now);
}

double BridgeLoop::nextWakeTime(double now) const {
  const double next = nextFrameTime(now);
  return proofDue(now) ? std::min(next, std::max(last_frame_ + PROOF_AFTER, now)) : next;
}

void BridgeLoop::takeIn(double now) {
  drainInbox(now);
  receive(now);
  if (!proofDue(now) || now < last_frame_ + PROOF_AFTER) return;
  ask(now, true);
  proof_asked_ = true;
}

void BridgeLoop::frame(double now) {
  receive(now);
  updateConnection(now);
  drainInbox(now);
  const Channels& channels = core_.tick(now);
  const BridgeState state = core_.status().state;
  const bool active = state == BridgeState::ARMED || state == BridgeState::PULSE;
  if (active) record_->active = true;
  const WireFrame wire = encodeFrame(protocol_, channels);
  const bool written =
      transport_->connected() && windowOpen(now) && transport_->write(wire.bytes.data(), wire.size, now);
  core_.onSent(written, now);
  if (written) {
    watch_.noteFrame();
    last_frame_ = now;
    proof_asked_ = false;
  }
  if (written && !active) record_->active = false;
  record_->beat.fetch_add(1);
  outbox_.push({core_.status(), watch_.telemetry()});
}

/// One question with every other frame, once the frame has been answered.
void BridgeLoop::ask(double now, bool always) {
  MspPacket question;
  if (!readback_ || !watch_.nextRequest(now, question, always)) return;
  std::array<std::uint8_t, 16> bytes;
  const std::size_t size = encodeMsp(question, bytes.data(), bytes.size());
  transport_->write(bytes.data(), size, now);
}

void BridgeLoop::receive(double now) {
  transport_->finish();
  std::array<std::uint8_t, 512> bytes;
  while (const std::size_t got = transport_->read(bytes.data(), bytes.size())) {
    for (std::size_t i = 0; i < got; ++i) {
      if (!parser_.push(bytes[i])) continue;
      watch_.onPacket(parser_.packet(), now);
      const bool frame = parser_.packet().id == MSP_SET_RAW_RC;
      if (frame && !core_.urgent() && core_.status().state != BridgeState::PULSE) ask(now);
      if (!frame && proof_asked_) {
        proof_ = now;
        proof_asked_ = false;
      }
    }
    if (got < bytes.size()) break;
  }
}

}  // namespace snapwing::link
