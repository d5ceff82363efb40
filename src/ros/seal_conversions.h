#pragma once
/// Between commands, their seal and ROS messages.

#include <snapwing/PulseCommand.h>
#include <snapwing/Seal.h>

#include <algorithm>

#include "snapwing/link/command_seal.h"

namespace snapwing::nodes {

/// What is sealed and sent on of a pulse command.
inline link::PulseShape shapeOf(const PulseCommand& command) {
  link::PulseShape shape;
  shape.throttle = command.pulse.throttle;
  shape.duration = command.pulse.duration;
  shape.hold_throttle = command.pulse.hold_throttle;
  shape.hold_duration = command.pulse.hold_duration;
  shape.pitch = command.pitch;
  shape.mixed = command.mixed != 0;
  return shape;
}

inline link::CommandSeal fromMessage(const Seal& message) {
  link::CommandSeal seal;
  seal.session = message.session;
  seal.status_number = message.status_number;
  seal.nonce = message.nonce;
  std::copy(message.code.begin(), message.code.end(), seal.code.begin());
  return seal;
}

inline Seal toMessage(const link::CommandSeal& seal) {
  Seal message;
  message.session = seal.session;
  message.status_number = seal.status_number;
  message.nonce = seal.nonce;
  std::copy(seal.code.begin(), seal.code.end(), message.code.begin());
  return message;
}

}  // namespace snapwing::nodes
