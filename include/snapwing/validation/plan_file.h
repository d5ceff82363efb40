#pragma once
/// A plan as `snapwing plan --json` leaves it: the pulse, what it was planned for, and the weakest vehicle that it
/// found.

#include <string>
#include <vector>

#include "snapwing/planning/accident_margins.h"
#include "snapwing/planning/pulse_planner.h"
#include "snapwing/vehicle/mode.h"
#include "snapwing/vehicle/pulse.h"
#include "snapwing/vehicle/trial.h"

namespace snapwing::validation {

struct PlanFile {
  std::string file;  ///< empty: planned by the validation itself
  vehicle::Mode start = vehicle::Mode::FIXED_WING;
  vehicle::Pulse pulse;
  vehicle::Trial trial;
  double worst_margin = 0;     ///< [1] that it states
  std::string vehicle_sha256;  ///< of the vehicle file that it was made for
  std::string table_sha256;    ///< of the force table
  /// "F -> Q" or "Q -> F"
  std::string name() const;
  /// The same as one word: "f_to_q" or "q_to_f".
  std::string word() const;
};

/// @throws common::FileError, common::SettingError naming key, value and what is allowed; a plan that was refused
PlanFile loadPlan(const std::string& path);

/// Writes a plan, accepted or refused. @param table_file  that it was made on
/// @param accidents  what may flip the mode by accident; null: nothing of it is written. @throws common::FileError
void savePlan(const std::string& path, const vehicle::Vehicle& vehicle, const std::string& table_file,
              const vehicle::Trial& trial, const planning::TransitionPlan& plan,
              const std::vector<planning::AccidentMargin>* accidents = nullptr);

}  // namespace snapwing::validation
