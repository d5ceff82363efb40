"""The file of a recorded run: HDF5, one group per topic, units on every dataset, provenance on the root.

Layout (format "snapwing_run", version 1)
  /                     attributes: format, format_version, origin_unix [s], ended, and free provenance texts
  /<topic>/time         [s] since the origin, by the message's stamp; `received` likewise, by the recorder's clock
  /<topic>/<column>     one entry per message; arrays are (messages x longest), padded with NaN
  /force_curve, /arm_geometry   the last message
A file is replaced in one step, so that a reader never sees half of one.
"""

import io
import os

import h5py
import numpy as np

from snapwing_tools import topics
from snapwing_tools.errors import InputError, not_opened
from snapwing_tools.output_file import write_file

FORMAT = "snapwing_run"
FORMAT_VERSION = 2


class Run:
    """A run in memory: `series[topic][column]` and `latched[topic][column]` are numpy arrays or plain values."""

    def __init__(self):
        self.path = ""
        self.attributes = {}
        self.series = {}
        self.latched = {}

    def has(self, topic):
        """Is there at least one message of this topic?"""
        if topic in self.latched:
            return True
        return topic in self.series and len(self.series[topic]["time"]) > 0

    @property
    def origin(self):
        return float(self.attributes["origin_unix"])

    def missing_topics(self):
        return [topic for topic in topics.SERIES + topics.LATCHED if not self.has(topic.name)]


def pad_rows(rows):
    """Rows of varying length -> (rows x longest) array padded with NaN."""
    width = max((len(row) for row in rows), default=0)
    padded = np.full((len(rows), width), np.nan)
    for index, row in enumerate(rows):
        padded[index, :len(row)] = row
    return padded


def column_array(column, values):
    """List of values of one column -> array as stored."""
    if column.kind == "array":
        return pad_rows(values)
    if column.kind == "text":
        return np.array([str(value) for value in values], dtype=object)
    return np.array(values, dtype={"float": float, "int": np.int64, "bool": bool}[column.kind])


def write_run(path, run):
    """Writes a run whole or not at all: HDF5 makes it in memory. Raises InputError if the place cannot be written."""
    stream = io.BytesIO()
    try:
        with h5py.File(stream, "w") as file:
            _fill(file, run)
    except OSError as error:
        raise InputError("cannot write {}: {}".format(path, error))
    write_file(path, stream.getvalue())


def _fill(file, run):
    file.attrs["format"] = FORMAT
    file.attrs["format_version"] = FORMAT_VERSION
    for key, value in run.attributes.items():
        file.attrs[key] = value
    for topic in topics.SERIES:
        columns = run.series.get(topic.name)
        if columns is None:
            continue
        group = file.create_group(topics.group_name(topic.name))
        group.attrs["topic"] = topic.name
        group.attrs["message"] = topic.message
        for name in ("time", "received"):
            _dataset(group, name, columns[name], "s", "since the origin")
        for column in topic.columns:
            _dataset(group, column.name, columns[column.name], column.unit, column.meaning)
    for topic in topics.LATCHED:
        columns = run.latched.get(topic.name)
        if columns is None:
            continue
        group = file.create_group(topics.group_name(topic.name))
        group.attrs["topic"] = topic.name
        group.attrs["message"] = topic.message
        for column in topic.columns:
            _dataset(group, column.name, columns[column.name], column.unit, column.meaning)


def _dataset(group, name, data, unit, meaning):
    if isinstance(data, str) or (isinstance(data, np.ndarray) and data.dtype == object):
        dataset = group.create_dataset(name, data=data, dtype=h5py.string_dtype())
    else:
        dataset = group.create_dataset(name, data=data)
    dataset.attrs["unit"] = unit
    if meaning:
        dataset.attrs["meaning"] = meaning


def read_run(path):
    """Reads a run. Raises InputError (one line) if the file is missing, empty, foreign or inconsistent."""
    if not os.path.isfile(path):
        raise InputError("{}: no such file".format(path))
    if os.path.getsize(path) == 0:
        raise InputError("{}: the file is empty".format(path))
    try:
        with h5py.File(path, "r") as file:
            return _parse(path, file)
    except OSError as error:
        raise not_opened(path, error)


def _parse(path, file):
    if _text(file.attrs.get("format", "")) != FORMAT:
        raise InputError("{}: no recorded run (format attribute is not '{}')".format(path, FORMAT))
    version = int(file.attrs.get("format_version", 0))
    if version != FORMAT_VERSION:
        raise InputError("{}: format version {}, this program reads {}".format(path, version, FORMAT_VERSION))
    if "origin_unix" not in file.attrs:
        raise InputError("{}: attribute origin_unix is missing".format(path))
    run = Run()
    run.path = path
    run.attributes = {key: _text(value) for key, value in file.attrs.items()}
    for topic in topics.SERIES:
        if topics.group_name(topic.name) in file:
            run.series[topic.name] = _parse_series(path, file[topics.group_name(topic.name)], topic)
    for topic in topics.LATCHED:
        if topics.group_name(topic.name) in file:
            group = file[topics.group_name(topic.name)]
            run.latched[topic.name] = {c.name: _read(path, group, c.name, c.unit) for c in topic.columns}
    return run


def _parse_series(path, group, topic):
    columns = {name: _read(path, group, name, "s") for name in ("time", "received")}
    count = len(columns["time"])
    for column in topic.columns:
        data = _read(path, group, column.name, column.unit)
        if len(data) != count:
            raise InputError("{}: {}/{} has {} rows, time has {}".format(path, group.name, column.name, len(data),
                                                                         count))
        columns[column.name] = data
    order = np.argsort(columns["time"], kind="stable")
    return {name: data[order] for name, data in columns.items()}


def _read(path, group, name, unit):
    if name not in group:
        raise InputError("{}: dataset {}/{} is missing".format(path, group.name, name))
    dataset = group[name]
    found = _text(dataset.attrs.get("unit", ""))
    if found != unit:
        raise InputError("{}: {}/{} has unit '{}', expected '{}'".format(path, group.name, name, found, unit))
    if h5py.check_string_dtype(dataset.dtype):
        return dataset.asstr()[()]
    return dataset[()]


def _text(value):
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    return value
