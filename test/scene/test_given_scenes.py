"""Scenes as a shell hands them over. usage: test_given_scenes.py SNAPWING"""

import json
import os
import subprocess
import sys
import tempfile
import unittest

SNAPWING = sys.argv[-1]
BAR = """scene: bar
length_unit: mm
dimension: 2
plane: stress
kernel: linear
cell_size: 1
bodies:
  bar:
    material: {youngs_modulus: 1.0e+6, poisson_ratio: 0.0}
    thickness: 5
    BODY
supports:
  - {name: left, region: {x: [0, 0]}, hold: xy}
ports:
  - {name: right, region: {x: [20, 20]}, direction: [1, 0], cross_motion: free}
path: {to: 0.02, steps: 1}
"""
BOX = BAR.replace("BODY", "shape: {box: {x: [0, 20], y: [0, 4]}}")


class GivenScenes(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def curve(self, scene, **more):
        return subprocess.run([SNAPWING, "curve", scene, "-q", "--json", "-o", "o.csv"], cwd=self.folder, capture_output=True, text=True,
                              check=False, timeout=250, **more)

    def force(self):
        with open(os.path.join(self.folder, "o.csv"), encoding="utf-8") as file:
            return float(file.read().splitlines()[-1].split(",")[1])

    def test_a_pipe_is_a_scene(self):
        done = self.curve("/dev/stdin", input=BOX)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertAlmostEqual(self.force(), 0.01999, delta=2e-6)
        self.assertAlmostEqual(json.loads(done.stdout)["volume_error"], 0, delta=1e-3)

    def test_what_a_pipe_names_lies_in_the_working_folder(self):
        with open(os.path.join(self.folder, "full.csv"), "w", encoding="utf-8") as file:
            file.write("i,j,rho\n" + "".join("{},{},1\n".format(i, j) for i in range(20) for j in range(4)))
        done = self.curve("/dev/stdin", input=BAR.replace("BODY", "density: {file: full.csv, length: 20, height: 4}"))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertAlmostEqual(self.force(), 0.01999, delta=2e-6)

    def test_an_alias_of_itself_is_refused(self):
        done = self.curve("/dev/stdin", input=BAR.replace("BODY", "shape: &s {union: [*s]}"))
        self.assertEqual(done.returncode, 2)
        self.assertIn("alias of itself", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
