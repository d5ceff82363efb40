"""`snapwing validate`: what it refuses by name, and that a stopped run goes on to the same answer."""
import json
import os
import signal
import subprocess
import time
import unittest

from command import ROOT, Case

VEHICLE = ROOT / "config/vehicles/arris_x220.yaml"
QUICK = ("--cell-size", "0.0025", "--no-volumetric", "--samples", "1", "--weakest", "0", "-q")


class Validate(Case):
    def vehicle(self, *changes):
        text = VEHICLE.read_text().replace("../../data", str(ROOT / "data"))
        for old, new in changes:
            self.assertIn(old, text)
            text = text.replace(old, new)
        return self.file("vehicle.yaml", text)

    def test_a_table_of_another_arm_is_refused_by_name(self):
        path = self.vehicle(("value: 5.5e+6", "value: 5.0e+6"))
        done = self.snapwing("validate", path, "-o", "out", *QUICK, code=1)
        self.assertIn("FAIL  tables of this vehicle's arm: ", done.stdout.decode())
        self.assertIn("youngs_modulus", done.stdout.decode())
        self.assertIn("NOT passed", (self.folder / "out" / "report.html").read_text())
        self.assertFalse(json.loads((self.folder / "out" / "validation.json").read_text())["passed"])

    def test_an_unknown_accident_is_refused_with_those_that_are_known(self):
        path = self.vehicle(("must_survive: [sudden thrust in F", "must_survive: [sudden rain"))
        words = self.refusal("validate", path, "-o", "out", *QUICK)
        for word in ("must_survive", "sudden rain", "hover thrust cut in Q"):
            self.assertIn(word, words)

    def test_error_bars_across_the_limits_are_undecided_and_a_run_with_them_goes_on(self):
        path = self.vehicle()
        self.snapwing("plan", path, "--from", "F", "--json", "plan.json")
        words = ("validate", str(path), "--plan", "plan.json", *QUICK, "-o", "out")
        said = self.snapwing(*words, code=3).stdout.decode()
        self.assertIn("UNDECIDED  F -> Q, planar against lumped: shortest pulse: ", said)
        self.assertNotIn("FAIL", said)
        self.assertIn("to decide: the same with smaller cells, --cell-size 0.00125 (planar)\n", said)
        answer = json.loads((self.folder / "out" / "validation.json").read_text())
        self.assertEqual((answer["passed"], answer["undecided"]), (False, True))
        bar = next(c for c in answer["checks"] if c["name"] == "static curve: second equilibrium")
        self.assertGreater(bar["error"], 1)
        self.assertIn("NOT decided", (self.folder / "out" / "report.html").read_text())
        kept = {p.name: p.stat().st_mtime_ns for p in self.folder.glob("out/trials/*.json")}
        self.assertIn("f_to_q_planar_shortest_pulse_fine.json", kept)
        self.assertEqual(self.snapwing(*words, code=3).stdout.decode(), said)
        for name, stamp in kept.items():
            self.assertEqual((self.folder / "out" / "trials" / name).stat().st_mtime_ns, stamp, "not computed again")

    def test_a_killed_run_goes_on_to_the_same_answer(self):
        path = self.vehicle()
        self.snapwing("plan", path, "--from", "F", "--json", "plan.json")
        words = ("validate", str(path), "--plan", "plan.json", *QUICK)
        words += ("--one-cell-size",)
        self.snapwing(*words, "-o", "whole", code=1)
        command = [os.environ["SNAPWING"], *words, "-o", "part"]
        child = subprocess.Popen(command, cwd=self.folder, stdout=subprocess.DEVNULL)
        deadline = time.monotonic() + 120
        while len(list(self.folder.glob("part/trials/*.json"))) < 3 and child.poll() is None and time.monotonic() < deadline:
            time.sleep(0.01)
        child.send_signal(signal.SIGKILL)
        child.wait()
        kept = {p.name: p.stat().st_mtime_ns for p in self.folder.glob("part/trials/*.json")}
        self.assertTrue(3 <= len(kept), "the run ended before it could be killed")
        self.assertFalse((self.folder / "part" / "validation.json").exists())
        self.snapwing(*words, "-o", "part", code=1)
        for name, stamp in kept.items():
            self.assertEqual((self.folder / "part" / "trials" / name).stat().st_mtime_ns, stamp, "not computed again")
        answers = [json.loads((self.folder / run / "validation.json").read_text()) for run in ("whole", "part")]
        for answer in answers:
            for trial in answer["trials"]:
                del trial["cpu_seconds"]
        self.assertEqual(*answers)


if __name__ == "__main__":
    unittest.main()
