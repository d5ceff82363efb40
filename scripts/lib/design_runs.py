"""Variations of an arm's design settings, and runs of them that are kept while their settings stay the same."""
import json
import os
import pathlib
import re
import subprocess

import h5py

ROOT = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
PROGRAM = os.path.join(os.environ.get("SNAPWING_BUILD", os.path.join(ROOT, "build")), "devel", "lib", "snapwing", "snapwing")


def settings_text(path):
    """The file's text with an absolute path of the vehicle, so that it can be read from any folder."""
    with open(path, encoding="utf-8") as stream:
        text = stream.read()
    folder = os.path.dirname(os.path.abspath(path))
    return replaced(text, r"^vehicle: (\S+)", lambda m: f"vehicle: {os.path.normpath(os.path.join(folder, m[1]))}")


def replaced(text, pattern, value):
    """`pattern` must occur once."""
    text, count = re.subn(pattern, value, text, flags=re.M | re.S)
    if count != 1:
        raise ValueError(f"{pattern} found {count} times in the settings")
    return text


def replaced_in(text, section, key, value):
    """The number of a key of this section; other sections may have a key of that name."""
    return replaced(text, rf"^({section}:[^\n]*\n(?:[ \n#][^\n]*\n|\n)*?  {key}: )\S+", rf"\g<1>{value}")


def report_of(program, folder, text, environment=None):
    """Report of `snapwing design arm` with these settings; goes on from a checkpoint of them, if there is one."""
    os.makedirs(folder, exist_ok=True)
    settings, path = os.path.join(folder, "settings.yaml"), os.path.join(folder, "report.json")
    same = False
    if os.path.exists(settings):
        with open(settings, encoding="utf-8") as stream:
            same = stream.read() == text
    if not same:
        for name in ("report.json", "checkpoint.h5"):
            if os.path.exists(os.path.join(folder, name)):
                os.remove(os.path.join(folder, name))
        with open(settings, "w", encoding="utf-8") as stream:
            stream.write(text)
    if not os.path.exists(path):
        done = subprocess.run([program, "design", "arm", settings, "-o", folder, "-q", "--resume"], check=False,
                              env=dict(os.environ, **(environment or {})), stdout=subprocess.DEVNULL)
        if done.returncode > 1:
            raise RuntimeError(f"{folder}: exit code {done.returncode}")
    with open(path, encoding="utf-8") as stream:
        return json.load(stream)


def numbers_of(folder):
    """All real numbers that a design leaves in HDF5 (the optimiser's state, the check's curves), as bytes by file and name."""
    found = {}
    for path in sorted(pathlib.Path(folder).glob("*.h5")):
        with h5py.File(path) as file:
            def add(key, item, name=path.name):
                if isinstance(item, h5py.Dataset) and item.dtype.kind == "f" and key != "history":  # that has seconds
                    found[f"{name}:{key}"] = item[()].tobytes()
            file.visititems(add)
    return found
