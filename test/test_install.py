"""Installs the build into an empty folder and runs what landed there: usage: test_install.py BUILD_FOLDER."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

BUILD = sys.argv.pop() if len(sys.argv) > 1 else "build"
PROGRAMS = ["snapwing", "snapwing_all", "snapwing_predict", "radio_bridge", "standin_flight_controller"]
SHARED = ["config/vehicles/arris_x220.yaml", "data/tables/arris_x220_planar.h5", "lcm"]


class Install(unittest.TestCase):
    def test_what_is_installed_runs(self):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run(["cmake", "--install", BUILD], env={**os.environ, "DESTDIR": folder},
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            environment = {name: value for name, value in os.environ.items() if name != "LD_LIBRARY_PATH"}  # else the build's libraries run
            (binaries,) = pathlib.Path(folder).glob("**/lib*/snapwing/snapwing")
            for program in PROGRAMS:
                ran = subprocess.run([binaries.parent / program, "--help"], capture_output=True, text=True, env=environment)
                self.assertEqual(ran.returncode, 0, f"{program}: {ran.stderr}")
            (share,) = pathlib.Path(folder).glob("**/share/snapwing/config")
            for name in SHARED:
                self.assertTrue((share.parent / name).exists(), name)
            ran = subprocess.run([binaries, "predict", share / "vehicles/arris_x220.yaml", "--from", "F", "--throttle",
                                  "0.7", "--duration", "0.16"], capture_output=True, text=True, env=environment)
            self.assertEqual(ran.returncode, 0, ran.stderr)


if __name__ == "__main__":
    sys.exit(unittest.main())
