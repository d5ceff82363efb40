#pragma once
/// A finished wing: what the blade, the parts, the picture and ROS need of a design, and its file (wing.yaml).

#include <array>
#include <string>

#include "snapwing/design/wing/wing_design.h"
#include "snapwing/design/wing/wing_stack.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::design {

/// One wing in the linkage frame (origin at the arm's axle, x outward, y up), and where that frame sits.
struct WingLayout {
  std::string name;
  std::string rung;  ///< "rigid", "elastic" (beams) or "solid": what designed it
  FourBar linkage;
  int wing_sign = 1;                     ///< sense in which the wing folds
  std::array<double, 2> arm_rotation{};  ///< of the two driven states [rad]
  /// Point of the ring-fixed anchor bar that the blade's last edge runs through [m]: beyond the leading edge of the
  /// largest state by blade.folded_span, as far from joint 2 as the tip.
  Eigen::Vector2d anchor{0, 0};
  double axle_radius = 0;      ///< of the axle from the vehicle's axis [m]
  double axle_below_ring = 0;  ///< [m]
  WingBars bars;
  WingBladeSettings blade;

  /// @throws common::Error naming what is wrong
  void validate() const;
};

/// @param design  must hold a designed linkage. @throws common::Error otherwise
WingLayout layoutOf(const WingSettings& settings, const WingDesign& design, const vehicle::Vehicle& vehicle,
                    const std::string& rung);

/// Writes wing.yaml: the layout, and under "results" what was reached. Atomic. @throws common::FileError
void saveWing(const WingLayout& layout, const WingSettings& settings, const WingDesign& design, const StackPlan& stack,
              const std::string& path);
/// @throws common::FileError, common::SettingError
WingLayout loadWing(const std::string& path);

}  // namespace snapwing::design
