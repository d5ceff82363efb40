"""`snapwing vehicle`, and what predict and plan refuse of a vehicle file: usage test_vehicle_command.py PROGRAM"""
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHIPPED = ROOT / "config" / "vehicles" / "arris_x220.yaml"
PULSE = ["--from", "F", "--throttle", "0.7", "--duration", "0.16"]
PROGRAM = ""


class VehicleCommand(unittest.TestCase):
    def setUp(self):
        self.keep = tempfile.TemporaryDirectory(prefix="own vehicle ")  # a blank in the name
        self.folder = pathlib.Path(self.keep.name)
        self.file = self.folder / "mine" / "vehicle.yaml"

    def tearDown(self):
        self.keep.cleanup()

    def run_program(self, *words):
        return subprocess.run([PROGRAM] + [str(word) for word in words], cwd=self.folder, capture_output=True, text=True,
                              timeout=200, check=False)

    def good(self, *words):
        done = self.run_program(*words)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def refused(self, *words):
        done = self.run_program(*words)
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        return done.stderr

    def new(self, *words):
        return self.good("vehicle", "new", self.file.relative_to(self.folder), *words)

    def edit(self, old, new):
        text = self.file.read_text()
        self.assertEqual(text.count(old), 1, old)
        self.file.write_text(text.replace(old, new))

    def test_new_one_is_complete_and_may_be_moved(self):
        self.new()
        self.assertIn("vehicle 'mine'", self.good("vehicle", "check", self.file))
        moved = self.folder / "moved"
        self.file.parent.rename(moved)
        self.good("vehicle", "check", "moved/vehicle.yaml")
        self.assertEqual(self.good("vehicle", "check", "--path", "moved/vehicle.yaml"), str(moved / "vehicle.yaml"))
        self.good("predict", moved / "vehicle.yaml", *PULSE)
        self.assertIn("vehicle: vehicle.yaml", (moved / "arm_design.yaml").read_text())

    def test_existing_files_are_left_alone(self):
        self.new()
        before = self.file.read_bytes()
        self.assertIn("is there already", self.refused("vehicle", "new", self.file))
        self.assertIn("is there already", self.refused("vehicle", "new", self.file.parent / "second.yaml"))
        self.assertEqual(self.file.read_bytes(), before)
        self.assertIn("--from is 'nothing'", self.refused("vehicle", "new", self.folder / "x.yaml", "--from", "nothing"))

    def test_without_boom_and_wing(self):
        self.new("--without", "wing,boom,battery")
        for key in ("\nwing:", "\nboom:", "\nbattery:"):
            self.assertNotIn(key, self.file.read_text())
        self.assertIn("no wings, no boom", self.good("vehicle", "check", self.file))
        self.assertIn("free, wings off", self.good("predict", self.file, *PULSE))
        message = self.refused("predict", self.file, *PULSE, "--mount", "boom")
        self.assertIn("'boom' is not given", message)
        self.assertIn("--mount free", message)
        self.assertIn("'boom' is not given", self.refused("plan", self.file, "--from", "F", "--mount", "boom"))

    def test_file_copied_alone_names_key_path_and_remedy(self):
        copied = self.folder / "copied.yaml"
        shutil.copy(SHIPPED, copied)
        message = self.refused("predict", copied, *PULSE)
        for words in ("arm.table_file", str(self.folder.parent.parent / "data"), "snapwing vehicle new"):
            self.assertIn(words, message)

    def test_tables_of_another_arm_are_refused_by_every_command(self):
        self.new()
        self.edit("youngs_modulus: {value: 5.5e+6", "youngs_modulus: {value: 55.0e+6")
        for words in (("predict", self.file, *PULSE), ("plan", self.file, "--from", "F"), ("vehicle", "check", self.file),
                      ("curve", self.file, "--rung", "lumped")):
            message = self.refused(*words)
            self.assertIn("material.youngs_modulus 5500000", message)
            self.assertIn("snapwing curve", message)

    def test_what_the_curve_does_not_depend_on_may_change(self):
        self.new()
        self.edit("capacity: {value: 5400.0", "capacity: {value: 4000.0")
        self.edit("total: {value: 0.783", "total: {value: 0.790")
        self.good("predict", self.file, *PULSE)

    def test_wing_of_another_arm_is_refused(self):
        self.new()
        self.edit("axle_below_ring: {value: 0.020", "axle_below_ring: {value: 0.022")
        self.assertIn("the axle's height", self.refused("predict", self.file, *PULSE))

    def test_arm_that_ends_inside_the_ring_is_refused(self):
        self.new()
        self.edit("ring_radius: {value: 0.125", "ring_radius: {value: 0.145")
        message = self.refused("plan", self.file, "--from", "F")
        for words in ("arm.pin_x", "0.123 m", "0.145 m"):
            self.assertIn(words, message)


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    unittest.main(verbosity=2)
