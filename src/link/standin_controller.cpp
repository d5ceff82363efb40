#include "snapwing/link/standin_controller.h"

#include <algorithm>

namespace snapwing::link {
namespace {

constexpr std::size_t FLIGHT_CHANNELS = 4;
constexpr int LOST_CHANNEL = 885;  ///< [us] shown for a channel that is lost
constexpr double NEVER = 1e18;     ///< [s]
/// The full output read back is one below 2000, and all outputs are whole microseconds rounded down.
constexpr double FULL_OUTPUT = 1999.99;

bool valid(int microseconds) { return microseconds >= CHANNEL_MIN_VALID && microseconds <= CHANNEL_MAX_VALID; }

}  // namespace

StandinController::StandinController(const StandinSettings& settings, double now)
    : settings_(settings), boot_time_(now), motor_(settings.motor_off) {
  values_.count = MAX_CHANNELS;
  values_.us.fill(CHANNEL_LOW);
  values_.us[ROLL] = values_.us[PITCH] = values_.us[YAW] = CHANNEL_CENTRE;
  values_.us[THROTTLE] = LOST_CHANNEL;
  valid_time_.fill(-1e9);
  computer_.us.fill(LOST_CHANNEL);  // what the firmware shows before the first frame
  computer_time_.fill(now);
  step(now);
}

bool StandinController::flightChannelsValid(double now) const {
  return std::all_of(valid_time_.begin(), valid_time_.begin() + FLIGHT_CHANNELS,
                     [&](double time) { return now - time <= settings_.channel_hold; });
}

void StandinController::onFrame(const Channels& channels, double now) {
  ++frames_;
  if (settings_.override_mask == 0) return receive(channels, now);
  const std::size_t count = static_cast<std::size_t>(std::clamp(channels.count, 0, MAX_CHANNELS));
  std::copy_n(channels.us.begin(), count, computer_.us.begin());
  std::fill_n(computer_time_.begin(), count, now);
  step(now);
}

/// The computer's values are looked at when a frame of the pilot's comes, and never keep the receiver's signal alive.
void StandinController::onPilotFrame(const Channels& channels, double now) {
  Channels merged = channels;
  override_active_ = channels.us[static_cast<std::size_t>(settings_.override_channel)] >= settings_.arm_threshold;
  for (std::size_t i = 0; override_active_ && i < static_cast<std::size_t>(channels.count); ++i) {
    const bool fresh = now - computer_time_[i] <= settings_.override_hold;
    if ((settings_.override_mask >> i & 1U) != 0 && fresh) merged.us[i] = computer_.us[i];
  }
  receive(merged, now);
}

void StandinController::receive(const Channels& channels, double now) {
  step(now);
  const std::size_t count = static_cast<std::size_t>(std::clamp(channels.count, 0, MAX_CHANNELS));
  for (std::size_t i = 0; i < count; ++i) {
    if (!valid(channels.us[i])) continue;
    values_.us[i] = channels.us[i];
    valid_time_[i] = now;
  }
  if (!any_frame_ && values_.us[AUX1] >= settings_.arm_threshold) not_disarmed_ = true;
  any_frame_ = true;
  if (now - last_frame_ > settings_.throttle_hold) thrust_return_ = now + settings_.thrust_return;
  last_frame_ = now;
  if (!flightChannelsValid(now)) {
    good_since_ = NEVER;  // a lost channel shows as lost signal with the frame that finds it so
    return;
  }
  if (good_since_ == NEVER || now - last_good_ > settings_.rxloss_after) good_since_ = now;
  last_good_ = now;
  step(now);
}

std::uint32_t StandinController::computeFlags(double now) const {
  std::uint32_t flags = 0;
  if (now - last_good_ > settings_.rxloss_after || now - good_since_ < settings_.rxloss_clear) flags |= FLAG_RXLOSS;
  if (failsafe_) flags |= FLAG_FAILSAFE;
  if (not_disarmed_) flags |= FLAG_NOT_DISARMED;
  if (!armed_ && throttleInForce(now) >= settings_.min_check) flags |= FLAG_THROTTLE;
  if (now - boot_time_ < settings_.boot_grace) flags |= FLAG_BOOTGRACE;
  if (arm_switch_latched_) flags |= FLAG_ARMSWITCH;
  return flags;
}

void StandinController::updateFailsafe(double now) {
  if (armed_ && now - last_good_ >= settings_.failsafe_delay) {
    armed_ = false;
    failsafe_ = true;
    arm_at_ = -1;
  }
  const bool streaming = now - last_good_ <= settings_.rxloss_after && now - good_since_ >= settings_.failsafe_recovery;
  if (failsafe_ && streaming && !switch_on_) failsafe_ = false;
}

void StandinController::updateArming(double now) {
  const bool was_on = switch_on_;
  switch_on_ = any_frame_ && values_.us[AUX1] >= settings_.arm_threshold;
  if (!switch_on_) {
    armed_ = false;
    not_disarmed_ = false;
    arm_switch_latched_ = false;
    arm_at_ = -1;
    return;
  }
  if (armed_ || failsafe_) return;  // failsafe itself lasts until the switch is off
  const std::uint32_t flags = computeFlags(now);
  if (flags != 0) {
    arm_switch_latched_ = true;
    arm_at_ = -1;
  } else if (!was_on) {
    arm_at_ = now + settings_.arm_delay;
  } else if (arm_at_ >= 0 && now >= arm_at_) {
    armed_ = true;
    arm_at_ = -1;
  }
}

int StandinController::throttleInForce(double now) const {
  const bool lost = now - last_frame_ > settings_.throttle_hold || now < thrust_return_ ||
                    now - valid_time_[THROTTLE] > settings_.channel_hold;
  return lost ? LOST_CHANNEL : values_.us[THROTTLE];
}

int StandinController::motorFor(int throttle) const {
  if (throttle <= settings_.min_check) return settings_.motor_idle;
  // The firmware scales the stick to whole thousandths above min_check first.
  const int share =
      (std::min(throttle, CHANNEL_HIGH) - settings_.min_check) * 1000 / (CHANNEL_HIGH - settings_.min_check);
  return static_cast<int>(settings_.motor_idle + (FULL_OUTPUT - settings_.motor_idle) * share / 1000.0);
}

void StandinController::step(double now) {
  updateFailsafe(now);
  updateArming(now);
  flags_ = computeFlags(now);
  motor_ = armed_ ? motorFor(throttleInForce(now)) : settings_.motor_off;
}

MotorOutputs StandinController::motorOutputs() const {
  MotorOutputs outputs{};
  outputs.fill(std::clamp((motor_ - 1000) / 1000.0, 0.0, 1.0));
  return outputs;
}

Channels StandinController::seenChannels(double now) const {
  Channels seen = values_;
  if (now - last_good_ > settings_.channel_hold) {
    seen.us[ROLL] = seen.us[PITCH] = seen.us[YAW] = CHANNEL_CENTRE;
    seen.us[THROTTLE] = LOST_CHANNEL;
  }
  for (std::size_t i = 0; i < FLIGHT_CHANNELS; ++i) {
    if (now - valid_time_[i] > settings_.channel_hold && now - last_frame_ <= settings_.channel_hold) {
      seen.us[i] = LOST_CHANNEL;
    }
  }
  std::swap(seen.us[THROTTLE], seen.us[YAW]);
  return seen;
}

}  // namespace snapwing::link
