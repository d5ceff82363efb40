"""Scripts that run many designs: their settings are those of the default but for what they say, and their program is there."""
import importlib.machinery
import importlib.util
import os
import pathlib
import re
import sys
import tempfile
import unittest

import h5py
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "scripts" / "lib"), str(ROOT / "python")]
import design_runs  # noqa: E402


def script(name):
    loader = importlib.machinery.SourceFileLoader(name, str(ROOT / "scripts" / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module


def changed(text, other):
    """Keys of the lines in which two texts differ."""
    return [line.split(":")[0].strip() for line, then in zip(text.splitlines(), other.splitlines()) if line != then]


class DesignRuns(unittest.TestCase):
    base = design_runs.settings_text(ROOT / "config" / "designs" / "arm_default.yaml")

    def test_the_front_varies_the_bounds_and_not_the_targets(self):
        text = script("pareto_arm").variation(1.15, 0.4, 0.475)
        self.assertEqual(len(text.splitlines()), len(self.base.splitlines()))
        self.assertEqual(changed(self.base, text), ["bound", "peak_force", "peak_share_least", "valley_force", "printing_error", "quadratic_cell_sizes"])
        for line in ("  bound: 0.4750", "  peak_force: 1.1500", "  valley_force: 0.4000"):
            self.assertEqual(len(re.findall(f"^{re.escape(line)}", text, re.MULTILINE)), 1, line)

    def test_relatives_vary_the_start(self):
        self.assertEqual(changed(self.base, script("relatives_arm").variation(ROOT / "config/designs/arm_default.yaml", 1e-6)), ["start"])

    def test_a_key_is_replaced_in_its_section_alone(self):
        text = "a:\n  k: 1\n\n  l: 2  # two\nb:\n# of b\n  k: 3\n"
        self.assertEqual(design_runs.replaced_in(text, "b", "k", "4"), text.replace("k: 3", "k: 4"))
        self.assertEqual(design_runs.replaced_in(text, "a", "l", "5"), text.replace("l: 2", "l: 5"))
        self.assertRaises(ValueError, design_runs.replaced_in, text, "b", "l", "5")

    def test_numbers_differ_by_their_last_bit(self):
        def left(value, seconds):
            with tempfile.TemporaryDirectory() as folder:
                with h5py.File(pathlib.Path(folder) / "state.h5", "w") as file:
                    file["x"], file["history"], file["count"] = [1.0, value], [seconds], [3]
                return design_runs.numbers_of(folder)
        self.assertEqual(list(left(2.0, 1.0)), ["state.h5:x"])
        self.assertEqual(left(2.0, 1.0), left(2.0, 5.0))
        self.assertNotEqual(left(2.0, 1.0), left(np.nextafter(2.0, 3.0), 1.0))

    def test_the_program_is_where_the_build_puts_it(self):
        self.assertEqual(os.path.basename(design_runs.PROGRAM), "snapwing")
        for folder in ("scripts", "bench"):
            for path in (ROOT / folder).iterdir():
                if path.is_file() and path.suffix in ("", ".py"):
                    self.assertNotRegex(path.read_text(encoding="utf-8"), r'src/tools/snapwing|"tools", "snapwing"', path)


if __name__ == "__main__":
    unittest.main()
