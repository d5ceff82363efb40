#include "snapwing/link/channels.h"

#include <algorithm>
#include <cmath>

namespace snapwing::link {

Channels safeChannels() {
  Channels channels;
  channels.count = FRAME_CHANNELS;
  channels.us.fill(CHANNEL_LOW);
  channels.us[ROLL] = CHANNEL_CENTRE;
  channels.us[PITCH] = CHANNEL_CENTRE;
  channels.us[YAW] = CHANNEL_CENTRE;
  return channels;
}

std::uint16_t travelToMicroseconds(double travel, const common::ThrottleScale& scale) {
  if (!std::isfinite(travel)) return CHANNEL_LOW;
  const double microseconds = common::throttleMicroseconds(scale, std::clamp(travel, 0.0, 1.0));
  return static_cast<std::uint16_t>(std::lround(microseconds));
}

std::uint16_t stickToMicroseconds(double stick) {
  if (!std::isfinite(stick)) return CHANNEL_CENTRE;
  return static_cast<std::uint16_t>(CHANNEL_CENTRE + std::lround(500.0 * std::clamp(stick, -1.0, 1.0)));
}

}  // namespace snapwing::link
