#include "snapwing/planning/switch_protocol.h"

#include <algorithm>
#include <cstdio>

#include "snapwing/common/require.h"

namespace snapwing::planning {

namespace {

using Bridge = SwitchView::Bridge;
using Event = SwitchEvent;
using Outcome = SwitchOutcome;
using State = SwitchState;

const common::Require require("switch protocol");

/// Why the link cannot carry a pulse now, one entry for each reason.
std::vector<std::string> linkTroubles(const SwitchSettings& settings, const SwitchView& view) {
  // Nothing that an old status says is true any more.
  if (!(view.link_age <= settings.fresh))
    return {"the link status " + view.link_trouble + ": is the radio bridge running?"};
  std::vector<std::string> troubles;
  if (view.bridge == Bridge::FAULT) troubles.push_back("the radio bridge latched a fault: " + view.bridge_fault);
  if (!view.controller_connected) {
    troubles.push_back("the flight controller does not answer: no vehicle is connected");
    return troubles;
  }
  if (view.controller_failsafe) troubles.push_back("the flight controller is in failsafe");
  if (!view.controller_armed) troubles.push_back("the flight controller is not armed");
  return troubles;
}

/// The estimated mode, as far as fresh readings show it.
vehicle::Mode seenMode(const SwitchSettings& settings, const SwitchView& view) {
  const bool seen = view.mode_age <= settings.fresh && view.reading_age <= settings.fresh;
  return seen ? view.mode : vehicle::Mode::UNKNOWN;
}

}  // namespace

void SwitchSettings::validate() const {
  require.within("fresh", fresh, 0.05, 5.0);
  require.within("accept_timeout", accept_timeout, 0.3, 5.0);
  require.within("settle_timeout", settle_timeout, 0.1, 30.0);
  require.within("settle_hold", settle_hold, 0.0, 5.0);
  require.within("attempts", attempts, 1, 5);
  require.within("command_life", command_life, 0.01, accept_timeout);
}

const std::vector<SwitchRow>& SwitchProtocol::table() {
  static const std::vector<SwitchRow> table = {
      {State::READY, Event::STOP_ASKED, State::DONE, Outcome::PREEMPTED},
      {State::READY, Event::SOMETHING_LACKS, State::DONE, Outcome::NOT_READY},
      {State::READY, Event::ALL_THERE, State::SENT, Outcome::NONE},
      {State::SENT, Event::LINK_FAILED, State::DONE, Outcome::LINK_LOST},
      {State::SENT, Event::STOP_ASKED, State::DONE, Outcome::PREEMPTED},
      {State::SENT, Event::TAKEN, State::RUNNING, Outcome::NONE},
      {State::SENT, Event::REFUSED, State::DONE, Outcome::NOT_READY},
      {State::SENT, Event::LOST_ON_THE_WAY, State::READY, Outcome::NONE},
      {State::SENT, Event::NEVER_TAKEN, State::DONE, Outcome::LINK_LOST},
      {State::RUNNING, Event::LINK_FAILED, State::DONE, Outcome::LINK_LOST},
      {State::RUNNING, Event::STOP_ASKED, State::DONE, Outcome::PREEMPTED},
      {State::RUNNING, Event::ENDED, State::SETTLING, Outcome::NONE},
      {State::RUNNING, Event::DOES_NOT_END, State::DONE, Outcome::LINK_LOST},
      {State::SETTLING, Event::LINK_FAILED, State::DONE, Outcome::LINK_LOST},
      {State::SETTLING, Event::STOP_ASKED, State::DONE, Outcome::PREEMPTED},
      {State::SETTLING, Event::STAYED, State::DONE, Outcome::SUCCEEDED},
      {State::SETTLING, Event::STAYED_AWAY, State::DONE, Outcome::WRONG_MODE},
      {State::SETTLING, Event::NOTHING_SEEN, State::DONE, Outcome::NOT_SETTLED},
  };
  return table;
}

std::vector<std::string> SwitchProtocol::missing(const SwitchSettings& settings, const SwitchView& view,
                                                 vehicle::Mode target) {
  std::vector<std::string> list = linkTroubles(settings, view);
  // A fault and a silent controller are told above; this is about what is left.
  const bool told = !list.empty() && (view.bridge == Bridge::FAULT || !view.controller_connected);
  if (view.link_age <= settings.fresh && !told && view.bridge != Bridge::ARMED) {
    list.push_back(view.bridge == Bridge::PULSE ? "the radio bridge is still sending a pulse"
                                                : "the radio bridge is not armed");
  }
  if (!(view.mode_age <= settings.fresh)) {
    list.push_back("the mode estimate " + view.mode_trouble + ": is wing_state_node running?");
  } else if (view.mode == vehicle::Mode::UNKNOWN) {
    list.push_back("the mode is not known" + (view.mode_reason.empty() ? "" : ": " + view.mode_reason));
  } else if (!(view.reading_age <= settings.fresh)) {
    list.push_back("the mode estimate rests on no fresh IMU reading");
  } else if (view.mode == target) {
    list.push_back("the vehicle is already in the target mode");
  }
  return list;
}

std::string SwitchProtocol::missingText(const std::vector<std::string>& missing) {
  std::string text;
  for (const std::string& item : missing) text += (text.empty() ? "" : "; ") + item;
  return text;
}

SwitchProtocol::SwitchProtocol(const SwitchSettings& settings, vehicle::Mode target, double duration,
                               std::uint32_t first_id)
    : settings_(settings), target_(target), duration_(duration), id_(first_id) {
  settings_.validate();
  vehicle::otherMode(target_);  // throws for UNKNOWN
  require.within("duration", duration, 0.0, 60.0);
}

SwitchEvent SwitchProtocol::eventOf(const SwitchView& view) {
  if (state_ == State::DONE) return Event::NOTHING;
  if (state_ == State::READY) {
    if (view.stop_asked) return Event::STOP_ASKED;
    return missing(settings_, view, target_).empty() ? Event::ALL_THERE : Event::SOMETHING_LACKS;
  }
  if (!linkTroubles(settings_, view).empty()) return Event::LINK_FAILED;
  if (view.stop_asked) return Event::STOP_ASKED;
  if (state_ == State::SENT) return sentEvent(view);
  if (state_ == State::SETTLING) return settlingEvent(view);
  const double over = view.now - sent_ - duration_;
  if (over > 0 && view.bridge != Bridge::PULSE) return Event::ENDED;
  return over > settings_.accept_timeout ? Event::DOES_NOT_END : Event::NOTHING;
}

SwitchEvent SwitchProtocol::sentEvent(const SwitchView& view) const {
  if (view.pulse_id == id_) return Event::TAKEN;
  if (view.refused > refused_before_) return Event::REFUSED;
  const double elapsed = view.now - sent_;
  if (elapsed <= settings_.accept_timeout) return Event::NOTHING;
  // Only a status made after the command's life tells that nobody will take it any more.
  if (elapsed - view.link_age <= settings_.command_life) return Event::NOTHING;
  return attempts_ < settings_.attempts ? Event::LOST_ON_THE_WAY : Event::NEVER_TAKEN;
}

SwitchEvent SwitchProtocol::settlingEvent(const SwitchView& view) {
  const vehicle::Mode mode = seenMode(settings_, view);
  const bool there = mode == target_;
  if (there && !there_) reached_ = view.now;
  there_ = there;
  if (there && view.now - reached_ >= settings_.settle_hold) return Event::STAYED;
  if (view.now - ended_ < settings_.settle_timeout) return Event::NOTHING;
  // A stay in the mode left behind counts only now: before, the vehicle may have been on its way.
  return mode == vehicle::otherMode(target_) ? Event::STAYED_AWAY : Event::NOTHING_SEEN;
}

std::string SwitchProtocol::messageOf(SwitchEvent event, const SwitchView& view) const {
  switch (event) {
    case Event::SOMETHING_LACKS:
      return missingText(missing(settings_, view, target_));
    case Event::LINK_FAILED:
      return missingText(linkTroubles(settings_, view));
    case Event::STOP_ASKED:
      return state_ == State::READY      ? "preempted before the pulse"
             : state_ == State::SETTLING ? "preempted while settling"
                                         : "preempted while the pulse ran; the bridge ends it";
    case Event::REFUSED:
      return "the link refused the pulse: " + view.last_refusal;
    case Event::NEVER_TAKEN:
      return "the radio bridge did not take the pulse";
    case Event::DOES_NOT_END:
      return "the radio bridge does not end the pulse";
    case Event::STAYED:
      return "switched";
    case Event::STAYED_AWAY:
      return "the vehicle settled in the mode that it started from";
    case Event::NOTHING_SEEN:
      return "the mode did not become known in time" + (view.mode_reason.empty() ? "" : ": " + view.mode_reason);
    default:
      return "";
  }
}

SwitchAction SwitchProtocol::step(const SwitchView& view) {
  const Event event = eventOf(view);
  const auto row = std::find_if(table().begin(), table().end(),
                                [&](const SwitchRow& r) { return r.from == state_ && r.event == event; });
  if (row == table().end()) return state_ == State::DONE ? SwitchAction::FINISH : SwitchAction::WAIT;
  message_ = messageOf(event, view);
  state_ = row->to;
  outcome_ = row->outcome;
  if (event == Event::ALL_THERE) {
    if (++attempts_ > 1) ++id_;
    // Ids that come from a clock may lie behind those that the bridge has seen: the clock was set back, or a bag plays.
    id_ = std::max(id_, view.pulse_id + 1);
    sent_ = view.now;
    refused_before_ = view.refused;
    return SwitchAction::SEND;
  }
  if (event == Event::ENDED) ended_ = view.now;
  if (event == Event::STAYED) switch_seconds_ = reached_ - sent_;
  return state_ == State::DONE ? SwitchAction::FINISH : SwitchAction::WAIT;
}

}  // namespace snapwing::planning
