"""Builds examples/cpp against what is installed, as a stranger would, and runs it: usage: test_examples.py BUILD_FOLDER."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

BUILD = sys.argv.pop() if len(sys.argv) > 1 else "build"
EXAMPLES = pathlib.Path(__file__).resolve().parent.parent / "examples/cpp"
# (program, arguments, those with a slash below the installed share folder, words of its output)
RUNS = [
    ("trace_scene", ["config/scenes/snap_beam.yaml"], "control,force_N,stable"),
    ("own_term", ["config/scenes/cook_membrane.yaml", "5", "2"], "control,force_N,with_spring_N"),
    ("predict_snap", ["config/vehicles/arris_x220.yaml", "0.7", "0.16"], "switches, snap at"),
    ("plan_pulse", ["config/vehicles/arris_x220.yaml", "F"], "throttle"),
]


# Runs what follows with nothing at the place of the source tree (and of a build folder in it), in a mount namespace of its own.
HIDING = ["unshare", "--map-root-user", "--mount", "sh", "-c", 'mount -t tmpfs none "$0" && exec "$@"', EXAMPLES.parent.parent]


def hiding():
    """@return words to put before a command, none where this system allows no namespaces"""
    seen = subprocess.run([str(word) for word in (*HIDING, "ls", EXAMPLES.parent.parent)], capture_output=True, text=True)
    if seen.returncode == 0 and seen.stdout == "":
        return HIDING
    print(f"the source tree stays in sight: {seen.stderr.strip()}", file=sys.stderr)
    return []


def run(*command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **options)
    assert done.returncode == 0, f"{command}: {done.stdout[-2000:]} {done.stderr[-2000:]}"
    return done.stdout


class Examples(unittest.TestCase):
    def test_a_stranger_builds_and_runs_them(self):
        with tempfile.TemporaryDirectory() as folder:
            prefix, source, build = (pathlib.Path(folder) / name for name in ("prefix", "source", "build"))
            run("cmake", "--install", BUILD, "--prefix", prefix)
            shutil.copytree(EXAMPLES, source)
            for script in prefix.glob("**/*.cmake"):
                self.assertNotIn(str(EXAMPLES.parent.parent), script.read_text(), script)
            hidden = hiding()
            environment = {name: value for name, value in os.environ.items() if name not in ("CMAKE_PREFIX_PATH", "LD_LIBRARY_PATH")}
            run(*hidden, "cmake", "-S", source, "-B", build, f"-DCMAKE_PREFIX_PATH={prefix}", "-DPYTHON_EXECUTABLE=/usr/bin/python3",
                env=environment, cwd=folder)
            run(*hidden, "cmake", "--build", build, "-j2", env=environment, cwd=folder)
            (share,) = prefix.glob("**/share/snapwing/config")
            for program, arguments, words in RUNS:
                given = [share.parent / word if "/" in word else word for word in arguments]
                self.assertIn(words, run(*hidden, build / program, *given, env=environment, cwd=folder), program)
            self.design([*hidden, build / "design_mechanism"], share, environment)

    def design(self, program, share, environment):
        """The shipped design on coarse cells, stopped after three iterations: not feasible yet, and it says so."""
        text = (share / "designs/arm_default.yaml").read_text()
        stages = re.search(r"(?m)^stages:.*\n(?:  - .*\n)+", text).group()
        settings = share / "designs/short.yaml"
        settings.write_text(text.replace(stages, "stages:\n  - {rung: planar, cell_size: 0.004, iterations: 3, move: 0.05}\n"))
        density = share / "density.csv"
        done = subprocess.run([str(word) for word in (*program, settings, density)], capture_output=True, text=True, env=environment, cwd=share)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertRegex(done.stdout, r"m: -?[0-9.e-]+ N")
        self.assertEqual(done.stderr.count("stage "), 3, done.stderr)
        self.assertGreater(len(density.read_text().splitlines()), 50)


if __name__ == "__main__":
    sys.exit(unittest.main())
