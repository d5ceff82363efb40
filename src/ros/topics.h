#pragma once
/// Names of topics, services and actions, once for every node. All are relative: a launch file's namespace moves them.
/// The layer's namespace is `nodes`: generated messages say `ros::` inside `snapwing`, so no `snapwing::ros` may exist.

namespace snapwing::nodes::topics {

constexpr char ARM_GEOMETRY[] = "arm_geometry";                    ///< snapwing/ArmGeometry, latched
constexpr char FORCE_CURVE[] = "force_curve";                      ///< snapwing/ForceDisplacementCurve, latched
constexpr char DESIGNED_ARM_GEOMETRY[] = "designed/arm_geometry";  ///< the same of the last designed arm, latched
constexpr char DESIGNED_FORCE_CURVE[] = "designed/force_curve";
constexpr char WING_GEOMETRY[] = "wing_geometry";                    ///< snapwing/WingGeometry, latched
constexpr char DESIGNED_WING_GEOMETRY[] = "designed/wing_geometry";  ///< the same of the last designed wing, latched
constexpr char OPTIMIZE_DESIGN[] = "optimize_design";                ///< action snapwing/OptimizeDesign
constexpr char DESIGN_VEHICLE[] = "design_vehicle";                  ///< action snapwing/DesignPipeline
constexpr char VALIDATE_VEHICLE[] = "validate_vehicle";              ///< action snapwing/ValidateVehicle
constexpr char TRANSITION_PLAN[] = "transition_plan";                ///< snapwing/TransitionPlan, latched
constexpr char COMMAND_PULSE[] = "command/pulse";                    ///< snapwing/PulseCommand, planner -> flight link
constexpr char LINK_STATUS[] = "link_status";                        ///< snapwing/LinkStatus, flight link -> all
constexpr char IMU[] = "imu";                                        ///< sensor_msgs/Imu of the centre
constexpr char MODE_STATE[] = "mode_state";                          ///< snapwing/ModeState
constexpr char MARKERS[] = "markers";                                ///< visualization_msgs/MarkerArray
constexpr char TRUTH[] = "truth";                                    ///< snapwing/VehicleTruth, simulation only
constexpr char PREDICT_SNAP[] = "predict_snap";                      ///< service snapwing/PredictSnap
constexpr char SWITCH_MODE[] = "switch_mode";                        ///< action snapwing/SwitchMode
constexpr char ARM[] = "arm";                ///< service snapwing/Arm: arm or disarm by the radio link
constexpr char RESET_LINK[] = "reset_link";  ///< service snapwing/ResetLink: clears a latched bridge fault
constexpr char RING_HELD[] = "ring_held";    ///< service std_srvs/SetBool: the operator sees the ring held still
constexpr char STATE_MODE[] = "state_mode";  ///< service snapwing/StateMode: the operator sees the mode
constexpr char HOLD[] = "hold";              ///< service std_srvs/SetBool: a hand brakes the boom, simulation only

}  // namespace snapwing::nodes::topics
