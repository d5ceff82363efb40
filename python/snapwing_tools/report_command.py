"""The command make_report: reads a run and what belongs to it, writes the HTML report, prints a summary."""

import argparse
import os
import shlex
import sys
import tempfile

from snapwing_tools import inputs as readers
from snapwing_tools import provenance, style
from snapwing_tools.analysis import EXPECTED
from snapwing_tools.command_line import CommandLine, find_program
from snapwing_tools.errors import InputError
from snapwing_tools.output_file import OutputFiles, printing, require_folder, write_file
from snapwing_tools.report import Inputs, Report, terminal_summary
from snapwing_tools.run_file import read_run

_START = {"F": "F->Q", "Q": "Q->F"}


def parser():
    made = argparse.ArgumentParser(
        prog="make_report", description="Makes a self-contained HTML report of a recorded run.",
        epilog="Exit code: 0 the report is written, 1 it is written and --require-success was given but not both "
               "switches are shown to have happened, 2 bad input.")
    made.add_argument("run", metavar="RUN.h5", help="recorded run (record_run)")
    made.add_argument("-o", "--output", default="report.html", help="report to write [report.html]")
    made.add_argument("--summary", metavar="JSON", help="run_summary.json of the scenario "
                      "[the file of that name beside RUN.h5, if there]")
    made.add_argument("--vehicle", metavar="YAML", help="vehicle file, for the table of its numbers and for --snapwing")
    made.add_argument("--other-vehicle", action="store_true", help="compare the run with another vehicle or table than "
                      "it was recorded with; without it they are refused")
    made.add_argument("--table", metavar="H5", help="force table, for the arm's shapes [arm.table_file of --vehicle]")
    made.add_argument("--map", nargs=2, action="append", default=[], metavar=("F|Q", "CSV"),
                      help="outcome map of the switches from F or Q (snapwing plan --map)")
    made.add_argument("--trajectory", nargs=2, action="append", default=[], metavar=("F|Q", "CSV"),
                      help="predicted trajectory of the pulse from F or Q (snapwing predict --csv)")
    made.add_argument("--snapwing", metavar="PROGRAM", help="snapwing command line: computes the maps and trajectories "
                      "that are not given; 'auto' looks for it in the sourced workspace; needs --vehicle")
    made.add_argument("--trial", default="", metavar="OPTIONS", help="options that the run's trial needs in "
                      "'snapwing plan' and 'snapwing predict', as one text, e.g. --trial='--mount boom'")
    made.add_argument("--map-size", type=int, default=21, metavar="N", help="pulses along each side of a map that "
                      "--snapwing computes, 2 .. 200 [21]")
    made.add_argument("--figures", metavar="FOLDER", help="also save each figure as PNG")
    made.add_argument("--require-success", action="store_true", help="exit with 1 unless both switches happened")
    return made


def main(arguments=None):
    options = parser().parse_args(arguments)
    try:
        check_outputs(options)
        given = sys.argv[1:] if arguments is None else arguments
        return printing(lambda: run(options, given), "make_report")
    except InputError as error:
        print("make_report: {}".format(error), file=sys.stderr)
        return 2


def check_outputs(options):
    """Before the work, which may take minutes."""
    given = [path for _, path in options.map + options.trajectory]
    files = OutputFiles([options.run, options.summary, options.vehicle, options.table, options.snapwing] + given)
    files.writes(options.output, "--output")
    if options.figures:
        require_folder(options.figures)


def run(options, arguments):
    with tempfile.TemporaryDirectory(prefix="snapwing_report_") as folder:
        report = Report(gather(options, folder))
    report.inputs.commands.append("make_report " + " ".join(shlex.quote(part) for part in arguments))
    figures = report.figures()
    if options.figures:
        save_figures(options.figures, figures)
    write_file(options.output, report.html(figures))
    print(terminal_summary(report, os.path.abspath(options.output)))
    return 1 if options.require_success and not report.verdict.good else 0


def gather(options, folder):
    """Reads all inputs; what was asked for by name must be right, what is only looked for may be absent."""
    made = Inputs(read_run(options.run))
    made.files.append(("run", options.run))
    beside = os.path.join(os.path.dirname(os.path.abspath(options.run)), "run_summary.json")
    summary = options.summary or (beside if os.path.isfile(beside) else None)
    if summary:
        made.summary = readers.read_summary(summary)
        made.files.append(("summary of the scenario", summary))
    if options.vehicle:
        made.vehicle = readers.read_vehicle(options.vehicle)
        made.files.append(("vehicle", options.vehicle))
        _same_vehicle(made, options)
    _gather_table(made, options)
    for start, path in options.map:
        name = _name(start, "--map")
        made.maps[name] = readers.read_outcome_map(path)
        made.files.append(("outcome map from " + start, path))
    for start, path in options.trajectory:
        name = _name(start, "--trajectory")
        made.trajectories[name] = readers.read_trajectory(path)
        made.files.append(("trajectory from " + start, path))
    _ask_command_line(made, options, folder)
    return made


def _same_vehicle(made, options):
    """The report's predictions are of the vehicle that was recorded: another file is refused, or noted if asked for."""
    recorded = made.run.attributes.get("vehicle_sha256")
    arm = made.run.latched.get("arm_geometry")
    name = made.vehicle[0]
    if arm is not None and arm["vehicle"] != name:
        found = "the run is of the vehicle '{}', and {} is of '{}'".format(arm["vehicle"], options.vehicle, name)
    elif recorded and recorded != provenance.sha256_of_file(options.vehicle):
        found = "the run was recorded with other contents of the vehicle file (sha256 {}) than {} has now".format(
            str(recorded)[:12], options.vehicle)
    else:
        return
    if not options.other_vehicle:
        raise InputError("{}: {}; give the file of the run ({}), or --other-vehicle to compare with another one".format(
            options.run, found, made.run.attributes.get("vehicle_file") or "its place was not recorded"))
    made.notes.append("Compared with another vehicle than the recorded one: {}.".format(found))


def _same_arm(made):
    """The table that the report draws must be of the recorded arm."""
    curve = made.run.latched.get("force_curve")
    noted = made.table.provenance.get("inputs_sha256")
    if curve is None or not curve["inputs_sha256"] or not noted or curve["inputs_sha256"] == noted:
        return ""
    return "the run was recorded with another force table (inputs' sha256 {}) than {} (sha256 {})".format(
        curve["inputs_sha256"][:12], made.table.path, noted[:12])


def _name(start, option):
    if start not in _START:
        raise InputError("{} {}: expected F or Q".format(option, start))
    return _START[start]


def _gather_table(made, options):
    path = options.table
    if not path and made.vehicle is not None:
        listed = made.vehicle[2].get("arm.table_file")
        if listed:
            path = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(options.vehicle)), str(listed)))
            if not os.path.isfile(path):
                made.notes.append("The vehicle's force table is not there, so the arm's shapes are not shown.")
                return
    if path:
        made.table = readers.read_force_table(path)
        made.files.append(("force table", path))
        found = _same_arm(made)
        if found and not options.other_vehicle:
            raise InputError("{}: {}; give the table of the run, or --other-vehicle to compare with another one".format(
                options.run, found))
        if found:
            made.notes.append("The arm's shapes are of another arm: {}.".format(found))
    else:
        made.notes.append("No force table was given (--table or --vehicle), so the arm's shapes are not shown.")


def _ask_command_line(made, options, folder):
    """Fills in maps and trajectories that were not given."""
    program_file = find_program() if options.snapwing == "auto" else options.snapwing
    if options.snapwing == "auto" and program_file is None:
        made.notes.append("The snapwing program was not found in the workspace (CMAKE_PREFIX_PATH).")
    if not program_file:
        for name in EXPECTED:
            if name not in made.maps:
                made.notes.append("{}: no outcome map (give --map or --snapwing).".format(name))
            if name not in made.trajectories:
                made.notes.append("{}: no predicted trajectory (give --trajectory or --snapwing).".format(name))
        return
    if not options.vehicle:
        raise InputError("--snapwing needs --vehicle")
    if not 2 <= options.map_size <= 200:
        raise InputError("--map-size {}: expected 2 .. 200".format(options.map_size))
    program = CommandLine(program_file, options.vehicle, shlex.split(options.trial) + (
        ["--table", options.table] if options.table else []))
    pulses = {switch.name: switch for switch in Report(made).switches}
    for name in EXPECTED:
        stem = os.path.join(folder, name.replace("->", "_"))
        if name not in made.maps:
            failure = program.plan(name, options.map_size, stem + "_map.csv", stem + "_plan.json")
            _try(made, name, "outcome map", failure, made.maps, lambda: readers.read_outcome_map(stem + "_map.csv"))
            _try(made, name, "list of influences", failure, made.plans, lambda: readers.read_plan(stem + "_plan.json"))
        if name not in made.trajectories and name in pulses:
            failure = program.trajectory(name, pulses[name], stem + "_motion.csv")
            _try(made, name, "predicted trajectory", failure, made.trajectories,
                 lambda: readers.read_trajectory(stem + "_motion.csv"))
    made.commands += [text.replace(folder + os.sep, "") for text in program.commands]


def _try(made, name, what, failure, place, read):
    """Takes a result of the command line into place[name], or notes why there is none."""
    if failure is None:
        try:
            place[name] = read()
            return
        except InputError as error:
            failure = str(error)
    made.notes.append("{}: no {}: {}.".format(name, what, failure))


def save_figures(folder, figures):
    try:
        os.makedirs(folder, exist_ok=True)
    except OSError as error:
        raise InputError("cannot write figures to {}: {}".format(folder, error.strerror))
    for name, _, _, fig in figures:
        write_file(os.path.join(folder, name + ".png"), style.png_bytes(fig))
