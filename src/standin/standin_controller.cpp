#include "standin_controller.h"

#include <algorithm>
#include <cmath>

namespace snapwing::standin {
namespace {

constexpr std::size_t FLIGHT_CHANNELS = 4;
constexpr int LOST_CHANNEL = 885;  ///< [us] shown for a channel that is lost
constexpr double NEVER = 1e18;     ///< [s]
/// The full output read back is one below 2000, and all outputs are whole microseconds rounded down.
constexpr double FULL_OUTPUT = 1999.99;

constexpr double INAV_HOLD = 0.9;  ///< [s]

bool valid(int microseconds) {
  return microseconds >= link::CHANNEL_MIN_VALID && microseconds <= link::CHANNEL_MAX_VALID;
}

/// Seconds between two moments to the microsecond: a limit is met in the look that is due, whatever the doubles' last
/// digits.
double elapsed(double since, double now) { return std::round((now - since) * 1e6) / 1e6; }

}  // namespace

void StandinSettings::becomeInav() {
  variant = {'I', 'N', 'A', 'V'};
  api = {0, 2, 5};
  rx_map.count = 4;
  throttle_hold = INAV_HOLD;
}

StandinController::StandinController(const StandinSettings& settings, double now)
    : settings_(settings), boot_time_(now), next_look_(now + settings.look_period), motor_(settings.motor_off) {
  values_.count = link::MAX_CHANNELS;
  values_.us.fill(link::CHANNEL_LOW);
  values_.us[link::ROLL] = values_.us[link::PITCH] = values_.us[link::YAW] = link::CHANNEL_CENTRE;
  values_.us[link::THROTTLE] = LOST_CHANNEL;
  valid_time_.fill(-1e9);
  computer_.us.fill(LOST_CHANNEL);  // what the firmware shows before the first frame
  computer_time_.fill(now);
  step(now);
}

bool StandinController::flightChannelsValid(double now) const {
  return std::all_of(valid_time_.begin(), valid_time_.begin() + FLIGHT_CHANNELS,
                     [&](double time) { return elapsed(time, now) <= settings_.channel_hold; });
}

void StandinController::onFrame(const link::Channels& channels, double now) {
  ++frames_;
  if (settings_.override_mask == 0) return receive(channels, now);
  const std::size_t count = static_cast<std::size_t>(std::clamp(channels.count, 0, link::MAX_CHANNELS));
  std::copy_n(channels.us.begin(), count, computer_.us.begin());
  std::fill_n(computer_time_.begin(), count, now);
  step(now);
}

/// The computer's values are looked at when a frame of the pilot's comes, and never keep the receiver's signal alive.
void StandinController::onPilotFrame(const link::Channels& channels, double now) {
  link::Channels merged = channels;
  override_active_ = channels.us[static_cast<std::size_t>(settings_.override_channel)] >= settings_.arm_threshold;
  for (std::size_t i = 0; override_active_ && i < static_cast<std::size_t>(channels.count); ++i) {
    const bool fresh = elapsed(computer_time_[i], now) <= settings_.override_hold;
    if ((settings_.override_mask >> i & 1U) != 0 && fresh) merged.us[i] = computer_.us[i];
  }
  receive(merged, now);
}

/// How long this frame's throttle will hold if no other follows. Multiples of the golden ratio, one more with each
/// frame, stand for the chance in which look finds it too old: they spread evenly over any number of frames.
void StandinController::drawHold() {
  draw_ += 2654435769U;  // 2^32 times 0.618...
  const double chance = draw_ / 4294967296.0, early = settings_.early_look_share;
  hold_ = chance < early ? settings_.throttle_hold + settings_.look_period + settings_.early_look_late * chance / early
                         : settings_.throttle_hold + settings_.look_late * (chance - early) / (1.0 - early);
}

void StandinController::receive(const link::Channels& channels, double now) {
  step(now);
  const std::size_t count = static_cast<std::size_t>(std::clamp(channels.count, 0, link::MAX_CHANNELS));
  for (std::size_t i = 0; i < count; ++i) {
    if (!valid(channels.us[i])) continue;
    values_.us[i] = channels.us[i];
    valid_time_[i] = now;
  }
  if (!any_frame_ && values_.us[link::AUX1] >= settings_.arm_threshold) not_disarmed_ = true;
  any_frame_ = true;
  last_frame_ = now;
  drawHold();
  channels_lost_ = !flightChannelsValid(now);
  if (channels_lost_) {
    good_since_ = NEVER;  // a lost channel shows as lost signal with the frame that finds it so
  } else {
    if (good_since_ == NEVER || elapsed(last_good_, now) > settings_.rxloss_after) good_since_ = now;
    last_good_ = now;
  }
  turn(now, true);
  next_look_ = now + settings_.look_period;
  step(now);
}

std::uint32_t StandinController::computeFlags(double now) const {
  std::uint32_t flags = 0;
  if (elapsed(last_good_, now) > settings_.rxloss_after || elapsed(good_since_, now) < settings_.rxloss_clear)
    flags |= FLAG_RXLOSS;
  if (failsafe_) flags |= FLAG_FAILSAFE;
  if (not_disarmed_) flags |= FLAG_NOT_DISARMED;
  if (!armed_ && throttleInForce(now) >= settings_.min_check) flags |= FLAG_THROTTLE;
  if (elapsed(boot_time_, now) < settings_.boot_grace) flags |= FLAG_BOOTGRACE;
  if (arm_switch_latched_) flags |= FLAG_ARMSWITCH;
  return flags;
}

void StandinController::updateFailsafe(double now) {
  if (armed_ && elapsed(last_good_, now) >= settings_.failsafe_delay) {
    armed_ = false;
    failsafe_ = true;
  }
  const bool streaming =
      elapsed(last_good_, now) <= settings_.rxloss_after && elapsed(good_since_, now) >= settings_.failsafe_recovery;
  if (failsafe_ && streaming) failsafe_ = false;
}

/// One turn of the receiver's task: with each frame, and each tenth of a second without. What the turn before saw of
/// the arm switch is acted on now.
void StandinController::turn(double now, bool frame) {
  const bool on = switch_seen_;
  switch_seen_ = any_frame_ && values_.us[link::AUX1] >= settings_.arm_threshold;
  if (on) {
    disarm_turns_ = 0;
    tryToArm(now, frame);
    return;
  }
  if (!switch_seen_) not_disarmed_ = arm_switch_latched_ = false;
  if (armed_ && ++disarm_turns_ >= settings_.disarm_turns) armed_ = false;
}

void StandinController::tryToArm(double now, bool frame) {
  if (armed_) return;
  if (failsafe_) {  // the switch that stayed on must be off once, seen as soon as frames come again
    if (frame) not_disarmed_ = arm_switch_latched_ = true;
  } else if (computeFlags(now) != 0) {
    arm_switch_latched_ = true;
  } else {
    armed_ = true;
    disarm_turns_ = 0;
  }
}

int StandinController::lostThrottle() const {
  const link::RxFailChannel& rule = settings_.rxfail.channels[3];  // roll, pitch, yaw, throttle
  if (rule.mode == link::RxFailMode::HOLD) return values_.us[link::THROTTLE];
  return rule.mode == link::RxFailMode::SET ? rule.value : LOST_CHANNEL;
}

int StandinController::throttleInForce(double now) const {
  return signalLost(now) ? lostThrottle() : values_.us[link::THROTTLE];
}

int StandinController::motorFor(int throttle) const {
  if (throttle <= settings_.min_check) return settings_.motor_idle;
  // The firmware scales the stick to whole thousandths above min_check first.
  int share = (std::min(throttle, link::CHANNEL_HIGH) - settings_.min_check) * 1000 /
              (link::CHANNEL_HIGH - settings_.min_check);
  const link::ThrottleLimit& limit = settings_.throttle_limit;
  if (limit.type == link::ThrottleLimitType::SCALE) share = share * limit.percent / 100;
  if (limit.type == link::ThrottleLimitType::CLIP) share = std::min(share, 10 * limit.percent);
  const double range = (FULL_OUTPUT - settings_.motor_idle) * settings_.motor_output_limit / 100.0;
  return static_cast<int>(settings_.motor_idle + range * share / 1000.0);
}

void StandinController::updateMotor(double now) {
  if (!armed_) {
    motor_ = settings_.motor_off;
    ramp_to_ = -1;
    return;
  }
  const double target = motorFor(throttleInForce(now));
  if (ramp_to_ < 0) ramp_begin_ = -1e9;  // just armed: no ramp
  if (target != ramp_to_) {
    if (ramp_to_ >= 0) ramp_begin_ = now;
    ramp_from_ = motor_;
    ramp_to_ = target;
  }
  const double x = std::min(1.0, (now - ramp_begin_) / settings_.ramp);
  motor_ = x < 1.0 ? ramp_from_ + (ramp_to_ - ramp_from_) * x * x * (3.0 - 2.0 * x) : ramp_to_;
}

void StandinController::step(double now) {
  updateFailsafe(now);
  for (; elapsed(next_look_, now) >= 0; next_look_ += settings_.look_period) turn(next_look_, false);
  flags_ = computeFlags(now);
  updateMotor(now);
}

link::MotorOutputs StandinController::motorOutputs() const {
  link::MotorOutputs outputs{};
  outputs.fill(std::clamp((motor_ - 1000) / 1000.0, 0.0, 1.0));
  return outputs;
}

link::Channels StandinController::seenChannels(double now) const {
  link::Channels seen = values_;
  if (signalLost(now)) {
    seen.us[link::ROLL] = seen.us[link::PITCH] = seen.us[link::YAW] = link::CHANNEL_CENTRE;
    seen.us[link::THROTTLE] = static_cast<std::uint16_t>(lostThrottle());
  }
  std::swap(seen.us[link::THROTTLE], seen.us[link::YAW]);
  return seen;
}

}  // namespace snapwing::standin
