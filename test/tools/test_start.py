"""How the program starts: what it loads, and what it hands over."""
import os
import re
import shutil
import subprocess
import unittest

from command import BEAM, COARSE, PLAN, PREDICT, PROGRAM, Case


class Start(Case):
    def loaded(self, *words):
        """Names of the libraries that a command starts."""
        told = subprocess.run([PROGRAM, *map(str, words)], env={**os.environ, "LD_DEBUG": "files"}, capture_output=True, text=True, timeout=60)
        self.assertEqual(told.returncode, 0)
        return {os.path.basename(line.split()[-1]).split(".so")[0] for line in told.stderr.splitlines() if "calling init:" in line}

    def test_predictions_and_plans_load_no_solver_and_no_network(self):
        """Linking BLAS at start takes longer than a prediction, and half as long what HDF5's shared library needs to read from S3."""
        for words in (PREDICT, PLAN):
            found = self.loaded(*words)
            self.assertIn("libyaml-cpp", found)
            self.assertEqual({name for name in found if "snapwing" in name}, set())
            self.assertEqual(found & {"libcholmod", "libopenblas"}, set())
            shared = os.environ["SNAPWING_HDF5_ARCHIVE"] != "1"
            self.assertEqual([name in found for name in ("libhdf5_serial", "libcurl", "libcrypto")], [shared] * 3)

    def test_the_version_loads_no_hdf5(self):
        found = self.loaded("--version")
        self.assertIn("libstdc++", found)
        self.assertEqual({name for name in found if "snapwing" in name or "hdf5" in name or "curl" in name}, set())
        self.assertEqual(self.snapwing("--version").stdout, subprocess.run([PROGRAM + "_all", "--version"], capture_output=True, timeout=60).stdout)

    def test_without_their_program_predictions_and_plans_are_handed_over(self):
        alone = shutil.copy(PROGRAM, self.folder / "snapwing")
        (self.folder / "snapwing_all").symlink_to(PROGRAM + "_all")
        for words in (PREDICT, (*PLAN, "--json", self.folder / "plan.json")):
            done = subprocess.run([alone, *map(str, words)], capture_output=True, timeout=60)
            told = self.snapwing(*words).stdout
            self.assertEqual((done.returncode, self.timeless(done.stdout)), (0, self.timeless(told)))

    @staticmethod
    def timeless(text):
        return re.sub(rb" in [0-9.]+ s", b"", text)

    def test_all_other_commands_are_handed_over(self):
        for command in ("curve", "design", "predict", "plan", "trial", "validate", "vehicle"):
            self.assertIn(f"\n  {command} ", self.snapwing("--help").stdout.decode())
        self.assertIn("usage: ", self.snapwing("curve", "--help").stdout.decode().lower())
        for words in ([], ["nonsense"]):
            self.assertIn("subcommand", self.refusal(*words))

    def test_the_other_program_is_named_where_it_is_missing(self):
        alone = shutil.copy(PROGRAM, self.folder / "snapwing")
        done = subprocess.run([alone, "curve", self.file("scene.yaml", BEAM), *COARSE], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 3)
        self.assertIn(f"cannot run {self.folder.resolve()}/snapwing_all", done.stderr)
        self.assertIn("No such file", done.stderr)


if __name__ == "__main__":
    unittest.main()
