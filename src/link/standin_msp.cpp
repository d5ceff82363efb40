#include <algorithm>
#include <cmath>

#include "snapwing/link/standin_controller.h"

namespace snapwing::link {
namespace {

/// Order of the mode bits: ARM first as in release 4.5, FAILSAFE somewhere in the middle, so that who reads the modes
/// must look the bit up.
constexpr std::array<std::uint8_t, 7> BOXES = {BOX_ARM, 1, 2, BOX_FAILSAFE, 13, 36, BOX_MSP_OVERRIDE};

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
  const double period = 1.0 / controller_.settings().msp_rate;
  while (next_turn_ <= now) {
    if (nextCommand()) {
      MspPacket reply;
      serve(parser_.packet(), next_turn_, reply);
      ++served_;
      written += encodeMsp(reply, out + written, capacity - written);
    }
    next_turn_ += period;
    if (count_ == 0 && next_turn_ < now) next_turn_ = now - std::fmod(now - next_turn_, period) + period;
  }
  controller_.step(now);
  return written;
}

/// Answers that tell how the controller is set. @return false if `reply` is about something else
bool StandinMsp::serveSetting(MspPacket& reply) const {
  const StandinSettings& settings = controller_.settings();
  switch (reply.id) {
    case MSP_API_VERSION:
      encode(settings.api, reply);
      return true;
    case MSP_FC_VARIANT:
      std::copy(settings.variant.begin(), settings.variant.end(), reply.payload.begin());
      reply.size = settings.variant.size();
      return true;
    case MSP_RX_MAP:
      encode(settings.rx_map, reply);
      return true;
    case MSP_FAILSAFE_CONFIG:
      encode(settings.failsafe, reply);
      return true;
    case MSP_RXFAIL_CONFIG:
      encode(settings.rxfail, reply);
      return true;
    case MSP_MODE_RANGES:
      encode(settings.mode_ranges, reply);
      return true;
    case MSP_FEATURE_CONFIG:
      encode(FeatureConfig{settings.features}, reply);
      return true;
    case MSP_RX_CONFIG:
      encode(settings.rx_config, reply);
      return true;
    case MSP_RC_TUNING:
      encode(settings.throttle_limit, reply);
      return true;
    case MSP_PID_ADVANCED:
      encode(MotorOutputLimit{settings.motor_output_limit}, reply);
      return true;
    default:
      return false;
  }
}

void StandinMsp::serve(const MspPacket& packet, double now, MspPacket& reply) {
  reply = request(packet.version, packet.id);
  reply.direction = '>';
  if (serveSetting(reply)) return;
  const StandinSettings& settings = controller_.settings();
  switch (packet.id) {
    case MSP_BOXIDS:
      // A firmware without override has no box for it.
      reply.size = settings.override_mask != 0 ? BOXES.size() : BOXES.size() - 1;
      std::copy_n(BOXES.begin(), reply.size, reply.payload.begin());
      break;
    case MSP_STATUS: {
      StatusReply status;
      status.cycle_time = 125;
      status.modes = (controller_.armed() ? 1U << 0 : 0U) | (controller_.failsafe() ? 1U << 3 : 0U) |
                     (controller_.overrideActive() ? 1U << 6 : 0U);
      status.arming_flags = controller_.armingFlags();
      status.arming_flag_count = ARMING_FLAG_COUNT;
      encode(status, reply);
      if (settings.variant[0] == 'I') reply.size = INAV_STATUS_SIZE;
      break;
    }
    case MSP_MOTOR: {
      Channels motors;
      motors.count = 8;
      std::fill_n(motors.us.begin(), MOTOR_COUNT, static_cast<std::uint16_t>(controller_.motorMicroseconds()));
      encode(motors, reply);
      break;
    }
    case MSP_RC:
      encode(controller_.seenChannels(now), reply);
      break;
    case MSP_SET_RAW_RC: {
      Channels channels;
      if (packet.size > 2 * MOST_CHANNELS) {
        reply.direction = '!';
      } else if (decode(packet, channels)) {
        controller_.onFrame(channels, now);
      }
      break;
    }
    default:
      reply.direction = '!';
  }
}

}  // namespace snapwing::link
