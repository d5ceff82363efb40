"""Asks the snapwing command line for what a report shows beside the record: outcome maps, what the margins hang on,
and predicted trajectories."""

import os
import shlex
import subprocess

from snapwing_tools.errors import InputError

TIMEOUT_SECONDS = 300


def find_program():
    """The snapwing program of the sourced workspace, or None."""
    for prefix in os.environ.get("CMAKE_PREFIX_PATH", "").split(os.pathsep):
        program = os.path.join(prefix, "lib", "snapwing", "snapwing")
        if prefix and os.access(program, os.X_OK):
            return program
    return None


class CommandLine:
    """Runs one snapwing program and remembers the command lines."""

    def __init__(self, program, vehicle, options=()):
        """`options` describe the trial and go into every call."""
        if not (os.path.isfile(program) and os.access(program, os.X_OK)):
            raise InputError("{}: not a program that can be run".format(program))
        self.program, self.vehicle, self.options = program, vehicle, list(options)
        self.commands = []

    def plan(self, name, map_size, map_output, json_output):
        """Outcome map and plan of a switch ("F->Q"). Returns None, or why it could not be had."""
        return self._run(["plan", self.vehicle, "--from", name[0], "--map", map_output, "--map-size", str(map_size),
                          "--json", json_output, "--accidents"], map_output)

    def trajectory(self, name, switch, output):
        """Predicted nominal trajectory of a switch's pulse into a CSV file. Returns None, or why it could not be had."""
        values = {"--throttle": switch.throttle, "--duration": switch.duration}
        if switch.hold[1] > 0:
            values.update({"--hold-throttle": switch.hold[0], "--hold-duration": switch.hold[1]})
        numbers = [text for option, value in values.items() for text in (option, "{:.17g}".format(value))]
        return self._run(["predict", self.vehicle, "--from", name[0], *numbers, "--csv", output], output)

    def _run(self, arguments, output):
        command = [self.program] + arguments + self.options
        self.commands.append(" ".join(shlex.quote(part) for part in command))
        try:
            done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=TIMEOUT_SECONDS,
                                  universal_newlines=True)
        except (OSError, subprocess.TimeoutExpired) as error:
            return str(error)
        # 1 is a negative answer (refused, not switched); the file is there all the same.
        if done.returncode in (0, 1) and os.path.isfile(output) and os.path.getsize(output):
            return None
        text = done.stdout.strip().splitlines()
        return "'snapwing {}' ended with {}{}".format(arguments[0], done.returncode, ": " + text[-1] if text else "")
