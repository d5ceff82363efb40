#include "guardian.h"

#include <algorithm>
#include <cmath>

namespace snapwing::link {

GuardianSettings GuardianSettings::forPeriod(double frame_period) {
  GuardianSettings settings;
  settings.still_limit = std::max(settings.still_limit, static_cast<int>(std::ceil((frame_period + 0.04) / 0.005)));
  settings.wakings_per_frame = std::max(2, static_cast<int>(std::lround(frame_period / settings.waking)));
  return settings;
}

GuardianAction GuardianCore::step(const GuardianSeen& seen) {
  switch (state_) {
    case State::WATCHING:
      return watch(seen);
    case State::KILLING:
      if (seen.waking) ++waited_;
      return seen.bridge_ended || waited_ >= settings_.kill_patience ? takeOver(seen) : GuardianAction::NONE;
    case State::SENDING:
      return send(seen);
    default:
      return GuardianAction::FINISHED;
  }
}

GuardianAction GuardianCore::watch(const GuardianSeen& seen) {
  if (seen.bridge_ended && seen.orderly_end) {
    state_ = State::FINISHED;
    return GuardianAction::FINISHED;
  }
  if (seen.bridge_ended) {
    reason_ = GuardianReason::BRIDGE_DIED;
    return takeOver(seen);
  }
  if (!seen.active || seen.beat != beat_) {
    beat_ = seen.beat;
    still_ = 0;
    return GuardianAction::NONE;
  }
  if (!seen.waking || ++still_ < settings_.still_limit) return GuardianAction::NONE;
  reason_ = GuardianReason::BRIDGE_STOOD_STILL;
  state_ = State::KILLING;
  return GuardianAction::KILL;
}

GuardianAction GuardianCore::takeOver(const GuardianSeen& seen) {
  state_ = seen.line_open ? State::SENDING : State::FINISHED;
  return seen.line_open ? GuardianAction::CLEAR_AND_SEND : GuardianAction::FINISHED;
}

GuardianAction GuardianCore::send(const GuardianSeen& seen) {
  if (seen.waking) ++wakings_;
  const bool enough = wakings_ >= settings_.least_wakings && frames_ >= settings_.least_frames && seen.backlog == 0;
  if (!seen.line_open || enough) {
    state_ = State::FINISHED;
    return GuardianAction::FINISHED;
  }
  if (!seen.waking) return GuardianAction::NONE;
  if (++untaken_ >= settings_.blocked_limit) {
    untaken_ = 0;
    return GuardianAction::CLEAR_AND_SEND;
  }
  return wakings_ % settings_.wakings_per_frame == 0 ? GuardianAction::SEND : GuardianAction::NONE;
}

void GuardianCore::onSent(bool taken) {
  if (!taken) return;
  ++frames_;
  untaken_ = 0;
}

}  // namespace snapwing::link
