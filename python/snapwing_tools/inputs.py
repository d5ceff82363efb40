"""Readers of what other parts of snapwing write: force tables, outcome maps, trajectories, summaries, vehicle files.

Every reader raises InputError with one line that names the file and what is wrong with it.
"""

import csv
import json
import math
import os
import re

import h5py
import numpy as np

from snapwing_tools import topics
from snapwing_tools.errors import InputError, not_opened
from snapwing_tools.yaml_file import load_yaml


class ForceTable:
    """Force-displacement table of one arm (see include/snapwing/vehicle/force_table.h). SI."""

    def __init__(self):
        self.path = ""
        self.arm_count = 1
        self.travel = self.force = self.energy = self.rotation = self.force_back = None
        self.stable = None
        self.rest = []   # closed loops (n, 2) at rest
        self.moved = []  # moved[k] = loops at travel[k]
        self.provenance = {}

    def shape_at(self, travel):
        """Loops of the arm's outline at a travel (linear between stored points, clamped to the table), and the travel
        that is shown."""
        if not self.moved:
            return [], math.nan
        shown = float(np.clip(travel, self.travel[0], self.travel[-1]))
        upper = int(np.clip(np.searchsorted(self.travel, shown), 1, len(self.travel) - 1))
        share = (shown - self.travel[upper - 1]) / (self.travel[upper] - self.travel[upper - 1])
        return [(1 - share) * low + share * high for low, high in zip(self.moved[upper - 1], self.moved[upper])], shown


def require_file(path):
    if not os.path.isfile(path):
        raise InputError("{}: no such file".format(path))
    if os.path.getsize(path) == 0:
        raise InputError("{}: the file is empty".format(path))


def read_force_table(path):
    require_file(path)
    try:
        with h5py.File(path, "r") as file:
            return _parse_table(path, file)
    except OSError as error:
        raise not_opened(path, error)


def _parse_table(path, file):
    table = ForceTable()
    table.path = path
    units = {"travel": "m", "force": "N", "energy": "J", "rotation": "rad", "force_back": "N", "stable": "1"}
    for name, unit in units.items():
        setattr(table, name, _table_array(path, file, name, unit))
    table.arm_count = int(_table_array(path, file, "arm_count", "1")[0])
    points = len(table.travel)
    if points < 2 or np.any(np.diff(table.travel) <= 0):
        raise InputError("{}: travel must have two points or more and increase".format(path))
    for name in ("force", "energy", "rotation", "stable"):
        if len(getattr(table, name)) != points:
            raise InputError("{}: {} and travel differ in length".format(path, name))
    sizes = _table_array(path, file, "shapes/loop_sizes", "1").astype(int)
    rest = _table_array(path, file, "shapes/rest", "m")
    moved = _table_array(path, file, "shapes/moved", "m")
    each = 2 * int(sizes.sum())
    if len(rest) != each or len(moved) not in (0, each * points):
        raise InputError("{}: the sizes of shapes/ do not fit together".format(path))
    table.rest = _loops(rest, sizes)
    table.moved = [_loops(part, sizes) for part in moved.reshape(points, each)] if len(moved) else []
    table.provenance = {key: _text(value) for key, value in file["provenance"].attrs.items()} \
        if "provenance" in file else {}
    return table


def _table_array(path, file, name, unit):
    if name not in file:
        raise InputError("{}: no force table, dataset {} is missing".format(path, name))
    found = _text(file[name].attrs.get("unit", ""))
    if found != unit:
        raise InputError("{}: {} is in '{}', expected '{}'".format(path, name, found, unit))
    return np.atleast_1d(file[name][()])


def _loops(flat, sizes):
    points = flat.reshape(-1, 2)
    return [part for part in np.split(points, np.cumsum(sizes)[:-1]) if len(part)]


def _text(value):
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def read_csv_rows(path):
    """(header, [(line number, fields)]) of a CSV file. Lines that are empty or start with # are comments. Every row has
    as many fields as the header: a decimal comma would add one."""
    require_file(path)
    with open(path, newline=None, encoding="utf-8-sig", errors="replace") as file:
        lines = [(number, line) for number, line in enumerate(file, 1)
                 if line.strip() and not line.lstrip().startswith("#")]
    parsed = csv.reader(line for _, line in lines)
    rows = [(number, [field.strip() for field in row]) for (number, _), row in zip(lines, parsed)]
    if not rows:
        raise InputError("{}: no rows".format(path))
    header = rows[0][1]
    if len(set(header)) < len(header):
        raise InputError("{}: a column's name is given twice in {}".format(path, ", ".join(header)))
    for number, row in rows[1:]:
        if len(row) != len(header):
            raise InputError("{}: line {} has {} fields; allowed: the {} of the header, with decimal points".format(
                path, number, len(row), len(header)))
    return header, rows[1:]


def read_table_csv(path, required):
    """CSV with a header row -> dict of float arrays. Extra columns are kept if they are numbers."""
    header, rows = read_csv_rows(path)
    absent = [name for name in required if name not in header]
    if absent:
        raise InputError("{}: column '{}' is missing; found {}".format(path, absent[0], ", ".join(header)))
    if not rows:
        raise InputError("{}: a header but no rows".format(path))
    columns = {}
    for index, name in enumerate(header):
        columns[name] = np.array([_cell(path, number, row, index, name, required) for number, row in rows])
    return columns


NUMBER = re.compile(r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?$|-?nan$|-?inf$")


def _cell(path, number, row, index, name, required):
    if NUMBER.match(row[index]):
        return float(row[index])
    if name in required:
        raise InputError("{}: line {}, column '{}': '{}' is not a number".format(path, number, name, row[index]))
    return math.nan


class OutcomeMap:
    """What pulses do: share[i, j] and margin[i, j] for throttle[i] and duration[j]; NaN where nothing was computed."""

    def __init__(self, throttle, duration, share, margin):
        self.throttle, self.duration, self.share, self.margin = throttle, duration, share, margin


MAP_COLUMNS = ("throttle", "duration_s", "share_switched", "worst_margin")


def read_outcome_map(path):
    columns = read_table_csv(path, MAP_COLUMNS)
    throttle, row = np.unique(columns["throttle"], return_inverse=True)
    duration, column = np.unique(columns["duration_s"], return_inverse=True)
    if len(throttle) < 2 or len(duration) < 2:
        raise InputError("{}: a map needs at least two throttles and two durations".format(path))
    outside = columns["share_switched"][(columns["share_switched"] < 0) | (columns["share_switched"] > 1)]
    if len(outside):
        raise InputError("{}: share_switched = {:g} is outside 0 .. 1".format(path, outside[0]))
    share = np.full((len(throttle), len(duration)), np.nan)
    margin = share.copy()
    share[row, column] = columns["share_switched"]
    margin[row, column] = columns["worst_margin"]
    return OutcomeMap(throttle, duration, share, margin)


def read_trajectory(path):
    """Predicted motion: time [s] after the command, travel [m], and what else the file has."""
    columns = read_table_csv(path, ("time_s", "travel_m"))
    if np.any(np.diff(columns["time_s"]) < 0):
        raise InputError("{}: time_s decreases".format(path))
    return columns


def _read_json(path):
    require_file(path)
    try:
        with open(path, encoding="utf-8") as file:
            return json.load(file)
    except (ValueError, UnicodeDecodeError) as error:
        raise InputError("{}: not JSON ({})".format(path, error))


def read_summary(path):
    """Outcome of the scenario (scenario_summary.write_result), reduced to what the report compares with the record:
    {"ok", "reason", "rung", "switches": [{"name": "F->Q", "ok", "reason"}]}."""
    found = _read_json(path)
    if not isinstance(found, dict) or not isinstance(found.get("switches"), list):
        raise InputError("{}: expected an object with a list 'switches'".format(path))
    if not isinstance(found.get("ok"), bool):
        raise InputError("{}: 'ok' must be true or false".format(path))
    switches, rung = [], ""
    for number, entry in enumerate(found["switches"]):
        if not isinstance(entry, dict) or any(entry.get(key) not in (1, 2) for key in ("start", "target")):
            raise InputError("{}: switches[{}] needs 'start' and 'target', each 1 (F) or 2 (Q)".format(path, number))
        name = "{}->{}".format(topics.MODE_NAMES[entry["start"]], topics.MODE_NAMES[entry["target"]])
        true = entry.get("happened") or {}
        modes = (true.get("start_mode"), true.get("end_mode"), entry.get("estimated_mode"))
        good = entry.get("code") == 0 and modes == (entry["start"], entry["target"], entry["target"])
        switches.append({"name": name, "ok": good, "reason": str(entry.get("message") or "") if not good else ""})
        rung = rung or str(entry.get("rung") or "")
    reason = found.get("trouble") or found.get("reason") or ""
    return {"ok": found["ok"], "reason": str(reason), "rung": rung, "switches": switches}


class Plan:
    """What `snapwing plan --json` adds to the record: what the margin hangs on, and accidents."""

    def __init__(self, throttle, duration, margin, influences, accidents):
        self.throttle, self.duration, self.margin = throttle, duration, margin
        self.influences = influences  # (name, margin at the low end, margin at the high end), largest effect first
        self.accidents = accidents    # dicts: name, explanation, mode, unit, limit, occurs, holds


def _number_or_nan(value):
    return math.nan if value is None else float(value)


def read_plan(path):
    found = _read_json(path)
    try:
        plan = found["plan"]
        influences = [(str(entry["name"]), _number_or_nan(entry["low_margin"]), _number_or_nan(entry["high_margin"]))
                      for entry in plan.get("influences", [])]
        accidents = [dict(entry, limit=_number_or_nan(entry["limit"]), occurs=_number_or_nan(entry["occurs"]))
                     for entry in found.get("accidents", [])]
        return Plan(float(plan["pulse"]["throttle"]), float(plan["pulse"]["duration"]),
                    _number_or_nan(plan["nominal"]["energy_margin"]), influences, accidents)
    except (KeyError, TypeError, ValueError) as error:
        raise InputError("{}: no plan of 'snapwing plan --json' ({})".format(path, error))


class Parameter:
    """One number of the vehicle file."""

    def __init__(self, name, value, unit, plus_minus, source):
        self.name, self.value, self.unit, self.plus_minus, self.source = name, value, unit, plus_minus, source


def read_vehicle(path):
    """(name, list of Parameter, plain settings by dotted key)."""
    require_file(path)
    tree = load_yaml(path)
    if not isinstance(tree, dict) or "name" not in tree:
        raise InputError("{}: no vehicle file, key 'name' is missing".format(path))
    parameters, settings = [], {}
    _walk(tree, "", parameters, settings)
    return str(tree["name"]), parameters, settings


def _walk(node, prefix, parameters, settings):
    for key, value in node.items():
        name = prefix + str(key)
        if isinstance(value, dict) and "value" in value:
            parameters.append(Parameter(name, value["value"], str(value.get("unit", "")), value.get("plus_minus", 0),
                                        str(value.get("source", ""))))
        elif isinstance(value, dict):
            _walk(value, name + ".", parameters, settings)
        else:
            settings[name] = value
