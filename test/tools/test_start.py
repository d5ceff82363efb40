"""How the program starts: what it loads, and what it hands over."""
import os
import shutil
import subprocess
import unittest

from command import BEAM, COARSE, PREDICT, PROGRAM, Case


class Start(Case):
    def test_a_prediction_loads_no_solver(self):
        """Linking BLAS at start takes longer than a prediction."""
        listed = subprocess.run([PROGRAM, *map(str, PREDICT)], env={**os.environ, "LD_TRACE_LOADED_OBJECTS": "1"},
                                capture_output=True, text=True, timeout=60).stdout
        self.assertIn("libsnapwing_rom.so", listed)
        for library in ("libsnapwing_solver.so", "libcholmod", "libopenblas"):
            self.assertNotIn(library, listed)

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
