#pragma once
/// Between the seal of commands and its ROS message.

#include <snapwing/Seal.h>

#include <algorithm>

#include "snapwing/link/command_seal.h"

namespace snapwing::nodes {

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
