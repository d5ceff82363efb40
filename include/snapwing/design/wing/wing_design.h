#pragma once
/// Design of the wing's linkage: many random layouts, the best of them optimised with gradients, the best result kept.
/// Deterministic: the same settings give the same bits.

#include <array>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "snapwing/design/wing/wing_problem.h"

namespace snapwing::design {

enum class WingStatus {
  NOT_SOLVED,
  DESIGNED,    ///< every constraint holds, no dead point, transmission margin kept
  INFEASIBLE,  ///< no start reached a layout within the constraints
  CANCELLED
};
const char* nameOf(WingStatus status);

/// One driven state of a finished design.
struct WingState {
  double arm_rotation = 0;  ///< [rad]
  FourBarPose pose;
  Eigen::Vector2d target;     ///< of the tip [m]
  double tip_residual = 0;    ///< |tip - target| [m]
  double rotation_error = 0;  ///< wing rotation - wanted [rad]
};

struct LocalResult {
  Eigen::Vector4d X = Eigen::Vector4d::Zero();                 ///< [m]
  double objective = 0;                                        ///< [m2]
  double violation = std::numeric_limits<double>::infinity();  ///< largest constraint, 0 if all hold [1]
  int evaluations = 0;
  std::string stop;  ///< what ended the run
};

struct WingDesign {
  WingStatus status = WingStatus::NOT_SOLVED;
  std::string message;
  FourBar linkage;
  double objective = 0;  ///< [m2]
  std::array<WingState, 2> states;
  TravelCheck travel;                 ///< from rest to the largest arm rotation of the settings
  double separation = 0;              ///< |x1 - x2| [m]
  double joint2_x = 0, joint1_y = 0;  ///< in state 2 [m]
  int samples = 0, runs = 0;
  int evaluations = 0;                  ///< of all local runs
  double seconds = 0;                   ///< wall time
  std::vector<LocalResult> runners_up;  ///< distinct feasible layouts, best first, at most 8; the first is the design
};

/// Random layouts that close over the travel, best penalised objective first. @param count  how many to return
std::vector<Eigen::Vector4d> sampleLayouts(const WingProblem& problem, int samples, int count, unsigned seed);

/// One local run from X with the settings' optimiser. @param cancelled  asked at each evaluation; true ends the run
LocalResult improve(const WingProblem& problem, const Eigen::Vector4d& X,
                    const std::function<bool()>& cancelled = nullptr);

/// Where a design stands between two local runs.
struct WingProgress {
  int run = 0, runs = 0;                                       ///< done, of
  double objective = std::numeric_limits<double>::infinity();  ///< of the best feasible layout so far [m2]
  double violation = std::numeric_limits<double>::infinity();  ///< least so far, scaled
};

/// @param go_on  called between local runs; false cancels
/// @param cancelled  asked at each evaluation of a run; true cancels
WingDesign designWing(const WingProblem& problem, const std::function<bool(const WingProgress&)>& go_on = nullptr,
                      const std::function<bool()>& cancelled = nullptr);

/// Fills states, travel check and wall distances of a layout (rigid bars), and the status that follows from them.
void assess(const WingSettings& settings, WingDesign* design);

}  // namespace snapwing::design
