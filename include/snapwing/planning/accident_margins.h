#pragma once
/// What may flip the vehicle's mode against the pilot's will, and how far away it is.

#include <string>
#include <vector>

#include "snapwing/rom/lumped_model.h"
#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/pulse.h"
#include "snapwing/vehicle/trial.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::planning {

/// One mishap; `limit` is where the mode flips, `occurs` what the vehicle meets.
struct AccidentMargin {
  std::string name;         ///< e.g. "sudden thrust in F"
  std::string explanation;  ///< one sentence
  vehicle::Mode mode = vehicle::Mode::UNKNOWN;
  std::string unit;    ///< "N", "m/s", ...
  double limit = 0;    ///< value at which the mode is lost; infinity = never within reach
  double occurs = 0;   ///< value met in use (hover thrust, weight, ...); NaN = up to the pilot
  bool holds = false;  ///< the mode survives what is met
};

/// Nominal parameters, free flight unless said: sudden thrust from idle in F, hover thrust cut in Q, cut while climbing
/// in Q (speed), ring held upright in F, inverted and held in Q, ring braked in Q (deceleration, slowly applied), wind
/// that jumps along the axis: against the thrust of a hovering Q, from behind on a gliding F.
std::vector<AccidentMargin> accidentMargins(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table,
                                            const std::optional<vehicle::WingTable>& wing = {});

/// A requested switch.
struct AskedSwitch {
  vehicle::Mode start = vehicle::Mode::UNKNOWN;
  vehicle::Pulse pulse;
  vehicle::Trial trial;
};

/// What may keep the nominal vehicle from switching: "one weak motor" (share of its thrust that is missing) and "one
/// stiff arm" (share by which it is stiffer than the others); `occurs` is the file's half width, as if one alone had
/// it. `mode` is the start of the switch that is lost first. Only the thrust axis is seen: neither the moment of the
/// one motor, nor the tilt of ring and housing. @param switches  not empty
std::vector<AccidentMargin> faultMargins(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table,
                                         const std::optional<vehicle::WingTable>& wing,
                                         const std::vector<AskedSwitch>& switches);

}  // namespace snapwing::planning
