#pragma once
/// Between the link's plain data and its LCM types. The only place that knows both.

#include "controller_watch.h"
#include "snapwing/link/bridge_types.h"
#include "snapwing_lcm/abort_t.hpp"
#include "snapwing_lcm/heartbeat_t.hpp"
#include "snapwing_lcm/link_status_t.hpp"
#include "snapwing_lcm/pulse_command_t.hpp"
#include "snapwing_lcm/telemetry_t.hpp"

namespace snapwing::link {

/// @return false if of another version
bool fromLcm(const snapwing_lcm::stamp_t& in, Stamp& out);
bool fromLcm(const snapwing_lcm::pulse_command_t& in, PulseCommand& out);
bool fromLcm(const snapwing_lcm::heartbeat_t& in, Heartbeat& out);
bool fromLcm(const snapwing_lcm::abort_t& in, Abort& out);
bool fromLcm(const snapwing_lcm::link_status_t& in, BridgeStatus& out);

snapwing_lcm::stamp_t toLcm(const Stamp& in);
snapwing_lcm::pulse_command_t toLcm(const PulseCommand& in);
snapwing_lcm::heartbeat_t toLcm(const Heartbeat& in);
snapwing_lcm::abort_t toLcm(const Abort& in);
/// @param rejected  messages that never reached the bridge's logic
snapwing_lcm::link_status_t toLcm(const BridgeStatus& in, const Stamp& stamp, std::int64_t rejected);
/// @param now  [s] for the ages
snapwing_lcm::telemetry_t toLcm(const ControllerTelemetry& in, const Stamp& stamp, double now);

}  // namespace snapwing::link
