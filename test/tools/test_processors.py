"""A design has the same bytes on every processor. Others are played by the choices that libraries make at run time."""
import os
import pathlib
import platform
import re
import subprocess
import sys
import unittest

from command import PROGRAM, ROOT, Case

sys.path.insert(0, str(ROOT / "scripts" / "lib"))
from design_runs import numbers_of  # noqa: E402

SETTINGS = (ROOT / "config" / "designs" / "arm_default.yaml").read_text()
OTHERS = {
    "BLAS without AVX": {"OPENBLAS_CORETYPE": "Prescott"},
    "BLAS with AVX2": {"OPENBLAS_CORETYPE": "Haswell"},
    # Names of glibc 2.33 and later; older ones, and other C libraries, ignore them.
    "C library without FMA": {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX,-AVX2,-FMA,-FMA4,-AVX512F"},
}


class Processors(Case):
    def results(self, name, settings, environment):
        """All numbers of the optimiser's state and of the check's curves, to the last bit."""
        folder = self.folder / name.replace(" ", "_")
        self.snapwing("design", "arm", settings, "-o", folder, "-q", "--threads", "1", code=(0, 1),
                      env={**os.environ, **environment})
        return numbers_of(folder)

    @unittest.skipUnless(platform.machine() == "x86_64", "instructions of x86-64")
    def test_no_function_fuses_multiply_and_add(self):
        """Code for AVX-512 would else have other last digits than that for AVX2, which has no such instruction."""
        listed = subprocess.run([PROGRAM + "_all"], env={**os.environ, "LD_TRACE_LOADED_OBJECTS": "1"}, capture_output=True, text=True, timeout=60)
        libraries = re.findall(r"=> (\S*libsnapwing_\S*\.so)", listed.stdout)
        self.assertTrue({"libsnapwing_solver.so", "libsnapwing_mpm.so", "libsnapwing_elasticity.so"} <= {pathlib.Path(path).name for path in libraries})
        for library in libraries:
            code = subprocess.run(["objdump", "-d", "--no-show-raw-insn", library], capture_output=True, text=True, timeout=120, check=True).stdout
            self.assertIn("ret", code)
            self.assertEqual(re.findall(r"\bvfn?m(?:add|sub)\w*", code), [], library)

    def short(self):
        """The default's settings in few iterations and with a coarse check, with all that the path of a design computes."""
        text = SETTINGS.replace("../vehicles", str(ROOT / "config" / "vehicles"))
        for old, new in (("iterations: 80", "iterations: 4"), ("iterations: 55", "iterations: 1"),
                         ("  cell_sizes: [0.001, 0.0005]", "  cell_sizes: [0.004, 0.002]"),
                         ("quadratic_cell_sizes: [0.001, 0.0005]", "quadratic_cell_sizes: []")):
            self.assertIn(old, text)
            text = text.replace(old, new)
        return self.file("short.yaml", text)

    def test_a_short_default_design(self):
        settings = self.short()
        here = self.results("here", settings, {})
        self.assertTrue(any(key.startswith("checkpoint.h5:") for key in here) and any(key.startswith("curve_") for key in here), list(here))
        for name, environment in OTHERS.items():
            with self.subTest(name):
                there = self.results(name, settings, environment)
                self.assertEqual(list(there), list(here))
                self.assertEqual([key for key in here if there[key] != here[key]], [])


if __name__ == "__main__":
    unittest.main()
