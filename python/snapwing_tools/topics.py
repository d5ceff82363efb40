"""What a run stores of each topic: one table of columns per topic, with units. No ROS is needed to read this.

A column takes its value from a message by a dotted path ("nominal.snap_time"). Kinds: float, int, bool, text, and
array (a row of numbers of varying length, padded with NaN in the file).
"""

from collections import namedtuple

Column = namedtuple("Column", "name unit kind path meaning")
Topic = namedtuple("Topic", "name message columns needed_for")

MODE_NAMES = {0: "unknown", 1: "F", 2: "Q"}
MODE_NUMBERS = {"F": 1, "Q": 2}
BRIDGE_NAMES = {0: "unknown", 1: "idle", 2: "armed", 3: "pulse", 4: "fault"}

# Place of a channel on the wire (A E T R AUX1 ...).
THROTTLE_CHANNEL = 2
AUX1_CHANNEL = 4


def _column(name, unit, kind="float", path=None, meaning=""):
    return Column(name, unit, kind, path or name, meaning)


def _prediction(prefix):
    """Columns of a SnapPrediction inside a plan."""
    parts = [("rung", "", "text"), ("end_mode", "", "int"), ("snapped", "", "bool"), ("snap_time", "s", "float"),
             ("peak_travel", "m", "float"), ("least_travel", "m", "float"), ("end_travel", "m", "float"),
             ("end_speed", "m/s", "float"), ("energy_margin", "1", "float"), ("force_error", "N", "float"),
             ("out_of_table", "", "bool"), ("compute_seconds", "s", "float")]
    return [_column(prefix + "_" + name, unit, kind, prefix + "." + name) for name, unit, kind in parts]


# Topics that are recorded as a series, one row per message.
SERIES = [
    Topic("truth", "snapwing/VehicleTruth", [
        _column("mode", "", "int", meaning="true mode: 0 unknown, 1 F, 2 Q"),
        _column("travel", "m", meaning="u"),
        _column("travel_rate", "m/s"),
        _column("position", "m", meaning="of the ring along the thrust axis"),
        _column("speed", "m/s", meaning="of the ring"),
        _column("thrust", "N", meaning="all rotors"),
        _column("arm_rotation", "rad"),
        _column("motor_outputs", "1", "array"),
        _column("held", "", "bool"),
    ], "whether the switches truly happened, true travel"),
    Topic("mode_state", "snapwing/ModeState", [
        _column("mode", "", "int"),
        _column("probability_fixed_wing", "1"),
        _column("probability_quadrotor", "1"),
        _column("travel", "m"),
        _column("travel_deviation", "m"),
        _column("wing_angle", "rad"),
        _column("reason", "", "text", meaning="why the mode is unknown"),
        _column("reading_age", "s", meaning="of the newest IMU reading in the estimate"),
    ], "estimated travel and mode probability"),
    Topic("link_status", "snapwing/LinkStatus", [
        _column("vehicle_id", "", "text"),
        _column("session", "", "int", meaning="of the bridge"),
        _column("number", "1", "int", meaning="of the bridge's frame"),
        _column("bridge_state", "", "int", meaning="0 unknown, 1 idle, 2 armed, 3 pulse, 4 fault"),
        _column("bridge_fault", "", "text"),
        _column("pulse_id", "", "int"),
        _column("frames_sent", "1", "int"),
        _column("channels", "us", "array", meaning="A E T R AUX1 ..."),
        _column("commanded_throttle", "1"),
        _column("commands_accepted", "1", "int"),
        _column("commands_refused", "1", "int"),
        _column("last_refusal", "", "text"),
        _column("period_worst", "s"),
        _column("controller_connected", "", "bool"),
        _column("controller_armed", "", "bool"),
        _column("controller_failsafe", "", "bool"),
        _column("arming_disable_flags", "", "int"),
        _column("motors", "us", "array"),
        _column("telemetry_age", "s"),
    ], "frames that were sent, state of the flight controller, link statistics"),
    Topic("command/pulse", "snapwing/PulseCommand", [
        _column("id", "", "int"),
        _column("throttle", "1", path="pulse.throttle"),
        _column("duration", "s", path="pulse.duration"),
        _column("hold_throttle", "1", path="pulse.hold_throttle"),
        _column("hold_duration", "s", path="pulse.hold_duration"),
        _column("mixed", "", "bool"),
        _column("pitch", "1"),
    ], "when which pulse was commanded"),
    Topic("transition_plan", "snapwing/TransitionPlan", [
        _column("start_mode", "", "int"),
        _column("target_mode", "", "int"),
        _column("accepted", "", "bool"),
        _column("reason", "", "text"),
        _column("throttle", "1", path="pulse.throttle"),
        _column("duration", "s", path="pulse.duration"),
        _column("hold_throttle", "1", path="pulse.hold_throttle"),
        _column("hold_duration", "s", path="pulse.hold_duration"),
        _column("thrust_fraction", "1"),
        _column("worst_margin", "1"),
        _column("share_switched", "1"),
        _column("realisations", "1", "int"),
        _column("compute_seconds", "s"),
    ] + _prediction("nominal") + _prediction("worst"), "predictions and margins"),
    Topic("imu", "sensor_msgs/Imu", [
        _column("acceleration_x", "m/s2", path="linear_acceleration.x"),
        _column("acceleration_y", "m/s2", path="linear_acceleration.y"),
        _column("acceleration_z", "m/s2", path="linear_acceleration.z"),
        _column("rate_x", "rad/s", path="angular_velocity.x"),
        _column("rate_y", "rad/s", path="angular_velocity.y"),
        _column("rate_z", "rad/s", path="angular_velocity.z"),
    ], "measured acceleration"),
]

# Latched topics of which the last message is kept.
LATCHED = [
    Topic("force_curve", "snapwing/ForceDisplacementCurve", [
        _column("rung", "", "text"),
        _column("inputs_sha256", "", "text"),
        _column("travel", "m", "array"),
        _column("force", "N", "array", meaning="total of all arms"),
        _column("energy", "J", "array", meaning="total of all arms"),
        _column("rotation", "rad", "array"),
        _column("stable", "", "array"),
        _column("peak_travel", "m"), _column("peak_force", "N"),
        _column("valley_travel", "m"), _column("valley_force", "N"),
        _column("barrier_travel", "m"), _column("second_travel", "m"),
        _column("barrier_forward", "J"), _column("barrier_back", "J"),
        _column("hysteresis", "N"),
        _column("bistable", "", "bool"),
    ], "force-displacement curve and barrier"),
    Topic("arm_geometry", "snapwing/ArmGeometry", [
        _column("vehicle", "", "text"),
        _column("arm_count", "1", "int"),
        _column("pin_x", "m", path="pin.x"), _column("pin_y", "m", path="pin.y"),
        _column("leg_width", "m"), _column("leg_thickness", "m"), _column("bar_thickness", "m"),
        _column("housing_radius", "m"), _column("ring_radius", "m"), _column("axle_below_ring", "m"),
        _column("density_file", "", "text"),
        _column("density_sha256", "", "text"),
    ], "arm's shape and its provenance"),
]


def group_name(topic_name):
    """Name of a topic's group in the run file."""
    return topic_name.replace("/", "_")


def series_topic(name):
    return next(topic for topic in SERIES if topic.name == name)


def value_of(message, path):
    """Value of a message at a dotted path."""
    for part in path.split("."):
        message = getattr(message, part)
    return message
