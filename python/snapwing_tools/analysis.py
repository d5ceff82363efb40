"""What a recorded run shows, worked out from its own data: switches, frames, link. Nothing here is taken from what a
node claims about its own success; a claim is compared with the record in report.py."""

import math

import numpy as np

from snapwing_tools import topics

EXPECTED = ("F->Q", "Q->F")

# A switch is watched until the next pulse or until the hand takes hold, at most this long after its command [s].
WATCH_SECONDS = 6.0
# The end mode is what held over this last stretch of the watch [s].
SETTLED_SECONDS = 0.3


class Switch:
    """One pulse that was commanded and what came of it. Times in seconds; NaN or None = not known from the record."""

    def __init__(self, name, start, until, throttle, duration, pulse_id, hold=(0.0, 0.0)):
        self.name = name            # "F->Q", "Q->F" or "? (pulse n)"
        self.start = start          # time of the command, since the run's origin
        self.until = until          # end of the watch
        self.throttle = throttle
        self.duration = duration
        self.pulse_id = pulse_id
        self.hold = hold            # throttle and duration of the level behind the pulse
        self.plan = None            # dict of the plan's columns
        self.true = None            # Motion of the true vehicle
        self.estimate_seconds = math.nan  # command -> estimated mode reached the target for good
        self.sent = None            # SentPulse
        self.motors = (math.nan, math.nan)  # start and end of the pulse as it truly reached the motors

    @property
    def start_mode(self):
        return self.name.split("->")[0] if "->" in self.name else None

    @property
    def target_mode(self):
        return self.name.split("->")[1] if "->" in self.name else None

    @property
    def happened(self):
        """True or False as the true state shows it; None if the record cannot tell."""
        if self.true is None or self.target_mode is None or self.true.end_mode is None:
            return None
        return self.true.start_mode == self.start_mode and self.true.end_mode == self.target_mode

    @property
    def whole(self):
        """[s] of pulse and hold, which the bridge sends as one."""
        return self.duration + self.hold[1]


class Motion:
    """The true motion within a switch's watch."""

    def __init__(self):
        self.start_mode = self.end_mode = None
        self.peak_speed = math.nan
        self.snap_time = self.peak_travel = self.least_travel = self.end_travel = self.end_speed = math.nan


def motors_pulse(run, switch):
    """(start, end) of the pulse in the outputs that truly reached the motors, as the truth was sampled; NaN if none.
    The pulse is where they are above the middle between their level at the command and their highest."""
    if not run.has("truth") or run.series["truth"]["motor_outputs"].shape[1] == 0:
        return math.nan, math.nan
    rows = window(run.series["truth"], switch.start - 0.1, switch.until)
    outputs = np.nan_to_num(rows["motor_outputs"]).mean(axis=1)
    before = outputs[rows["time"] <= switch.start]
    level = before[-1] if len(before) else 0.0
    high = np.flatnonzero((rows["time"] > switch.start) & (outputs > 0.5 * (level + outputs.max(initial=0.0))))
    if not len(high) or outputs.max() < level + 0.01:
        return math.nan, math.nan
    end = rows["time"][min(high[-1] + 1, len(outputs) - 1)]
    return rows["time"][high[0]], end


class SentPulse:
    """What the bridge put on the wire for a pulse."""

    def __init__(self):
        self.first = self.last = math.nan  # time of the first and last frame with the pulse's throttle
        self.highest = math.nan            # [us]
        self.frames = 0
        self.period = math.nan             # usual time between frames [s]

    @property
    def duration(self):
        """Time the receiver held the pulse: from the first frame to the one after the last."""
        return self.last - self.first + self.period if self.frames else math.nan


def find_switches(run):
    """Switches in the order of their commands."""
    if not run.has("command/pulse"):
        return []
    pulses = run.series["command/pulse"]
    found = []
    for index, start in enumerate(pulses["time"]):
        following = pulses["time"][index + 1] if index + 1 < len(pulses["time"]) else math.inf
        until = min(start + WATCH_SECONDS, following, last_time(run), _hand_takes(run, start),
                    _other_pulse(run, start, pulses["id"][index]))
        hold = tuple(pulses[name][index] if name in pulses else 0.0 for name in ("hold_throttle", "hold_duration"))
        switch = Switch("? (pulse {})".format(pulses["id"][index]), start, until, pulses["throttle"][index],
                        pulses["duration"][index], int(pulses["id"][index]), hold)
        switch.plan = _plan_of(run, switch)
        switch.true = _true_motion(run, switch)
        switch.name = _name_of(switch)
        switch.estimate_seconds = _estimate_seconds(run, switch)
        switch.sent = _sent_pulse(run, switch)
        switch.motors = motors_pulse(run, switch)
        found.append(switch)
    return found


def last_time(run):
    return max((columns["time"][-1] for columns in run.series.values() if len(columns["time"])), default=0.0)


def _other_pulse(run, start, pulse_id):
    """When the bridge sends a later pulse, whether or not its command was recorded."""
    if not run.has("link_status"):
        return math.inf
    link = run.series["link_status"]
    frames = (link["time"] > start) & (link["bridge_state"] == 3) & (link["pulse_id"] > pulse_id)
    return link["time"][frames][0] if frames.any() else math.inf


def _hand_takes(run, start):
    """When the experimenter takes hold again after a command; what happens then is the hand's doing."""
    if not run.has("truth"):
        return math.inf
    truth = run.series["truth"]
    after = np.flatnonzero(truth["time"] >= start)
    taken = [k for k in after if k > 0 and truth["held"][k] and not truth["held"][k - 1]]
    return truth["time"][taken[0] - 1] if taken else math.inf


def window(columns, start, until):
    """The rows of a series within [start, until]."""
    inside = (columns["time"] >= start) & (columns["time"] <= until)
    return {name: data[inside] for name, data in columns.items()}


def _plan_of(run, switch):
    """The last accepted plan of this very pulse that was published up to shortly after the command."""
    if not run.has("transition_plan"):
        return None
    plans = run.series["transition_plan"]
    fits = plans["accepted"] & (plans["time"] <= switch.start + 0.2)
    fits &= np.isclose(plans["throttle"], switch.throttle) & np.isclose(plans["duration"], switch.duration)
    rows = np.flatnonzero(fits)
    return {name: data[rows[-1]] for name, data in plans.items()} if len(rows) else None


def _name_of(switch):
    if switch.plan is not None:
        return "{}->{}".format(*(topics.MODE_NAMES.get(int(switch.plan[key]), "unknown")
                                 for key in ("start_mode", "target_mode")))
    if switch.true is not None and switch.true.start_mode in ("F", "Q"):
        return "F->Q" if switch.true.start_mode == "F" else "Q->F"
    return switch.name


def barrier_of(run):
    return float(run.latched["force_curve"]["barrier_travel"]) if "force_curve" in run.latched else math.nan


def _true_motion(run, switch):
    if not run.has("truth"):
        return None
    truth = run.series["truth"]
    rows = window(truth, switch.start, switch.until)
    if len(rows["time"]) < 2:
        return None
    motion = Motion()
    before = window(truth, switch.start - 0.5, switch.start)
    first = before["mode"][-1] if len(before["mode"]) else rows["mode"][0]
    motion.start_mode = topics.MODE_NAMES.get(int(first))
    last = rows["mode"][rows["time"] >= rows["time"][-1] - SETTLED_SECONDS]
    if rows["time"][-1] - switch.start > switch.duration + SETTLED_SECONDS:
        motion.end_mode = topics.MODE_NAMES.get(int(last[-1])) if len(set(last)) == 1 else "unknown"
    motion.peak_travel, motion.least_travel = rows["travel"].max(), rows["travel"].min()
    motion.end_travel, motion.end_speed = rows["travel"][-1], rows["speed"][-1]
    motion.peak_speed = np.abs(rows["speed"]).max()
    motion.snap_time = last_crossing(rows["time"], rows["travel"], barrier_of(run)) - switch.start
    return motion


def last_crossing(time, values, level):
    """Time of the last crossing of a level, linear between samples; NaN if there is none."""
    if math.isnan(level):
        return math.nan
    above = values > level
    steps = np.flatnonzero(above[1:] != above[:-1])
    if not len(steps):
        return math.nan
    k = steps[-1]
    share = (level - values[k]) / (values[k + 1] - values[k])
    return time[k] + share * (time[k + 1] - time[k])


def _estimate_seconds(run, switch):
    if not run.has("mode_state") or switch.target_mode is None:
        return math.nan
    rows = window(run.series["mode_state"], switch.start, switch.until)
    wrong = np.flatnonzero(rows["mode"] != topics.MODE_NUMBERS.get(switch.target_mode, 0))
    first = wrong[-1] + 1 if len(wrong) else 0
    return rows["time"][first] - switch.start if first < len(rows["time"]) else math.nan


def throttle_sent(link):
    """Throttle channel of every frame [us]."""
    channels = link["channels"]
    if channels.shape[1] <= topics.THROTTLE_CHANNEL:
        return np.full(len(link["time"]), np.nan)
    return channels[:, topics.THROTTLE_CHANNEL]


def aux1_sent(link):
    channels = link["channels"]
    return channels[:, topics.AUX1_CHANNEL] if channels.shape[1] > topics.AUX1_CHANNEL else \
        np.full(len(link["time"]), np.nan)


def _sent_pulse(run, switch):
    if not run.has("link_status"):
        return None
    rows = window(run.series["link_status"], switch.start, switch.until)
    sent = SentPulse()
    inside = np.flatnonzero((rows["bridge_state"] == 3) & (rows["pulse_id"] == switch.pulse_id))
    sent.frames = len(inside)
    if sent.frames:
        sent.first, sent.last = rows["time"][inside[0]], rows["time"][inside[-1]]
        sent.highest = np.nanmax(throttle_sent(rows)[inside])
        sent.period = float(np.median(np.diff(run.series["link_status"]["time"])))
    return sent


class LinkStatistics:
    """Numbers of the stream of frames."""

    def __init__(self):
        self.frames = 0                 # status messages seen, one per frame
        self.periods = np.array([])     # [s] between frames
        self.unseen = 0                 # frames the bridge counted that the record lacks
        self.late = 0                   # periods above the limit
        self.median = self.worst = self.worst_reported = math.nan
        self.accepted = self.refused = 0
        self.last_refusal = ""
        self.telemetry_worst = math.nan
        self.failsafe_seconds = 0.0
        self.faults = []
        self.restarts = 0               # the frame counter fell: the bridge was started anew


# docs/references.md: gaps must stay under 100 ms, or the flight controller reports a lost signal.
LATE_SECONDS = 0.1


def link_statistics(run):
    """Statistics of link_status, or None if nothing was recorded."""
    if not run.has("link_status"):
        return None
    link = run.series["link_status"]
    statistics = LinkStatistics()
    statistics.frames = len(link["time"])
    statistics.periods = np.diff(link["time"])
    steps = np.diff(link["frames_sent"])
    statistics.restarts = int(np.sum(steps < 0))
    statistics.unseen = int(np.sum(steps[steps > 1] - 1))
    if len(statistics.periods):
        statistics.median = float(np.median(statistics.periods))
        statistics.worst = float(statistics.periods.max())
        statistics.late = int(np.sum(statistics.periods > LATE_SECONDS))
    statistics.worst_reported = float(np.nanmax(link["period_worst"]))
    statistics.accepted, statistics.refused = int(link["commands_accepted"][-1]), int(link["commands_refused"][-1])
    statistics.last_refusal = str(link["last_refusal"][-1])
    ages = link["telemetry_age"][np.isfinite(link["telemetry_age"])]
    statistics.telemetry_worst = float(ages.max()) if len(ages) else math.nan
    statistics.failsafe_seconds = float(np.sum(statistics.periods[link["controller_failsafe"][:-1]]))
    statistics.faults = sorted({str(text) for text in link["bridge_fault"] if text})
    return statistics


def spans(time, flags):
    """Stretches (start, end) over which a flag holds."""
    found, start = [], None
    for moment, flag in zip(time, flags):
        if flag and start is None:
            start = moment
        elif not flag and start is not None:
            found.append((start, moment))
            start = None
    if start is not None:
        found.append((start, time[-1]))
    return found


class Verdict:
    """Did each expected switch happen? status: "happened", "did not happen", "not attempted", "not known"."""

    def __init__(self):
        self.status = {}
        self.switch = {}
        self.notes = []
        self.scenario_ok = None  # what the scenario says; None = no summary

    @property
    def all_happened(self):
        return all(status == "happened" for status in self.status.values())

    @property
    def good(self):
        """Both switches happened, and the scenario, if it left a summary, has no complaint."""
        return self.all_happened and self.scenario_ok is not False


def judge(run, switches, summary=None):
    """Verdict from the record; where the scenario's summary says otherwise, a note says so."""
    verdict = Verdict()
    verdict.scenario_ok = summary["ok"] if summary else None
    untold = any(switch.target_mode is None for switch in switches) or pulses_without_command(run)
    for name in EXPECTED:
        tries = [switch for switch in switches if switch.name == name]
        verdict.switch[name] = tries[-1] if tries else None
        verdict.status[name] = _status(run, tries, untold)
        claims = [entry for entry in (summary or {}).get("switches", []) if entry["name"] == name]
        claim = claims[-1] if claims else None
        if claim and verdict.status[name] != "not known" and claim["ok"] != (verdict.status[name] == "happened"):
            verdict.notes.append("{}: the scenario says {}, the record says: {}".format(
                name, "it succeeded" if claim["ok"] else "it failed", verdict.status[name]))
        if claim and claim["reason"]:
            verdict.notes.append("{}: the scenario says: {}".format(name, claim["reason"]))
    if summary and not summary["ok"]:
        verdict.notes.append("The scenario failed: {}".format(summary["reason"] or "no reason given"))
    return verdict


def pulses_without_command(run):
    """Does the record show a pulse, or both modes, without the command that belongs to it?"""
    known = set(run.series["command/pulse"]["id"]) if run.has("command/pulse") else set()
    if run.has("link_status"):
        link = run.series["link_status"]
        return bool(set(link["pulse_id"][link["bridge_state"] == 3]) - known)
    return not known and run.has("truth") and {1, 2} <= set(run.series["truth"]["mode"])


def _status(run, tries, untold):
    """`untold`: there are pulses of which the record does not tell the direction."""
    if tries:
        happened = tries[-1].happened
        return "not known" if happened is None else ("happened" if happened else "did not happen")
    return "not known" if untold or not run.has("link_status") and not run.has("truth") else "not attempted"


def comparison_rows(switch):
    """(quantity, unit, predicted, predicted at worst, happened) of one switch, in the unit shown; NaN or None = not
    known."""
    plan, true, sent = switch.plan, switch.true, switch.sent

    def predicted(which, key, factor=1.0):
        return float(plan[which + "_" + key]) * factor if plan is not None else math.nan

    def measured(key, factor=1.0):
        return getattr(true, key) * factor if true is not None else math.nan
    rows = []
    ends = [topics.MODE_NAMES.get(int(plan[which + "_end_mode"])) if plan is not None else None
            for which in ("nominal", "worst")]
    rows.append(("end mode", "", ends[0], ends[1], true.end_mode if true is not None else None))
    for label, unit, key, factor in (("snap time after the command", "ms", "snap_time", 1e3),
                                     ("largest travel", "mm", "peak_travel", 1e3),
                                     ("least travel", "mm", "least_travel", 1e3),
                                     ("travel at the end", "mm", "end_travel", 1e3)):
        rows.append((label, unit, predicted("nominal", key, factor), predicted("worst", key, factor),
                     measured(key, factor)))
    rows.append(("largest speed of the ring", "m/s", math.nan, math.nan, measured("peak_speed")))
    rows.append(("energy margin, in barriers", "1", predicted("nominal", "energy_margin"),
                 float(plan["worst_margin"]) if plan is not None else math.nan, math.nan))
    rows.append(("mode estimate reached the target", "ms", math.nan, math.nan, switch.estimate_seconds * 1e3))
    start, end = switch.motors
    rows.append(("delay of the pulse to the motors", "ms", math.nan, math.nan, (start - switch.start) * 1e3))
    rows.append(("pulse at the motors", "ms", switch.duration * 1e3, math.nan, (end - start) * 1e3))
    rows.append(("pulse on the wire", "ms", switch.whole * 1e3, math.nan,
                 sent.duration * 1e3 if sent is not None else math.nan))
    return rows
