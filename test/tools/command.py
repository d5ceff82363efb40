"""Runs the snapwing command line on small inputs."""
import os
import pathlib
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ["SNAPWING"]
VEHICLE = ROOT / "config" / "vehicles" / "arris_x220.yaml"
BEAM = (ROOT / "config" / "scenes" / "snap_beam.yaml").read_text()
COARSE = ("-q", "--kernel", "linear_reduced", "--cell-size", "8e-4")
PREDICT = ("predict", VEHICLE, "--from", "F", "--throttle", ".7", "--duration", ".16")
PLAN = ("plan", VEHICLE, "--from", "F", "--samples", "2", "--search-samples", "2")


class Case(unittest.TestCase):
    """A folder of its own for each test."""

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def file(self, name, text):
        path = self.folder / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    def snapwing(self, *words, code=0, **options):
        """The finished process; `code` is the exit code that it must have, or those that it may have."""
        options.setdefault("stdout", subprocess.PIPE)
        done = subprocess.run([PROGRAM, *map(os.fspath, words)], stderr=subprocess.PIPE, cwd=options.pop("cwd", self.folder),
                              timeout=300, **options)
        self.assertIn(done.returncode, code if isinstance(code, tuple) else (code,), done.stderr.decode(errors="replace"))
        return done

    def refusal(self, *words, **options):
        return self.snapwing(*words, code=2, **options).stderr.decode()
