#pragma once
/// A wing from its settings to files: designed, compared with elastic bars, with layout, table and parts in one folder.

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "snapwing/design/wing/wing_clearance.h"
#include "snapwing/design/wing/wing_elastic_problem.h"
#include "snapwing/design/wing/wing_layout.h"
#include "snapwing/design/wing/wing_table.h"

namespace snapwing::design {

enum class WingRung { RIGID, BEAMS, SOLIDS };
/// "rigid", "elastic" (beams) or "solid". @throws common::Error for any other word
WingRung wingRungOf(const std::string& name);
const char* nameOf(WingRung rung);

/// The design problem on bars of one rung.
std::unique_ptr<WingProblem> makeWingProblem(const WingSettings& settings, WingRung rung);

struct WingJob {
  std::string folder;  ///< of the results; made if missing
  WingRung rung = WingRung::RIGID;
  int points = 161;                                ///< of the table
  std::function<bool(const WingProgress&)> go_on;  ///< between local runs; false cancels
  std::function<bool()> cancelled;                 ///< at each evaluation; true cancels
};

constexpr double WING_ROTATION_TOLERANCE = 0.15;  ///< [rad]
constexpr double WING_TIP_TOLERANCE = 0.010;      ///< [m]

struct WingOutcome {
  std::string folder;
  WingDesign design;  ///< what follows is filled if it is DESIGNED
  WingLayout layout;
  WingTable table;
  RungComparison comparison;  ///< with the solids if they designed it, else with beams
  double panel_angle = 0;     ///< [rad]
  double mass = 0;            ///< of one wing [kg]
  double friction_work = 0;   ///< of both wings on one way [J]
  double barrier_back = std::numeric_limits<double>::quiet_NaN();  ///< of the vehicle's arms [J]; NaN without a table
  WingClearance clearance;                                         ///< from the propellers
  StackPlan stack;           ///< layers of bars and rod; a wing without any cannot be put together as drawn
  bool targets_met = false;  ///< both wing rotations and both tips within the tolerances above
  bool from_store = false;
};

/// Designs and writes wing.yaml, parts/ and, last, wing_table.h5. Nothing is written unless the design succeeds.
/// @throws common::Error
WingOutcome designWingInto(const WingSettings& settings, const WingJob& job);

/// A wing that is there already, on an arm that turns otherwise: its table anew up to the layout's second state, with
/// the blade's columns and, where the elastic bars converge, their energy. Provenance is that of the layout's file.
/// @throws common::Error if the arm does not turn that far, or the loop opens on the way
WingTable tabulateLayout(const WingLayout& layout, const ArmMotion& motion, int points = 161);

/// Hash of all that a design depends on, the program included.
std::string wingHash(const WingSettings& settings, WingRung rung);
/// The layout and table in a folder, if both are there; the objective is computed again on the layout's rung, the
/// design assessed again on rigid bars.
/// @throws common::FileError
std::optional<WingOutcome> loadWingOutcome(const WingSettings& settings, const std::string& folder);

}  // namespace snapwing::design
