"""A made-up run for the tests: a small simulation of the vehicle, as messages fed to the recorder's buffer.

Nothing here is a reference for the physics; it only has the shape of a real run."""

import math
import os
from types import SimpleNamespace as Message

import h5py
import numpy as np

from snapwing_tools import topics
from snapwing_tools.recorder import RunBuffer

ORIGIN = 1700000000.0
BARRIER, SECOND = 0.028, 0.051
RING, CENTRE = 0.383, 0.400
THRUST = 35.6
SCALE = 4.0 / (0.0116 * 0.0164 * 0.0394)
PULSES = {"F->Q": (2.0, 0.55, 0.30), "Q->F": (6.0, 1.0, 0.75)}  # start [s], throttle [1], duration [s]


def force(u):
    """Total force of the arms [N]."""
    return SCALE * u * (u - BARRIER) * (u - SECOND)


def energy(u):
    return SCALE * (u**4 / 4 - (BARRIER + SECOND) * u**3 / 3 + BARRIER * SECOND * u**2 / 2)


def simulate(pulses, seconds=10.0, step=1e-3, start_travel=0.0, damping=2.2, drag=0.021):
    """Arrays time, travel, travel_rate, position, speed, thrust of the two-body model; `pulses` = [(start, throttle,
    duration)]."""
    count = int(round(seconds / step))
    names = ("time", "travel", "travel_rate", "position", "speed", "thrust", "output")
    result = {name: np.zeros(count) for name in names}
    u, rate, position, speed, thrust = start_travel, 0.0, 0.0, 0.0, 0.0
    for k in range(count):
        now = k * step
        level = max([throttle for start, throttle, duration in pulses if start + 0.03 <= now < start + 0.03 + duration],
                    default=0.0)
        thrust += step / 0.05 * (THRUST * (0.8 * level**2 + 0.2 * level) - thrust)
        arms = force(u) + damping * rate
        ring = (thrust - arms - drag * speed * abs(speed)) / RING
        centre = arms / CENTRE
        rate += step * (ring - centre)
        speed += step * ring
        u += step * rate
        position += step * speed
        for name, value in zip(result, (now, u, rate, position, speed, thrust, level)):
            result[name][k] = value
    return result


def true_mode(motion, window=0.1):
    """0 while it moves fast, else the basin."""
    basin = np.where(motion["travel"] > BARRIER, 2, 1)
    return np.where(np.abs(motion["travel_rate"]) > 0.4, 0, basin)


def shipped_inputs():
    """What the shipped force table was computed from: the run is of that arm."""
    table = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "data", "tables", "arris_x220_planar.h5")
    with h5py.File(table, "r") as file:
        found = file["provenance"].attrs["inputs_sha256"]
    return found.decode() if isinstance(found, bytes) else str(found)


SHIPPED_INPUTS = shipped_inputs()


def header(time):
    return Message(stamp=ORIGIN + time)


def prediction(start, end, motion, begin, until):
    """SnapPrediction of the simulation itself, so that a perfect prediction can be recognised."""
    inside = (motion["time"] >= begin) & (motion["time"] <= until)
    time, travel = motion["time"][inside], motion["travel"][inside]
    steps = np.flatnonzero((travel[1:] > BARRIER) != (travel[:-1] > BARRIER))
    return Message(rung="lumped", start_mode=start, end_mode=end, snapped=end != start,
                   snap_time=time[steps[-1]] - begin if len(steps) else math.nan, peak_travel=travel.max(),
                   least_travel=travel.min(), end_travel=travel[-1], end_speed=0.0, energy_margin=0.7,
                   force_error=0.05, out_of_table=False, compute_seconds=1e-3)


def curve_message():
    travel = np.linspace(-0.005, 0.07, 151)
    peak = travel[np.argmax(np.where(travel < BARRIER, force(travel), -9))]
    valley = travel[np.argmin(np.where(travel > BARRIER, force(travel), 9))]
    return Message(header=header(-1.0), rung="made up", inputs_sha256=SHIPPED_INPUTS, travel=list(travel),
                   force=list(force(travel)), energy=list(energy(travel)), rotation=list(travel * 16),
                   stable=[True] * len(travel), peak_travel=peak, peak_force=force(peak), valley_travel=valley,
                   valley_force=force(valley), barrier_travel=BARRIER, second_travel=SECOND,
                   barrier_forward=energy(BARRIER), barrier_back=energy(BARRIER) - energy(SECOND), hysteresis=math.nan,
                   bistable=True)


def geometry_message():
    return Message(header=header(-1.0), vehicle="arris_x220", arm_count=4, pin=Message(x=0.078, y=0.002), leg_width=0.02,
                   leg_thickness=0.005, bar_thickness=0.01, housing_radius=0.045, ring_radius=0.125,
                   axle_below_ring=0.02, density_file="made_up.csv", density_sha256="cd" * 32)


def plan_message(name, motion, pulses):
    start, throttle, duration = pulses[name]
    modes = {"F->Q": (1, 2), "Q->F": (2, 1)}[name]
    expected = prediction(*modes, motion, start, start + 3.5)
    return Message(header=header(start - 0.3), start_mode=modes[0], target_mode=modes[1], accepted=True, reason="",
                   pulse=Message(throttle=throttle, duration=duration, hold_throttle=0.0, hold_duration=0.0), thrust_fraction=throttle, worst_margin=0.3,
                   share_switched=1.0, realisations=256, compute_seconds=0.4, nominal=expected, worst=expected)


def link_message(time, number, pulse_id, throttle, armed, failsafe=False):
    """One frame of the bridge."""
    micros = int(1000 + 1000 * throttle) if throttle else 1000
    state = 3 if throttle else (2 if armed else 1)
    motors = [int(1070 + 0.93 * (micros - 1000)) if armed else 1000] * 4
    return Message(header=header(time), vehicle_id="made_up", session=1, number=number, bridge_state=4 if failsafe else state, bridge_fault="", pulse_id=pulse_id,
                   frames_sent=number, channels=[1500, 1500, micros, 1500, 1900 if armed else 1000, 1000, 1000, 1000],
                   commanded_throttle=throttle, commands_accepted=pulse_id, commands_refused=0, last_refusal="",
                   period_worst=0.021, controller_connected=True, controller_armed=armed and not failsafe,
                   controller_failsafe=failsafe, arming_disable_flags=0, motors=motors if time > 0.2 else [],
                   telemetry_age=0.03)


def _send(buffer, name, message):
    topic = next(t for t in topics.SERIES + topics.LATCHED if t.name == name)
    # Both clocks go on together, as in a run that nobody disturbs.
    buffer.add(topic, message, message.header.stamp + 0.001, steady=message.header.stamp - ORIGIN + 1000.0)


def make_buffer(pulses=None, leave_out=(), seconds=10.0, provenance=None):
    """RunBuffer of a whole run. `pulses` as PULSES; `leave_out` names topics that never came."""
    pulses = PULSES if pulses is None else pulses
    motion = simulate(list(pulses.values()), seconds)
    buffer = RunBuffer(ORIGIN, provenance or {"snapwing_version": "0.1.0", "recorder_command": "test"})

    messages = []

    def send(name, message):
        if name not in leave_out:
            messages.append((name, message))
    send("force_curve", curve_message())
    send("arm_geometry", geometry_message())
    for number, (name, (start, throttle, duration)) in enumerate(pulses.items(), 1):
        send("transition_plan", plan_message(name, motion, pulses))
        send("command/pulse", Message(header=header(start), id=number,
                                      pulse=Message(throttle=throttle, duration=duration, hold_throttle=0.0, hold_duration=0.0), mixed=False, pitch=0.0))
    _send_motion(send, motion)
    _send_frames(send, pulses, seconds)
    for name, message in sorted(messages, key=lambda pair: pair[1].header.stamp):
        _send(buffer, name, message)
    return buffer


def _send_motion(send, motion):
    mode = true_mode(motion)
    generator = np.random.RandomState(7)
    for k in range(0, len(motion["time"]), 5):
        now, u = motion["time"][k], motion["travel"][k]
        send("truth", Message(header=header(now), mode=int(mode[k]), travel=u, travel_rate=motion["travel_rate"][k],
                              position=motion["position"][k], speed=motion["speed"][k], thrust=motion["thrust"][k],
                              arm_rotation=u * 16, motor_outputs=[0.07 + 0.93 * motion["output"][k]] * 4, held=False))
        likely = 1 / (1 + math.exp(-(u - BARRIER) / 0.004))
        estimate = 2 if likely > 0.95 else (1 if likely < 0.05 else 0)
        deviation = 0.001 + 0.004 * min(1.0, abs(motion["travel_rate"][k]))
        send("mode_state", Message(header=header(now), mode=estimate, probability_fixed_wing=1 - likely,
                                   probability_quadrotor=likely, travel=u + generator.normal(0, 0.0004),
                                   travel_deviation=deviation, wing_angle=u * 40, reading_age=0.0,
                                   reason="" if estimate else "the readings fit both modes"))
        zero = Message(x=0.0, y=0.0, z=0.0)
        send("imu", Message(header=header(now), linear_acceleration=zero, angular_velocity=zero))


def _send_frames(send, pulses, seconds):
    generator = np.random.RandomState(5)
    now, number = 0.0, 0
    while now < seconds:
        number += 1
        current, throttle = 0, 0.0
        for index, (start, level, duration) in enumerate(pulses.values(), 1):
            current = index if now >= start else current
            throttle = level if start <= now < start + duration else throttle
        send("link_status", link_message(now, number, current, throttle, now > 0.5))
        now += 0.02 + abs(generator.normal(0, 0.0004))


def write_force_table(path):
    """A force table as the solver writes it, with an outline that has a hole."""
    travel = np.linspace(0, 0.07, 36)
    square = np.array([[0, 0], [0.08, 0], [0.08, 0.02], [0.02, 0.02], [0.02, 0.04], [0, 0.04]])
    hole = np.array([[0.03, 0.005], [0.05, 0.005], [0.05, 0.015], [0.03, 0.015]])
    rest = np.vstack([square, hole])
    moved = [rest + np.array([0.0, -1.0]) * u * (1 - rest[:, :1] / 0.08) for u in travel]
    arrays = {"format_version": ([2], "1"), "arm_count": ([4], "1"), "travel": (travel, "m"),
              "force": (force(travel) / 4, "N"), "energy": (energy(travel) / 4, "J"), "rotation": (travel * 16, "rad"),
              "stable": (np.ones(36, dtype=int), "1"), "force_back": (force(travel) / 4 - 0.01, "N"),
              "shapes/loop_sizes": ([6, 4], "1"), "shapes/rest": (rest.ravel(), "m"),
              "shapes/moved": (np.concatenate([m.ravel() for m in moved]), "m")}
    with h5py.File(path, "w") as file:
        for name, (data, unit) in arrays.items():
            file.create_dataset(name, data=data).attrs["unit"] = unit
        file.create_group("provenance").attrs["rung"] = "made up"


def write_map(path, name="F->Q"):
    """An outcome map with a plausible shape."""
    lines = ["throttle,duration_s,share_switched,worst_margin"]
    for throttle in np.linspace(0.2, 1.0, 17):
        for duration in np.linspace(0.05, 1.0, 20):
            margin = 2 * (throttle - 0.45) if name == "F->Q" else throttle + duration - 1.7
            margin -= 3 * max(0, 0.2 - duration)
            share = min(1, max(0, 0.5 + 2 * margin))
            lines.append("{:.3f},{:.3f},{:.3f},{:.4f}".format(throttle, duration, share, margin))
    with open(path, "w") as file:
        file.write("\n".join(lines) + "\n")


def write_trajectory(path, name="F->Q"):
    start, throttle, duration = PULSES[name]
    begin = 0.0 if name == "F->Q" else SECOND
    motion = simulate([(0.0, throttle, duration)], 3.0, start_travel=begin, damping=2.4)
    with open(path, "w") as file:
        file.write("time_s,travel_m,thrust_N\n")
        for k in range(0, 3000, 2):
            file.write("{:.4f},{:.6f},{:.4f}\n".format(motion["time"][k], motion["travel"][k], motion["thrust"][k]))
