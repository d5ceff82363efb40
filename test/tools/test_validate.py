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

    def body(self, name, change):
        """The shipped body with another density: change(i, j, rho, at) of its cells, at(i, j) 0 outside."""
        cells = {}
        for line in (ROOT / "data/arms/arris_x220_body.csv").read_text().splitlines():
            if line[:1].isdigit():
                i, j, rho = line.split(",")
                cells[int(i), int(j)] = float(rho)
        rows = [f"{i},{j},{change(i, j, rho, lambda *at: cells.get(at, 0)):.4f}" for (i, j), rho in cells.items()]
        return self.file(name, "i,j,rho\n" + "\n".join(rows) + "\n")

    def failures(self, *words, more=("--one-cell-size",)):
        """Names of the checks that fail."""
        said = self.snapwing("validate", *words, "-o", "out", *QUICK, *more, code=1).stdout.decode()
        return [line[6:] for line in said.splitlines() if line.startswith("FAIL  ")]

    def test_an_arm_that_is_printed_too_thin_fails_by_name(self):
        neighbours = ((1, 0), (-1, 0), (0, 1), (0, -1))

        def thinner(i, j, rho, at):  # .2 mm less at each edge of cells of .5 mm: walls .4 mm too thin
            return max(0.0, rho - 0.4 * sum(at(i + di, j + dj) < 0.5 for di, dj in neighbours))
        self.snapwing("plan", self.vehicle(), "--from", "F", "--json", "plan.json")
        failures = self.failures("vehicle.yaml", "--plan", "plan.json", "--body", self.body("thin.csv", thinner), more=())
        self.assertTrue(any(name.startswith("static curve: peak: ") for name in failures), failures)

    def test_a_plan_that_is_too_short_fails_by_name(self):
        path = self.vehicle()
        self.snapwing("plan", path, "--from", "F", "--json", "plan.json")
        plan = json.loads((self.folder / "plan.json").read_text())
        plan["plan"]["pulse"]["duration"] = 0.03
        self.file("plan.json", json.dumps(plan))
        failures = self.failures(path, "--plan", "plan.json")
        for rung in ("lumped", "planar"):
            self.assertTrue(any(name.startswith(f"F -> Q, {rung}, nominal: end mode") for name in failures), failures)

    def test_the_plans_that_the_vehicle_file_names_are_taken_and_have_to_be_its_own(self):
        path = self.vehicle()
        path.write_text(path.read_text() + "\nresults: {plan_f_to_q: plan.json}\n")
        self.assertIn("results.plan_f_to_q", self.refusal("validate", path, "-o", "out", *QUICK))
        self.snapwing("plan", path, "--from", "F", "--json", "plan.json")
        path.write_text(path.read_text() + "# a change\n")
        failures = self.failures(path)
        self.assertTrue(any(name.startswith("F -> Q: plan of this vehicle and table: it was planned for another vehicle "
                                            "file") for name in failures), failures)
        self.assertFalse(any("Q -> F" in name for name in failures), "another plan was made")

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
