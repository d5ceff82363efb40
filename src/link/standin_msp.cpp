#include <algorithm>
#include <cmath>

#include "snapwing/link/standin_controller.h"

namespace snapwing::link {
namespace {

/// Order of the mode bits: ARM first as in release 4.5, FAILSAFE somewhere in the middle, so that who reads the modes
/// must look the bit up.
constexpr std::array<std::uint8_t, 7> BOXES = {BOX_ARM, 1, 2, BOX_FAILSAFE, 13, 36, BOX_MSP_OVERRIDE};

constexpr std::size_t MOST_CHANNELS = 18;  ///< of one MSP_SET_RAW_RC

}  // namespace

StandinMsp::StandinMsp(StandinController& controller, double now) : controller_(controller), next_turn_(now) {}

void StandinMsp::reset() {
  parser_.reset();
  count_ = 0;
}

void StandinMsp::receive(const std::uint8_t* bytes, std::size_t size) {
  const std::size_t room = std::min<std::size_t>(QUEUE, static_cast<std::size_t>(controller_.settings().msp_backlog));
  for (std::size_t i = 0; i < size; ++i) {
    if (!parser_.push(bytes[i]) || parser_.packet().direction != '<') continue;
    if (count_ >= room) {
      ++lost_;
      continue;
    }
    queue_[(head_ + count_++) % QUEUE] = parser_.packet();
  }
}

std::size_t StandinMsp::step(double now, std::uint8_t* out, std::size_t capacity) {
  std::size_t written = 0;
  const double period = 1.0 / controller_.settings().msp_rate;
  while (next_turn_ <= now) {
    if (count_ > 0) {
      const MspPacket& packet = queue_[head_];
      MspPacket reply;
      serve(packet, next_turn_, reply);
      head_ = (head_ + 1) % QUEUE;
      --count_;
      ++served_;
      written += encodeMsp(reply, out + written, capacity - written);
    }
    next_turn_ += period;
    if (count_ == 0 && next_turn_ < now) next_turn_ = now - std::fmod(now - next_turn_, period) + period;
  }
  controller_.step(now);
  return written;
}

void StandinMsp::serve(const MspPacket& packet, double now, MspPacket& reply) {
  reply = request(packet.version, packet.id);
  reply.direction = '>';
  const StandinSettings& settings = controller_.settings();
  switch (packet.id) {
    case MSP_API_VERSION:
      encode(settings.api, reply);
      break;
    case MSP_FC_VARIANT:
      std::copy(settings.variant.begin(), settings.variant.end(), reply.payload.begin());
      reply.size = settings.variant.size();
      break;
    case MSP_RX_MAP:
      encode(settings.rx_map, reply);
      break;
    case MSP_FAILSAFE_CONFIG:
      encode(settings.failsafe, reply);
      break;
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
