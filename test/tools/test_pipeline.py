"""`snapwing design arm --into`: from a design to a vehicle that is validated, killed and gone on with, refused by name."""
import json
import os
import signal
import subprocess
import time
import unittest

from command import ROOT, Case

VEHICLE = ROOT / "config/vehicles/arris_x220.yaml"
BODY = ROOT / "data/arms/arris_x220_body.csv"
QUICK = ("--cell-size", "0.0025", "--no-volumetric", "--samples", "0", "--weakest", "0", "--one-cell-size")
KEPT_FILES = ("design/body.csv", "design/table.h5", "wing/wing.yaml", "wing/wing_table.h5", "vehicle.yaml")


def without_times(value):
    """JSON without what a clock says, and without the folder's name."""
    if isinstance(value, dict):
        return {key: without_times(v) for key, v in value.items() if "seconds" not in key and not key.endswith("_file")}
    return [without_times(v) for v in value] if isinstance(value, list) else value


class Pipeline(Case):
    def setUp(self):
        super().setUp()
        text = (ROOT / "test/data/designs/arm_tiny.yaml").read_text()
        for old, new in (("../../../config", str(ROOT / "config")), ("cell_sizes: [0.004]", "cell_sizes: [0.0025, 0.00125]")):
            self.assertIn(old, text)
            text = text.replace(old, new, 1)
        self.settings = self.file("arm.yaml", text)

    def vehicle(self, *changes):
        text = VEHICLE.read_text().replace("../../data", str(ROOT / "data"))
        for old, new in changes:
            self.assertIn(old, text)
            text = text.replace(old, new)
        return self.file("mine.yaml", text)

    def words(self, vehicle, into, *more):
        return ("design", "arm", self.settings, "--vehicle", vehicle, "--into", into, *QUICK, *more)

    def run_it(self, vehicle, into, *more, code):
        """Lines of progress by stage: {"wing": ["begins", "done"]}, and what was said."""
        done = self.snapwing(*self.words(vehicle, into, *more), code=code)
        stages = {}
        for line in done.stderr.decode().splitlines():
            if line.startswith("["):
                name, said = line.split("] ", 1)[1].split(": ", 1)
                stages.setdefault(name, []).append(said)
        return stages, done.stdout.decode()

    def kill_when(self, words, there):
        child = subprocess.Popen([os.environ["SNAPWING"], *map(os.fspath, words)], cwd=self.folder,
                                 stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        deadline = time.monotonic() + 200
        while not there() and child.poll() is None and time.monotonic() < deadline:
            time.sleep(0.005)
        child.send_signal(signal.SIGKILL)
        self.assertEqual(child.wait(), -signal.SIGKILL, "the run ended before it could be killed")

    def answers(self, into):
        return [without_times(json.loads((self.folder / into / name).read_text()))
                for name in ("plan_f_to_q.json", "plan_q_to_f.json", "validation/validation.json")]

    def test_the_whole_way_killed_twice_and_gone_on_with(self):
        vehicle, given = self.vehicle(), ("--density", BODY)
        stages, said = self.run_it(vehicle, "whole", *given, code=(0, 1, 3))
        self.assertEqual(list(stages), ["check and tables", "wing", "vehicle file", "plan F -> Q", "plan Q -> F",
                                        "validation"])
        for lines in stages.values():
            self.assertEqual((lines[0], lines[-1]), ("begins", "done"))
        self.assertTrue(any("left" in line for line in stages["validation"]), stages)
        # What it leaves is taken by all who read a vehicle, and the validation's exit code is its own.
        code = self.snapwing(*self.words(vehicle, "whole", *given), code=(0, 1, 3)).returncode
        made = self.folder / "whole" / "vehicle.yaml"
        again = self.snapwing("validate", made, "-o", "whole/validation", *QUICK, code=code).stdout.decode()
        for line in again.splitlines():
            if line.startswith(("FAIL", "UNDECIDED")):
                self.assertIn(line, said)
        self.assertNotIn("plan of this vehicle and table: it was", again)
        self.snapwing("predict", made, "--from", "F", "--throttle", ".6", "--duration", ".18")
        self.snapwing("plan", made, "--from", "Q")
        checked = self.snapwing("vehicle", "check", made).stdout.decode()
        self.assertIn("validation: " + {0: "passed", 1: "NOT passed", 3: "NOT decided"}[code], checked)
        self.assertEqual(checked.count("plan "), 2)
        self.assertNotIn("another version", checked)
        other = self.file("whole/other.yaml", made.read_text() + "# changed\n")
        self.assertEqual(self.snapwing("vehicle", "check", other).stdout.decode().count("another version"), 3)

        words = self.words(vehicle, "part", *given)
        self.kill_when(words, lambda: (self.folder / "part/wing/wing.yaml").exists())
        self.kill_when(words, lambda: len(list(self.folder.glob("part/validation/trials/*.json"))) >= 2)
        trials = {p: p.stat().st_mtime_ns for p in self.folder.glob("part/validation/trials/*.json")}
        stages, _ = self.run_it(vehicle, "part", *given, code=code)
        for name, lines in stages.items():
            self.assertEqual(lines[0], "goes on" if name == "validation" else "kept", name)
        for path, stamp in trials.items():
            self.assertEqual(path.stat().st_mtime_ns, stamp, "not computed again")
        for name in KEPT_FILES:
            self.assertEqual((self.folder / "part" / name).read_bytes(), (self.folder / "whole" / name).read_bytes(), name)
        self.assertEqual(self.answers("part"), self.answers("whole"))
        stages, _ = self.run_it(vehicle, "part", *given, code=code)
        self.assertEqual(set(map(tuple, stages.values())), {("kept",)})

        stages, _ = self.run_it(vehicle, "part", *given, "--step", "0.004", code=(0, 1, 3))
        self.assertEqual(stages.pop("validation")[0], "anew: changed since it was done: validation's options")
        self.assertEqual(set(map(tuple, stages.values())), {("kept",)})

    def test_an_optimisation_that_is_killed_goes_on_and_an_arm_of_no_use_ends_the_way(self):
        vehicle = self.vehicle()
        stages, said = self.run_it(vehicle, "whole", code=1)
        self.assertEqual(list(stages), ["optimisation", "check and tables"])
        self.assertIn("NOT bistable", said)
        self.assertFalse((self.folder / "whole/vehicle.yaml").exists())
        history = self.folder / "part/design/checkpoint.h5"
        self.kill_when(self.words(vehicle, "part"), lambda: history.exists())
        stages, _ = self.run_it(vehicle, "part", code=1)
        self.assertEqual(stages["optimisation"][0], "goes on")
        self.assertEqual((self.folder / "part/design/density.csv").read_bytes(),
                         (self.folder / "whole/design/density.csv").read_bytes())
        # Another vehicle: by name, and from the start.
        stages, _ = self.run_it(self.vehicle(("value: 0.783, unit: kg", "value: 0.790, unit: kg")), "part", code=1)
        self.assertEqual(stages["optimisation"][0], "anew: changed since it was done: vehicle file")
        self.assertTrue(stages["optimisation"][1].startswith("iteration 1 of 8"), stages["optimisation"])

    def test_what_cannot_be_is_refused_before_the_work(self):
        vehicle = self.vehicle()
        self.assertIn("--into", self.refusal("design", "arm", self.settings, "--into", "x"))
        self.assertIn("arm_design.yaml", self.refusal("design", "arm", "--vehicle", vehicle, "--into", "x"))
        self.assertIn("settings", self.refusal("design", "arm"))
        (self.folder / "mine").mkdir()
        self.file("mine/thing", "a")
        self.assertIn("holds foreign files", self.refusal(*self.words(vehicle, "mine")))
        self.assertEqual([p.name for p in (self.folder / "mine").iterdir()], ["thing"])
        self.assertIn("no_such.csv", self.refusal(*self.words(vehicle, "x", "--density", "no_such.csv")))
        own = self.file("vehicle.yaml", vehicle.read_text())
        self.assertIn("vehicle.yaml", self.refusal(*self.words(own, ".")))
        self.assertFalse((self.folder / "x").exists())

    def test_a_vehicle_file_that_was_changed_by_hand_is_not_written_over(self):
        words = self.words(self.vehicle(), "out", "--density", BODY)
        self.kill_when(words, lambda: (self.folder / "out/stages/vehicle file.json").exists())
        made = self.folder / "out/vehicle.yaml"
        made.write_text(made.read_text() + "# mine\n")
        self.assertIn("was changed since it was made", self.refusal(*words))
        self.assertTrue(made.read_text().endswith("# mine\n"))

    def test_a_wing_that_the_arm_cannot_fold_ends_the_way_by_name(self):
        text = (ROOT / "data/wings/arris_x220/wing.yaml").read_text()
        begin = text.index("arm_rotation:")
        line = text[begin:text.index("\n", begin)]
        layout = self.file("wing.yaml", text.replace(line, "arm_rotation: [0.83, 1.4]"))
        vehicle = self.vehicle((str(ROOT / "data/wings/arris_x220/wing.yaml"), str(layout)))
        done = self.snapwing(*self.words(vehicle, "out", "--density", BODY), code=1)
        self.assertIn("FAIL       wing: the vehicle's wing does not go with this arm: ", done.stdout.decode())


if __name__ == "__main__":
    unittest.main()
