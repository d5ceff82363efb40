"""What a scenario found, put side by side: plan, prediction, truth, estimate. Plain data; knows no rospy."""

import json
import math
from dataclasses import asdict, dataclass, field
from typing import List, Optional

from snapwing_tools.output_file import write_file

MODE_NAMES = {0: "unknown", 1: "F", 2: "Q"}
NAN = float("nan")


@dataclass
class TruthSample:
    """One sample of the simulated vehicle's true state."""

    time: float  # [s]
    mode: int
    travel: float  # u [m]
    speed: float = 0.0  # [m/s] of the ring
    thrust: float = 0.0  # [N]


@dataclass
class Happened:
    """What the vehicle truly did after a command."""

    start_mode: int = 0
    end_mode: int = 0
    snap_time: float = NAN  # [s] after the command, last crossing of the barrier; NaN = none
    peak_travel: float = NAN  # [m]
    least_travel: float = NAN  # [m]
    peak_speed: float = NAN  # [m/s]


@dataclass
class Switch:
    """One switch: asked for, planned, predicted, seen."""

    start: int
    target: int
    code: Optional[int] = None  # of the action's result; None = never answered
    message: str = ""
    throttle: float = NAN  # [1]
    duration: float = NAN  # [s]
    worst_margin: float = NAN  # [barriers]
    share: float = NAN  # [1]
    realisations: int = 0
    plan_seconds: float = NAN
    rung: str = ""
    predicted_mode: int = 0
    predicted_snap_time: float = NAN  # [s]
    predicted_peak: float = NAN  # [m]
    predicted_least: float = NAN  # [m]
    predicted_margin: float = NAN  # [barriers]
    happened: Happened = field(default_factory=Happened)
    estimated_mode: int = 0
    estimated_probability: float = NAN
    estimated_seconds: float = NAN  # [s] command -> estimate reached the target

    def trouble(self):
        """Why this switch does not count; empty if it truly happened and the estimate says so, too."""
        if self.code is None:
            return "the action never answered"
        if self.code != 0:
            return self.message or f"result code {self.code}"
        if self.happened.start_mode != self.start:
            return f"the vehicle truly was in {MODE_NAMES[self.happened.start_mode]} before the pulse"
        if self.happened.end_mode != self.target:
            return f"the vehicle truly is in {MODE_NAMES[self.happened.end_mode]}"
        if self.estimated_mode != self.target:
            return f"the estimate says {MODE_NAMES[self.estimated_mode]}"
        return ""


@dataclass
class Outcome:
    """A whole scenario."""

    vehicle: str = ""
    curve_rung: str = ""
    switches: List[Switch] = field(default_factory=list)
    reason: str = ""  # why the scenario ended early; empty if it ran to its end
    expected_switches: int = 2

    def trouble(self):
        """Why the scenario failed; empty if all switches happened."""
        if self.reason:
            return self.reason
        for switch in self.switches:
            if switch.trouble():
                return f"{arrow(switch)}: {switch.trouble()}"
        if len(self.switches) < self.expected_switches:
            return f"only {len(self.switches)} of {self.expected_switches} switches were tried"
        return ""


def arrow(switch):
    return f"{MODE_NAMES[switch.start]} -> {MODE_NAMES[switch.target]}"


def happened(samples, barrier, command_time):
    """What `samples` (TruthSample, in order of time) show from command_time [s] on. barrier: u [m]."""
    seen = [sample for sample in samples if sample.time >= command_time]
    if not seen:
        return Happened()
    result = Happened(
        start_mode=seen[0].mode,
        end_mode=seen[-1].mode,
        peak_travel=max(sample.travel for sample in seen),
        least_travel=min(sample.travel for sample in seen),
        peak_speed=max(abs(sample.speed) for sample in seen),
    )
    for before, after in zip(seen, seen[1:]):
        if (before.travel < barrier) != (after.travel < barrier):
            share = (barrier - before.travel) / (after.travel - before.travel)
            result.snap_time = before.time + share * (after.time - before.time) - command_time
    return result


def _number(value, pattern, scale=1.0):
    return "-" if value is None or math.isnan(value) else pattern.format(value * scale)


def _rows(switch):
    truth = switch.happened
    return [
        ("pulse: throttle", _number(switch.throttle, "{:.1f} %", 100)),
        ("pulse: duration", _number(switch.duration, "{:.3f} s")),
        ("plan: worst margin", _number(switch.worst_margin, "{:.2f} barriers")),
        ("plan: share that switches", f"{_number(switch.share, '{:.1f} %', 100)} of {switch.realisations}"),
        ("plan: computed in", _number(switch.plan_seconds, "{:.2f} s")),
        (None, None),
        ("rung of the prediction", switch.rung or "-"),
        ("end mode: predicted", MODE_NAMES[switch.predicted_mode]),
        ("end mode: true", MODE_NAMES[truth.end_mode]),
        ("end mode: estimated", f"{MODE_NAMES[switch.estimated_mode]} ({_number(switch.estimated_probability, '{:.0f} %', 100)})"),
        ("snap time: predicted", _number(switch.predicted_snap_time, "{:.3f} s")),
        ("snap time: true", _number(truth.snap_time, "{:.3f} s")),
        ("target reached in estimate", _number(switch.estimated_seconds, "{:.3f} s")),
        ("largest travel: predicted", _number(switch.predicted_peak, "{:.1f} mm", 1000)),
        ("largest travel: true", _number(truth.peak_travel, "{:.1f} mm", 1000)),
        ("least travel: predicted", _number(switch.predicted_least, "{:.1f} mm", 1000)),
        ("least travel: true", _number(truth.least_travel, "{:.1f} mm", 1000)),
        ("energy margin: predicted", _number(switch.predicted_margin, "{:.2f} barriers")),
        ("largest speed: true", _number(truth.peak_speed, "{:.1f} m/s")),
        (None, None),
        ("verdict", "FAILED" if switch.trouble() else "switched"),
    ]


def table(outcome):
    """The summary as text: one row a quantity, one column a switch."""
    first = 28
    columns = [_rows(switch) for switch in outcome.switches]
    width = max([20] + [len(value) + 2 for rows in columns for _, value in rows if value])
    line = "-" * (first + width * len(columns))
    text = [f"vehicle {outcome.vehicle}; force curve from: {outcome.curve_rung}", line]
    if columns:
        text.append("".ljust(first) + "".join(arrow(switch).ljust(width) for switch in outcome.switches))
        text.append(line)
        for row in zip(*columns):
            name = row[0][0]
            text.append(line if name is None else name.ljust(first) + "".join(value.ljust(width) for _, value in row))
    text.append(line)
    trouble = outcome.trouble()
    text.append(f"FAILED: {trouble}" if trouble else "Both switches happened, in truth and in the estimate.")
    return "\n".join(entry.rstrip() for entry in text)


def _without_nan(value):
    if isinstance(value, dict):
        return {key: _without_nan(entry) for key, entry in value.items()}
    if isinstance(value, list):
        return [_without_nan(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def write_result(outcome, path):
    """JSON with everything in the outcome, and `ok` and `reason` of the whole and of each switch; replaces the file in
    one step. NaN becomes null."""
    content = _without_nan(asdict(outcome))
    content.update(ok=not outcome.trouble(), reason=outcome.trouble(),
                   rung=next((switch.rung for switch in outcome.switches if switch.rung), ""))
    for entry, switch in zip(content["switches"], outcome.switches):
        entry.update(name=arrow(switch).replace(" ", ""), ok=not switch.trouble(), reason=switch.trouble())
    write_file(path, json.dumps(content, indent=2))
