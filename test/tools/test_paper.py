"""`scripts/paper_figures`: a short run draws its page, goes on without running again, and says where paper and simulation disagree."""
import os
import subprocess
import sys
import unittest

from command import PROGRAM, ROOT, Case

sys.path.insert(0, str(ROOT / "python"))
from snapwing_tools import paper  # noqa: E402

import numpy as np  # noqa: E402


def wing_run(left, right, end="F", switched=True):
    """A run by hand, as a trial leaves it."""
    run = paper.Run.__new__(paper.Run)
    run.series = {"wing_left_rad": np.radians(left), "wing_right_rad": np.radians(right)}
    run.outcome = {"end_mode": end, "snapped": switched, "snap_time": .9, "least_travel": 0, "peak_travel": .07, "start_held": True}
    run.pulse = {"thrust_fraction": 1, "duration": .75}
    run.summary = {"model": {}}
    return run


class PaperFigures(Case):
    def figures(self, *words, code=0):
        done = subprocess.run(["/usr/bin/python3", str(ROOT / "scripts/paper_figures"), "out", "--short", "--snapwing",
                               os.path.abspath(PROGRAM), *words], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              timeout=250, check=False)
        self.assertEqual(done.returncode, code, done.stderr.decode())
        return done

    def test_a_short_run_draws_its_page_and_goes_on(self):
        words = ("--only", "boom_q_to_f_1,battery_alone_in_f")
        self.figures(*words)
        page = (self.folder / "out/paper.html").read_text()
        for text in ("Q to F comparison (boom, without wings)", "1 of 1 switch", "What decides, Q to F", "F against gravity"):
            self.assertIn(text, page)
        for name in ("boom_q_to_f", "variants_q_to_f", "battery"):
            self.assertIn("<svg", (self.folder / f"out/{name}.svg").read_text())
        # Without drag this pulse does not bring the vehicle back to F.
        self.assertIn("decides: ends in Q", page)
        stamps = {p: p.stat().st_mtime_ns for p in self.folder.glob("out/runs/*/summary.json")}
        self.assertEqual(len(stamps), 4)
        self.figures(*words)
        self.assertEqual(stamps, {p: p.stat().st_mtime_ns for p in stamps})
        self.assertEqual(page, (self.folder / "out/paper.html").read_text())

    def test_a_trial_that_is_none_is_named(self):
        said = self.figures("--only", "boom_q_to_g", code=2).stderr.decode()
        self.assertIn("--only: boom_q_to_g", said)
        self.assertIn("boom_q_to_f_1", said)


class OtherTrials(unittest.TestCase):
    def test_other_shipped_trials_are_listed_apart(self):
        other = wing_run([0, 140], [0, 140], end="Q")
        other.outcome["largest_imbalance"] = None
        page = paper.page({}, {}, {}, {"wings_f_to_q": other})
        self.assertIn("Other shipped trials", page)
        self.assertIn("wings_f_to_q", page)


class Verdicts(unittest.TestCase):
    def test_a_wing_that_swings_past_its_rest_disagrees(self):
        good, bad = wing_run([140, 5], [140, 5]), wing_run([140, -83], [140, -83])
        row = paper.hand_row({"hand_q_to_f_even": good}, "q_to_f", paper.FRICTIONS, "")
        self.assertEqual(row[3], paper.AGREES)
        row = paper.hand_row({"hand_q_to_f_even": good, "hand_q_to_f_film": bad}, "q_to_f", paper.FRICTIONS, "")
        self.assertEqual(row[3], paper.PARTLY)
        self.assertEqual(paper.hand_row({"hand_q_to_f_even": bad}, "q_to_f", paper.FRICTIONS, "")[3], paper.DISAGREES)
        self.assertEqual(paper.hand_row({}, "q_to_f", paper.FRICTIONS, "")[3], paper.OPEN)

    def test_wings_that_uneven_friction_does_not_part_disagree(self):
        even = wing_run([140, 0], [140, 0])
        for right, verdict in (([130, 0], paper.AGREES), ([140, 0], paper.DISAGREES), ([40, 0], paper.DISAGREES)):
            runs = {"hand_q_to_f_even": even, "hand_q_to_f_uneven": wing_run([140, 0], right)}
            self.assertEqual(paper.friction_row(runs)[3], verdict)

    def test_tips_outside_are_one_wing_folded_and_one_not(self):
        for left, right, verdict in (([130, 20], [130, 140], paper.AGREES), ([130, 120], [130, 140], paper.DISAGREES)):
            run = wing_run(left, right)
            run.series.update({"turn_rate_rad_per_s": np.array([1.0, 9.0]), "time_s": np.array([0, 0.4]), "centre_off_m": np.zeros(2),
                               "travel_m": np.array([0, 0.05])})
            run.outcome["start_mode"] = "Q"
            run.summary = {"model": {"bodies": {"centre_mass": .4, "arms_mass": .04},
                                     "linkage": {bar: {"mass": .01} for bar in ("crank", "wing", "rocker")}}}
            row = paper.outward_row({"boom_wings": run}, "boom_wings", "a boom")
            self.assertEqual((row[0], row[3]), ("a boom", verdict))
            self.assertIn(f"at the end, at 0.40 s, the wings are at {left[-1]} and {right[-1]} deg, the housing at 50 mm", row[2])
        self.assertEqual(paper.outward_row({}, "boom_wings", "a boom")[3], paper.OPEN)


if __name__ == "__main__":
    unittest.main()
