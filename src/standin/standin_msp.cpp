#include <algorithm>
#include <cmath>

#include "standin_controller.h"

namespace snapwing::standin {
namespace {

/// Order of the mode bits: ARM first as in release 4.5, FAILSAFE somewhere in the middle, so that who reads the modes
/// must look the bit up.
constexpr std::array<std::uint8_t, 7> BOXES = {link::BOX_ARM, 1, 2, link::BOX_FAILSAFE, 13, 36, link::BOX_MSP_OVERRIDE};

constexpr double COUNTS_PER_G = 512.0;
constexpr std::size_t MOST_CHANNELS = 18;     ///< of one MSP_SET_RAW_RC
constexpr std::size_t INAV_STATUS_SIZE = 11;  ///< [bytes]

}  // namespace

StandinMsp::StandinMsp(StandinController& controller, double now)
    : controller_(controller), size_(std::min(ring_.size(), controller.settings().receive_buffer)), next_turn_(now) {}

void StandinMsp::reset() {
  parser_.reset();
  count_ = 0;
}

/// The ring does not know how far it was read when it is written round: a full one is an empty one.
void StandinMsp::receive(const std::uint8_t* bytes, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) {
    ring_[(head_ + count_) % size_] = bytes[i];
    if (++count_ < size_) continue;
    lost_ += static_cast<std::int64_t>(count_);
    count_ = 0;
  }
}

/// @return true if the ring held a whole command, which the parser then has
bool StandinMsp::nextCommand() {
  while (count_ > 0) {
    const std::uint8_t byte = ring_[head_];
    head_ = (head_ + 1) % size_;
    --count_;
    if (parser_.push(byte) && parser_.packet().direction == '<') return true;
  }
  return false;
}

std::size_t StandinMsp::step(double now, std::uint8_t* out, std::size_t capacity) {
  std::size_t written = 0;
  const double period = 1.0 / controller_->settings().msp_rate;
  while (next_turn_ <= now) {
    if (nextCommand()) {
      link::MspPacket reply;
      serve(parser_.packet(), next_turn_, reply);
      ++served_;
      written += link::encodeMsp(reply, out + written, capacity - written);
    }
    next_turn_ += period;
    if (count_ == 0 && next_turn_ < now) next_turn_ = now - std::fmod(now - next_turn_, period) + period;
  }
  controller_->step(now);
  return written;
}

/// Answers that tell how the controller is set. @return false if `reply` is about something else
bool StandinMsp::serveSetting(link::MspPacket& reply) const {
  const StandinSettings& settings = controller_->settings();
  switch (reply.id) {
    case link::MSP_API_VERSION:
      link::encode(settings.api, reply);
      return true;
    case link::MSP_FC_VARIANT:
      std::copy(settings.variant.begin(), settings.variant.end(), reply.payload.begin());
      reply.size = settings.variant.size();
      return true;
    case link::MSP_RX_MAP:
      link::encode(settings.rx_map, reply);
      return true;
    case link::MSP_FAILSAFE_CONFIG:
      link::encode(settings.failsafe, reply);
      return true;
    case link::MSP_RXFAIL_CONFIG:
      link::encode(settings.rxfail, reply);
      return true;
    case link::MSP_MODE_RANGES:
      link::encode(settings.mode_ranges, reply);
      return true;
    case link::MSP_FEATURE_CONFIG:
      link::encode(link::FeatureConfig{settings.features}, reply);
      return true;
    case link::MSP_RX_CONFIG:
      link::encode(settings.rx_config, reply);
      return true;
    case link::MSP_RC_TUNING:
      link::encode(settings.throttle_limit, reply);
      return true;
    case link::MSP_PID_ADVANCED:
      link::encode(link::MotorOutputLimit{settings.motor_output_limit}, reply);
      return true;
    default:
      return false;
  }
}

void StandinMsp::serveImu(link::MspPacket& reply) const {
  if (!controller_->settings().accelerometer) {
    reply.direction = '!';
    return;
  }
  link::RawImu raw;
  for (std::size_t i = 0; i < 3; ++i) {
    const double counts = controller_->specificForce()[i] / link::STANDARD_GRAVITY * COUNTS_PER_G;
    raw.acceleration[i] = static_cast<int>(std::lround(std::clamp(counts, -32768.0, 32767.0)));
  }
  link::encode(raw, reply);
}

void StandinMsp::serve(const link::MspPacket& packet, double now, link::MspPacket& reply) {
  reply = link::request(packet.version, packet.id);
  reply.direction = '>';
  if (serveSetting(reply)) return;
  const StandinSettings& settings = controller_->settings();
  switch (packet.id) {
    case link::MSP_BOXIDS:
      // A firmware without override has no box for it.
      reply.size = settings.override_mask != 0 ? BOXES.size() : BOXES.size() - 1;
      std::copy_n(BOXES.begin(), reply.size, reply.payload.begin());
      break;
    case link::MSP_STATUS: {
      link::StatusReply status;
      status.cycle_time = 125;
      status.modes = (controller_->armed() ? 1U << 0 : 0U) | (controller_->failsafe() ? 1U << 3 : 0U) |
                     (controller_->overrideActive() ? 1U << 6 : 0U);
      status.arming_flags = controller_->armingFlags();
      status.arming_flag_count = ARMING_FLAG_COUNT;
      link::encode(status, reply);
      if (settings.variant[0] == 'I') reply.size = INAV_STATUS_SIZE;
      break;
    }
    case link::MSP_RAW_IMU:
      serveImu(reply);
      break;
    case link::MSP_MOTOR: {
      link::Channels motors;
      motors.count = 8;
      std::fill_n(motors.us.begin(), link::MOTOR_COUNT, static_cast<std::uint16_t>(controller_->motorMicroseconds()));
      link::encode(motors, reply);
      break;
    }
    case link::MSP_RC:
      link::encode(controller_->seenChannels(now), reply);
      break;
    case link::MSP_SET_RAW_RC: {
      link::Channels channels;
      if (packet.size > 2 * MOST_CHANNELS) {
        reply.direction = '!';
      } else if (link::decode(packet, channels)) {
        controller_->onFrame(channels, now);
      }
      break;
    }
    default:
      reply.direction = '!';
  }
}

}  // namespace snapwing::standin
