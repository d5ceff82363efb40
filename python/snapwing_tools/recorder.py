"""Collects messages of a run in memory and turns them into a Run. Knows no rospy: messages are read by attribute."""

import os
import platform
import threading
import time

import numpy as np

from snapwing_tools import topics
from snapwing_tools.clock_watch import ClockWatch
from snapwing_tools.run_file import Run, column_array, write_run


class RunBuffer:
    """Thread-safe store of messages. Times are seconds of one clock (ROS time); the origin is when recording began. When
    the clock jumps, the run's times go on as if it had not, and the attribute clock_jumps counts it."""

    def __init__(self, origin, provenance=None):
        self._lock = threading.Lock()
        self._origin = float(origin)
        self._clock = ClockWatch()
        self._provenance = dict(provenance or {})
        self._rows = {topic.name: [] for topic in topics.SERIES}
        self._latched = {}

    def add(self, topic, message, received, steady=None):
        """Adds one message of a recorded topic; `received` is the time of arrival [s], `steady` that of a clock which only
        goes on (time.monotonic() if not given)."""
        values = [topics.value_of(message, column.path) for column in topic.columns]
        values = [tuple(v) if c.kind == "array" else v for c, v in zip(topic.columns, values)]
        stamp = _seconds(message.header.stamp)
        # A message that nobody stamped is as old as its arrival.
        stamped = stamp if stamp > 0 else received
        with self._lock:
            self._clock.look(received, time.monotonic() if steady is None else steady)
            origin = self._origin + self._clock.gone
            if topic.name in self._rows:
                self._rows[topic.name].append((stamped - origin, received - origin, values))
            else:
                self._latched[topic.name] = values

    def counts(self):
        """Messages so far, by topic."""
        with self._lock:
            found = {name: len(rows) for name, rows in self._rows.items()}
            found.update({topic.name: int(topic.name in self._latched) for topic in topics.LATCHED})
        return found

    def to_run(self, ended):
        """Everything so far. `ended` says how the recording came to its end ("recording" = it has not)."""
        with self._lock:
            rows = {name: list(entries) for name, entries in self._rows.items()}
            latched = dict(self._latched)
        run = Run()
        run.attributes = dict(self._provenance, origin_unix=self._origin, ended=ended, clock_jumps=self._clock.jumps)
        for topic in topics.SERIES:
            run.series[topic.name] = _series(topic, rows[topic.name])
        for topic in topics.LATCHED:
            if topic.name in latched:
                run.latched[topic.name] = _single(topic, latched[topic.name])
        return run

    def save(self, path, ended):
        write_run(path, self.to_run(ended))


def _series(topic, entries):
    columns = {"time": np.array([entry[0] for entry in entries], dtype=float),
               "received": np.array([entry[1] for entry in entries], dtype=float)}
    for index, column in enumerate(topic.columns):
        columns[column.name] = column_array(column, [entry[2][index] for entry in entries])
    return columns


def _single(topic, values):
    columns = {}
    for column, value in zip(topic.columns, values):
        columns[column.name] = np.array(value, dtype=float) if column.kind == "array" else value
    return columns


def _seconds(stamp):
    """rospy.Time or a plain number -> seconds."""
    return stamp.to_sec() if hasattr(stamp, "to_sec") else float(stamp)


def machine_provenance(command):
    """Texts that say with what a run was recorded."""
    from snapwing_tools import provenance
    return {"recorder_command": command, "snapwing_version": provenance.package_version(),
            "python": platform.python_version(), "numpy": np.__version__, "system": platform.platform(),
            "ros_distro": os.environ.get("ROS_DISTRO", "")}
