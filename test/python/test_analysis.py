"""What is worked out of a record: switches, sent pulses, link statistics, the verdict and its honesty."""

import math
import unittest
from types import SimpleNamespace as Message

import numpy as np

import synthetic_run
from snapwing_tools import analysis, topics


def judged(run, summary=None):
    switches = analysis.find_switches(run)
    return switches, analysis.judge(run, switches, summary)


class GoodRun(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.run_data = synthetic_run.make_buffer().to_run("closed")
        cls.switches, cls.verdict = judged(cls.run_data)

    def test_both_switches_are_found(self):
        self.assertEqual([switch.name for switch in self.switches], ["F->Q", "Q->F"])
        self.assertEqual(self.verdict.status, {"F->Q": "happened", "Q->F": "happened"})
        self.assertTrue(self.verdict.good)

    def test_true_motion_agrees_with_the_simulation(self):
        for switch in self.switches:
            motion = synthetic_run.simulate(list(synthetic_run.PULSES.values()))
            exact = synthetic_run.prediction(1, 2, motion, switch.start, switch.start + 3.5)
            # The record has one sample in five of the simulation's steps of 1 ms.
            self.assertAlmostEqual(switch.true.snap_time, exact.snap_time, delta=2e-3)
            self.assertAlmostEqual(switch.true.peak_travel, exact.peak_travel, delta=5e-4)

    def test_plan_of_each_pulse_is_its_own(self):
        for switch in self.switches:
            self.assertEqual(topics.MODE_NAMES[int(switch.plan["start_mode"])], switch.start_mode)
            self.assertEqual(switch.plan["duration"], switch.duration)

    def test_sent_pulse_lasts_as_commanded_within_a_frame(self):
        for switch in self.switches:
            self.assertAlmostEqual(switch.sent.duration, switch.duration, delta=0.025)
            self.assertEqual(switch.sent.highest, int(1000 + 1000 * switch.throttle))

    def test_pulse_at_the_motors_is_late_by_the_link(self):
        for switch in self.switches:
            start, end = switch.motors
            self.assertAlmostEqual(start - switch.start, 0.03, delta=0.006)  # one sample of the truth
            self.assertAlmostEqual(end - start, switch.duration, delta=0.006)

    def test_estimate_reaches_the_target_after_the_snap(self):
        for switch in self.switches:
            self.assertGreater(switch.estimate_seconds, switch.true.snap_time - 0.01)
            self.assertLess(switch.estimate_seconds, switch.true.snap_time + 0.2)

    def test_link_statistics(self):
        statistics = analysis.link_statistics(self.run_data)
        self.assertEqual(statistics.frames, len(self.run_data.series["link_status"]["time"]))
        self.assertEqual((statistics.unseen, statistics.late, statistics.restarts), (0, 0, 0))
        self.assertAlmostEqual(statistics.median, 0.02, delta=1e-3)
        self.assertEqual(statistics.accepted, 2)

    def test_summary_that_disagrees_is_called_out(self):
        claim = {"ok": False, "reason": "gave up", "switches": [{"name": "F->Q", "ok": False, "reason": "timed out"}]}
        _, verdict = judged(self.run_data, claim)
        self.assertTrue(verdict.all_happened)
        self.assertFalse(verdict.good)
        self.assertTrue(any("says it failed, the record says: happened" in note for note in verdict.notes))
        self.assertTrue(any("timed out" in note for note in verdict.notes))
        self.assertTrue(any("gave up" in note for note in verdict.notes))

    def test_comparison_has_numbers_for_both_sides(self):
        rows = {row[0]: row for row in analysis.comparison_rows(self.switches[0])}
        self.assertEqual(rows["end mode"][2:], ("Q", "Q", "Q"))
        for key in ("snap time after the command", "largest travel", "travel at the end"):
            self.assertTrue(all(math.isfinite(value) for value in rows[key][2:]), key)


class FailedRuns(unittest.TestCase):
    def test_pulse_that_is_too_weak_did_not_switch(self):
        pulses = dict(synthetic_run.PULSES)
        pulses["F->Q"] = (2.0, 0.12, 0.3)
        del pulses["Q->F"]
        run = synthetic_run.make_buffer(pulses).to_run("closed")
        switches, verdict = judged(run)
        self.assertFalse(switches[0].happened)
        self.assertEqual(verdict.status, {"F->Q": "did not happen", "Q->F": "not attempted"})
        self.assertFalse(verdict.good)

    def test_claimed_success_does_not_make_one(self):
        run = synthetic_run.make_buffer({"F->Q": (2.0, 0.12, 0.3)}).to_run("closed")
        claim = {"ok": True, "reason": "", "switches": [{"name": name, "ok": True, "reason": ""}
                                                        for name in ("F->Q", "Q->F")]}
        _, verdict = judged(run, claim)
        self.assertFalse(verdict.good)
        self.assertEqual(sum("says it succeeded" in note for note in verdict.notes), 2)

    def test_without_truth_nothing_is_known(self):
        run = synthetic_run.make_buffer(leave_out=("truth",)).to_run("closed")
        _, verdict = judged(run)
        self.assertEqual(set(verdict.status.values()), {"not known"})

    def test_without_plan_the_truth_still_tells_the_direction(self):
        run = synthetic_run.make_buffer(leave_out=("transition_plan",)).to_run("closed")
        switches, verdict = judged(run)
        self.assertTrue(verdict.good)
        self.assertIsNone(switches[0].plan)

    def test_record_that_ends_during_the_pulse_cannot_tell(self):
        run = synthetic_run.make_buffer({"F->Q": (2.0, 0.55, 0.3)}, seconds=2.4).to_run("recording")
        switches, verdict = judged(run)
        self.assertIsNone(switches[0].happened)
        self.assertEqual(verdict.status["F->Q"], "not known")

    def test_pulse_whose_command_was_missed_is_not_called_unattempted(self):
        run = synthetic_run.make_buffer(leave_out=("command/pulse",)).to_run("closed")
        self.assertEqual(set(judged(run)[1].status.values()), {"not known"})
        del run.series["link_status"]
        self.assertEqual(set(judged(run)[1].status.values()), {"not known"})
        run = synthetic_run.make_buffer().to_run("closed")
        run.series["command/pulse"] = {name: data[:1] for name, data in run.series["command/pulse"].items()}
        self.assertEqual(judged(run)[1].status, {"F->Q": "happened", "Q->F": "not known"})

    def test_empty_record(self):
        run = synthetic_run.RunBuffer(0.0).to_run("closed")
        switches, verdict = judged(run)
        self.assertEqual(switches, [])
        self.assertEqual(set(verdict.status.values()), {"not known"})
        self.assertIsNone(analysis.link_statistics(run))

    def test_watch_ends_when_the_hand_takes_hold(self):
        buffer = synthetic_run.make_buffer({"F->Q": (2.0, 0.55, 0.3)})
        run = buffer.to_run("closed")
        truth = run.series["truth"]
        truth["held"] = (truth["time"] < 1.9) | (truth["time"] > 4.0)
        truth["travel"][truth["time"] > 4.5] = 0.5  # whatever the hand does to it
        switches, verdict = judged(run)
        self.assertAlmostEqual(switches[0].until, 4.0, delta=0.01)
        self.assertLess(switches[0].true.peak_travel, 0.1)
        self.assertEqual(verdict.status["F->Q"], "happened")

    def test_lost_frames_failsafe_and_restart_are_counted(self):
        buffer = synthetic_run.RunBuffer(synthetic_run.ORIGIN)
        topic = topics.series_topic("link_status")
        times = [0.0, 0.02, 0.06, 0.30, 0.32, 0.34]
        numbers = [1, 2, 4, 5, 1, 2]
        for time, number in zip(times, numbers):
            buffer.add(topic, synthetic_run.link_message(time, number, 0, 0.0, True, failsafe=time > 0.29), time)
        statistics = analysis.link_statistics(buffer.to_run("closed"))
        self.assertEqual((statistics.unseen, statistics.late, statistics.restarts), (1, 1, 1))
        self.assertAlmostEqual(statistics.worst, 0.24, places=6)
        self.assertAlmostEqual(statistics.failsafe_seconds, 0.04, places=6)


class Helpers(unittest.TestCase):
    def test_last_crossing_is_linear_between_samples(self):
        time, values = np.array([0.0, 1.0, 2.0, 3.0]), np.array([0.0, 2.0, 0.0, 4.0])
        self.assertAlmostEqual(analysis.last_crossing(time, values, 1.0), 2.25)
        self.assertTrue(math.isnan(analysis.last_crossing(time, values, 9.0)))
        self.assertTrue(math.isnan(analysis.last_crossing(time, values, math.nan)))

    def test_spans(self):
        time = np.arange(6.0)
        self.assertEqual(analysis.spans(time, np.array([1, 1, 0, 0, 1, 1], bool)), [(0.0, 2.0), (4.0, 5.0)])
        self.assertEqual(analysis.spans(time, np.zeros(6, bool)), [])

    def test_vehicle_that_started_in_the_wrong_mode_did_not_switch(self):
        switch = analysis.Switch("F->Q", 0, 1, 0.5, 0.1, 1)
        switch.true = Message(start_mode="Q", end_mode="Q")
        self.assertFalse(switch.happened)


if __name__ == "__main__":
    unittest.main()
